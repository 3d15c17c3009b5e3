"""Noise of a gyro in the units of data sheets, °/√h and °/h, beside deg/√s and deg/s."""

from gyrodrift.values.constants import SECONDS_PER_HOUR

ROOT_SECONDS_PER_ROOT_HOUR = 60.0

FLICKER_FLOOR = 0.664
"""√(2 ln 2/π): the flat part of the Allan deviation over the bias instability B (IEEE Std 952-1997, C.1.3).

Flicker noise with the spectral density B²/(2π f) has the Allan deviation √(2 ln 2/π) B at every averaging time.
Some data sheets quote the flat part itself.
"""

FLICKER_WORDS = (
    "the minimum of the Allan deviation over 0.664, as in IEEE 952; some data sheets quote the minimum itself"
)


def random_walk_text(walk_deg_rts: float) -> str:
    """Angle random walk N in both units: 0.005 deg/√s is `0.3 °/√h (0.005 deg/√s)`."""
    return f"{_short(walk_deg_rts * ROOT_SECONDS_PER_ROOT_HOUR)} °/√h ({_short(walk_deg_rts)} deg/√s)"


def hourly_rate_text(rate_dps: float) -> str:
    """Bias, or bias instability, in both units: 0.005 deg/s is `18 °/h (0.005 deg/s)`."""
    return f"{_short(rate_dps * SECONDS_PER_HOUR)} °/h ({_short(rate_dps)} deg/s)"


def _short(value: float) -> str:
    """Three digits, without an exponent unless the value is tiny or huge."""
    return f"{value:.3g}" if abs(value) < 1000.0 else f"{value:,.0f}"
