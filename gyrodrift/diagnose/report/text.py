"""Words and numbers that several parts of a report share: effects, parameters, deviates, what colours mean."""

from math import isfinite

from gyrodrift.diagnose.inference.parameters import Parameter
from gyrodrift.diagnose.inference.verdict import NamedCause
from gyrodrift.html.html import legend, span, text
from gyrodrift.html.numbers import significant

NAMES = ("recordings", "simulated before", "simulated after")
"""What is compared, in all figures and tables: before and after the causes are added to the rig."""

REAL, BEFORE, AFTER = zip(("", "plain", "tuned"), ("key", "key", "key"), NAMES, strict=True)
LEFT = ("two", "key", "unexplained")
UNKNOWN = "–"
"""In the place of a number that there is not."""


UNITS = {"1/h": "per hour"}
"""Those that read better in words."""


def marks(*, has_causes: bool, has_left: bool = True) -> str:
    """The legend of all figures."""
    simulated = [BEFORE, AFTER] if has_causes else [(*BEFORE[:2], "simulated")]
    return legend([REAL, *simulated, *[LEFT] * has_left])


def size(value: float, unit: str) -> str:
    """A number with its unit."""
    return f"{number(value)} {text(UNITS.get(unit, unit))}".strip()


def number(value: float, digits: int = 3) -> str:
    """So many digits, with a true minus."""
    return significant(value, digits).replace("-", "−")


def interval(parameter: Parameter) -> str:
    """Sizes that would do nearly as well."""
    low, high = number(parameter.low), number(parameter.high)
    return f"{low} to {high}" if low != high else "no other as good"


def fitted(cause: NamedCause) -> str:
    """Parameters of a cause in a line."""
    first, *others = cause.parameters
    held = [f"{text(one.name)} {size(one.value, one.unit)}" for one in others]
    return ", ".join([f"{text(first.name)} {size(first.value, first.unit)} ({interval(first)})", *held])


def deviates(z: float) -> str:
    """How many times chance something is off."""
    if not isfinite(z):
        return UNKNOWN
    return f"{abs(z):.1f}" if abs(z) < 100.0 else f"{abs(z):.0f}"


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
