"""Words and numbers that several parts of a report share: effects, parameters, deviates, what colours mean."""

from math import isfinite

from gyrodrift.diagnose.inference.parameters import Parameter
from gyrodrift.diagnose.inference.verdict import NamedCause
from gyrodrift.html.html import legend, span, switches, text
from gyrodrift.html.numbers import significant

NAMES = ("recordings", "simulator as it is", "corrected simulator")
"""What is compared, in all figures and tables; corrected is the rig with the named causes at their fitted sizes."""

REAL, BEFORE, AFTER = zip(("ink", "plain", "tuned"), ("key", "key", "key"), NAMES, strict=True)
LEFT = ("two", "key", "residual: recordings − simulator")
UNKNOWN = "–"
"""In the place of a number that there is not."""


FREE_PHASE = "another one in each session"
"""Of an effect once per turn, beside an encoder that is zeroed wherever it stands at power-on."""

UNITS = {"1/h": "per hour"}
"""Those that read better in words."""


def marks(*, has_causes: bool, has_left: bool = True) -> str:
    """The legend of a figure."""
    return legend(_marks(has_causes=has_causes, has_left=has_left))


def switched_marks(*, has_causes: bool, has_left: bool = True) -> str:
    """The legend of a figure whose curves it switches, by the names of their colours."""
    return switches([(mark[0], *mark) for mark in _marks(has_causes=has_causes, has_left=has_left)])


def _marks(*, has_causes: bool, has_left: bool) -> list[tuple[str, str, str]]:
    simulated = [BEFORE, AFTER] if has_causes else [(*BEFORE[:2], "simulator")]
    left = (*LEFT[:2], f"residual: recordings − {AFTER[2]}") if has_causes else LEFT
    return [REAL, *simulated, *[left] * has_left]


def size(value: float, unit: str) -> str:
    """A number with its unit."""
    return f"{number(value)} {text(UNITS.get(unit, unit))}".strip()


def number(value: float, digits: int = 3) -> str:
    """So many digits, with a true minus."""
    return significant(value, digits).replace("-", "−")


def interval(parameter: Parameter) -> str:
    """Sizes that fit nearly as well."""
    low, high = number(parameter.low), number(parameter.high)
    return f"{low} to {high}" if low != high else "no other"


def fitted(cause: NamedCause) -> str:
    """Parameters of a cause in a line, the first with the range that fits nearly as well."""
    first, phase = cause.parameters[0], ["a phase that is " + FREE_PHASE] * has_free_phase(cause)
    held = [f"{text(one.name)} {size(one.value, one.unit)}" for one in others_of(cause)]
    return ", ".join([f"{text(first.name)} {size(first.value, first.unit)} ({interval(first)})", *held, *phase])


def has_free_phase(cause: NamedCause) -> bool:
    """Whether its phase was fitted to each session by itself."""
    return cause.cause.phases_deg is not None


def others_of(cause: NamedCause) -> list[Parameter]:
    """Parameters beside the size, without a phase that each session has for itself, and what is as in the rig."""
    known = {} if cause.in_rig is None else cause.in_rig.model_dump()
    names = {"phase_deg"} if has_free_phase(cause) else set[str]()
    return [one for one in cause.parameters[1:] if one.name not in names and known.get(one.name) != one.value]


def in_rig(cause: NamedCause) -> str:
    """The size that the rig states of a cause that it has already; empty where it has not."""
    first = cause.parameters[0]
    return "" if cause.in_rig is None else size(float(getattr(cause.in_rig, first.name)), first.unit)


def deviates(z: float) -> str:
    """How many standard deviations of chance something is off."""
    if not isfinite(z):
        return UNKNOWN
    return f"{abs(z):.1f}" if abs(z) < 100.0 else f"{abs(z):.0f}"


def sigmas(z: float) -> str:
    """So many standard deviations of chance."""
    return f"{fixed(z, 2)} σ" if isfinite(z) else UNKNOWN


def percent(share: float) -> str:
    """A share, without decimals where it is large."""
    if not isfinite(share):
        return UNKNOWN
    decimals = 0 if abs(share) >= 0.0995 or abs(share) < 0.0005 else 1
    return f"{fixed(100.0 * share, decimals)} %"


def fixed(value: float, decimals: int) -> str:
    """So many decimals, with a true minus, which a 0 has not."""
    return f"{round(value, decimals) + 0.0:.{decimals}f}".replace("-", "−") if isfinite(value) else UNKNOWN


def quiet(html: str) -> str:
    """Set back."""
    return span(html, "note")
