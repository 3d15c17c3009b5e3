"""Words and numbers that several parts of a report share: effects, parameters, deviations, legends."""

from math import isfinite

from gyrodrift.diagnose.inference.parameters import Parameter
from gyrodrift.diagnose.inference.verdict import NamedCause
from gyrodrift.report.chart import Mark
from gyrodrift.report.numbers import significant

NAMES = ("recordings", "simulator as it is", "corrected simulator")
"""Names of the compared sets in all figures and tables. The corrected simulator has the named causes."""

UNKNOWN = "–"
"""Shown instead of a missing number."""


FREE_PHASE = "different in each session"
"""Phase of a once-per-turn effect if the encoder is zeroed at power-on."""

SURELY = 0.995
"""Probability from which on a probability would round to 1.00. Derived: half of the last of two decimals below 1."""

ENDINGS = {
    "%": ("percent",),
    "ms": ("ms",),
    "s": ("s",),
    "deg": ("deg",),
    "deg/s": ("dps",),
    "Hz": ("hz",),
    "ppm": ("ppm",),
    "deg/h": ("dph",),
}
"""Endings of names of parameters by unit."""

UNITS = {"1/h": "per hour"}
"""Units as words."""


def marks(*, has_causes: bool, has_residual: bool = True, is_switched: bool = False) -> list[Mark]:
    """Legend entries of a figure; those that switch curves have the colors as keys."""
    simulated = [("plain", NAMES[1]), ("tuned", NAMES[2])] if has_causes else [("plain", "simulator")]
    residual = [("two", f"residual: recordings − {NAMES[2] if has_causes else 'simulator'}")] * has_residual
    entries = [("ink", NAMES[0]), *simulated, *residual]
    return [Mark(color if is_switched else "", color, "key", name) for color, name in entries]


def size(value: float, unit: str) -> str:
    """A number with its unit."""
    return f"{number(value)} {UNITS.get(unit, unit)}".strip()


def number(value: float, digits: int = 3) -> str:
    """A number with so many significant digits and a true minus."""
    return significant(value, digits).replace("-", "−")


def size_or_bound(parameter: Parameter) -> str:
    """The size with its unit; a bound if its interval ends at the smallest or the largest tried size."""
    limit = "at least " if parameter.is_at_least else "at most " if parameter.is_at_most else ""
    return limit + size(parameter.bound, parameter.unit)


def stated(probability: float) -> str:
    """A probability with two decimals; never 0.00 or 1.00."""
    if probability >= SURELY:
        return "> 0.99"
    return f"{probability:.2f}" if probability >= 1.0 - SURELY else "< 0.01"


def interval(parameter: Parameter) -> str:
    """The 95 % interval of a size."""
    if parameter.is_bound:
        return f"{number(parameter.bound)} or {'more' if parameter.is_at_least else 'less'}"
    low, high = number(parameter.low), number(parameter.high)
    return f"{low} to {high}" if low != high else "no other"


def fitted(cause: NamedCause) -> str:
    """Parameters of a cause in a line, the first with its 95 % interval or as a bound."""
    first, phase = cause.parameters[0], ["a phase that is " + FREE_PHASE] * has_free_phase(cause)
    fixed_ones = [f"{parameter.name} {size(parameter.value, parameter.unit)}" for parameter in others_of(cause)]
    bounds = "" if first.is_bound else f" (95 %: {interval(first)})"
    return ", ".join([f"{first.name} {size_or_bound(first)}{bounds}", *fixed_ones, *phase])


def spoken(parameter: Parameter) -> str:
    """Name of a parameter without the unit that its value has: `delay` for `delay_ms`."""
    name = parameter.name
    ending = next((ending for ending in ENDINGS.get(parameter.unit, ()) if name.endswith(f"_{ending}")), "")
    return (name.removesuffix(f"_{ending}") if ending else name).replace("_", " ")


def has_free_phase(cause: NamedCause) -> bool:
    """Whether the phase was fitted to each session."""
    return cause.cause.phases_deg is not None


def others_of(cause: NamedCause) -> list[Parameter]:
    """Parameters except the size, without a free phase and without values as in the rig."""
    stated = {} if cause.in_rig is None else cause.in_rig.model_dump()
    names = {"phase_deg"} if has_free_phase(cause) else set[str]()
    return [
        parameter
        for parameter in cause.parameters[1:]
        if parameter.name not in names and stated.get(parameter.name) != parameter.value
    ]


def in_rig(cause: NamedCause) -> str:
    """The size in the rig; empty if the rig lacks the effect."""
    first = cause.parameters[0]
    return "" if cause.in_rig is None else size(float(getattr(cause.in_rig, first.name)), first.unit)


def deviates(z: float) -> str:
    """A deviation in standard deviations of chance, without its sign."""
    if not isfinite(z):
        return UNKNOWN
    return f"{abs(z):.1f}" if abs(z) < 100.0 else f"{abs(z):.0f}"


def sigmas(z: float) -> str:
    """A number of standard deviations of chance."""
    return f"{fixed(z, 2)} σ" if isfinite(z) else UNKNOWN


def percent(share: float) -> str:
    """A share in percent, with a decimal from 0.05 % to 10 %."""
    if not isfinite(share):
        return UNKNOWN
    decimals = 0 if abs(share) >= 0.0995 or abs(share) < 0.0005 else 1
    return f"{fixed(100.0 * share, decimals)} %"


def fixed(value: float, decimals: int) -> str:
    """A number with fixed decimals and a true minus; a rounded 0 has no sign."""
    return f"{round(value, decimals) + 0.0:.{decimals}f}".replace("-", "−") if isfinite(value) else UNKNOWN
