"""Words and numbers that several parts of a report share: effects, parameters, deviates, what colours mean."""

from math import isfinite

from firmware_sim.effects.effect import Effect
from gyrodrift.diagnose.inference.parameters import Parameter
from gyrodrift.diagnose.inference.verdict import NamedCause
from gyrodrift.html.html import legend, span, text
from gyrodrift.html.numbers import significant

MEANINGS = {
    "scale_factor": "the rate is too large or too small by the same share at every speed",
    "scale_asymmetry": "the rate is too large in one direction and too small in the other",
    "nonlinearity": "the gain changes with the rate, most at full speed",
    "deadband": "rates below a width read zero",
    "saturation": "rates beyond a limit are cut off",
    "quantization": "the rate comes in coarser steps than the rig says",
    "bandwidth": "quick changes of the rate are smoothed away and come late",
    "latency": "the rate comes a fixed time later than the motion",
    "bias_instability": "the bias wanders slowly, and stays about where it is (1/f noise)",
    "rate_random_walk": "the bias walks away by small random steps",
    "popcorn": "the bias jumps to and fro between two levels",
    "spikes": "now and then a single rate is wild",
    "vibration": "a tone of one frequency lies in the rate",
    "vibration_rectification": "the bias grows with the square of the rate",
    "g_sensitivity": "the bias changes once per turn, as on a tilted table",
    "temp_bias": "the bias follows the temperature",
    "temp_scale": "the gain follows the temperature",
    "warmup": "the bias settles after power-on, quickly first and then slower",
    "encoder_eccentricity": "the encoder's angle errs once per turn, as with a disc off its centre",
    "encoder_slip": "the encoder's angle jumps, and stays there",
    "encoder_quantization": "the encoder has fewer counts per turn than the rig says",
    "backlash": "the encoder stays behind by a play when the motion reverses",
    "clock_drift": "the device's clock runs fast or slow against the host's",
    "timestamp_jitter": "the device's time stamps scatter",
    "usb_batching": "samples reach the host in bunches",
    "sample_drop": "samples never arrive",
    "stale_hold": "a sample repeats the one before it",
}
"""What each effect does, for a person; of others their own description tells."""

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


def meaning(effect: Effect) -> str:
    """What an effect does, in a sentence, as HTML."""
    first, *_ = (type(effect).__doc__ or "").split("\n")
    return text(MEANINGS.get(effect.name, first.strip(".")))


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
