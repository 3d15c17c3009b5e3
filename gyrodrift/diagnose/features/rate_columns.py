"""Regressors of rate and angle: gain, bends of it, and what comes once or twice per turn."""

from collections.abc import Callable

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.design_column import DesignColumn
from gyrodrift.diagnose.features.motion_terms import MotionTerms

Columns = tuple[DesignColumn, ...]

HINGES_DPS = (60.0, 120.0)
"""Rates above which the gain may be another one."""


def _beyond(rate_dps: Floats, hinge_dps: float) -> Floats:
    """What of a rate lies above a hinge, either way."""
    over_dps: Floats = rate_dps - np.minimum(np.maximum(rate_dps, -hinge_dps), hinge_dps)
    return over_dps


# fmt: off
RATE_COLUMNS: Columns = (
    DesignColumn(
        "rate", "sensor", "moving", "the rate is too high or too low in both directions", 3e-4,
        "0.03 % of scale: 0.1 deg per turn", compute=lambda terms: terms.rate_dps,
    ),
    DesignColumn(
        "abs_rate", "sensor", "moving", "the rate is too high in one direction and too low in the other", 1.5e-4,
        "0.015 % either way: 0.05 deg per turn", compute=lambda terms: np.abs(terms.rate_dps),
    ),
    DesignColumn(
        "rate_squared", "sensor", "fast", "the bias grows with the square of the rate", 3e-7,
        "0.003 deg/s at 100 deg/s: 0.01 deg per turn", compute=lambda terms: terms.rate_dps**2,
    ),
    DesignColumn(
        "rate_cubed", "sensor", "fast", "the gain changes with the rate", 4e-10,
        "0.006 deg/s at 250 deg/s: 0.01 deg per turn", compute=lambda terms: terms.rate_dps * terms.rate_dps**2,
    ),
    DesignColumn(
        "hinge_low", "sensor", "fast", "the gain changes above 60 deg/s", 4e-4,
        "0.04 % of what is above 60 deg/s: less than 0.15 deg per turn", in_catalogue=False,
        compute=lambda terms: _beyond(terms.rate_dps, HINGES_DPS[0]),
    ),
    DesignColumn(
        "hinge_high", "sensor", "fast", "the gain changes above 120 deg/s", 6e-4,
        "0.06 % of what is above 120 deg/s: less than 0.22 deg per turn", in_catalogue=False,
        compute=lambda terms: _beyond(terms.rate_dps, HINGES_DPS[1]),
    ),
)
# fmt: on
"""Of the rate alone."""


Sines = Callable[[MotionTerms], Floats]


def _angle_columns(name: str, often: str, deg: str, sine: Sines, cosine: Sines, *, in_catalogue: bool) -> Columns:
    """Sine and cosine of a multiple of the angle, of a bias and of the angle itself (there they go with the rate)."""
    bias = (f"the bias changes {often} per turn", 2e-3, "0.002 deg/s, which cancels over whole turns")
    angle = (f"the angle errs {often} per turn", 2e-4, f"{deg} deg of the angle")
    return (
        DesignColumn(f"{name}_sine", "sensor", "moving", *bias, in_catalogue=in_catalogue, compute=sine),
        DesignColumn(f"{name}_cosine", "sensor", "moving", *bias, in_catalogue=in_catalogue, compute=cosine),
        DesignColumn(
            f"{name}_sine_rate",
            "encoder",
            "moving",
            *angle,
            in_catalogue=in_catalogue,
            compute=lambda terms: sine(terms) * terms.rate_dps,
        ),
        DesignColumn(
            f"{name}_cosine_rate",
            "encoder",
            "moving",
            *angle,
            in_catalogue=in_catalogue,
            compute=lambda terms: cosine(terms) * terms.rate_dps,
        ),
    )


ANGLE_COLUMNS: Columns = (
    *_angle_columns("turn", "once", "0.011", lambda terms: terms.sine, lambda terms: terms.cosine, in_catalogue=True),
    *_angle_columns(
        "half_turn",
        "twice",
        "0.0057",
        lambda terms: terms.twice_sine,
        lambda terms: terms.twice_cosine,
        in_catalogue=False,
    ),
)
"""Of the angle within the turn."""
