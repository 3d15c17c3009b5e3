"""Regressors of rate and angle: gain, bends of it, and what comes once or twice per turn."""

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.design_column import DesignColumn

HINGES_DPS = (60.0, 120.0)
"""Rates above which the gain may be another one."""


def _beyond(rate_dps: Floats, hinge_dps: float) -> Floats:
    """What of a rate lies above a hinge, either way."""
    over_dps: Floats = np.sign(rate_dps) * np.maximum(np.abs(rate_dps) - hinge_dps, 0.0)
    return over_dps


RATE_COLUMNS: tuple[DesignColumn, ...] = (
    DesignColumn(
        "rate",
        "sensor",
        "moving",
        "the rate is too high or too low in both directions",
        3e-4,
        "0.03 % of scale: 0.1 deg per turn",
        compute=lambda terms: terms.rate_dps,
    ),
    DesignColumn(
        "abs_rate",
        "sensor",
        "moving",
        "the rate is too high in one direction and too low in the other",
        1.5e-4,
        "0.015 % either way: 0.05 deg per turn",
        compute=lambda terms: np.abs(terms.rate_dps),
    ),
    DesignColumn(
        "rate_squared",
        "sensor",
        "fast",
        "the bias grows with the square of the rate",
        3e-7,
        "0.003 deg/s at 100 deg/s: 0.01 deg per turn",
        compute=lambda terms: terms.rate_dps**2,
    ),
    DesignColumn(
        "rate_cubed",
        "sensor",
        "fast",
        "the gain changes with the rate",
        4e-10,
        "0.006 deg/s at 250 deg/s: 0.01 deg per turn",
        compute=lambda terms: terms.rate_dps**3,
    ),
    DesignColumn(
        "hinge_low",
        "sensor",
        "fast",
        "the gain changes above 60 deg/s",
        4e-4,
        "0.04 % of what is above 60 deg/s: less than 0.15 deg per turn",
        in_catalogue=False,
        compute=lambda terms: _beyond(terms.rate_dps, HINGES_DPS[0]),
    ),
    DesignColumn(
        "hinge_high",
        "sensor",
        "fast",
        "the gain changes above 120 deg/s",
        6e-4,
        "0.06 % of what is above 120 deg/s: less than 0.22 deg per turn",
        in_catalogue=False,
        compute=lambda terms: _beyond(terms.rate_dps, HINGES_DPS[1]),
    ),
)
"""Of the rate alone."""


def _angle_columns(name: str, order: float, often: str, *, in_catalogue: bool) -> tuple[DesignColumn, ...]:
    """Sine and cosine of a multiple of the angle, of a bias and of the angle itself (there they go with the rate)."""
    bias = (f"the bias changes {often} per turn", 2e-3, "0.002 deg/s, which cancels over whole turns")
    angle = (f"the angle errs {often} per turn", 2e-4, f"{0.0115 / order:.2g} deg of the angle")
    return (
        DesignColumn(
            f"{name}_sine",
            "sensor",
            "moving",
            *bias,
            in_catalogue=in_catalogue,
            compute=lambda terms: np.sin(order * terms.turn),
        ),
        DesignColumn(
            f"{name}_cosine",
            "sensor",
            "moving",
            *bias,
            in_catalogue=in_catalogue,
            compute=lambda terms: np.cos(order * terms.turn),
        ),
        DesignColumn(
            f"{name}_sine_rate",
            "encoder",
            "moving",
            *angle,
            in_catalogue=in_catalogue,
            compute=lambda terms: np.sin(order * terms.turn) * terms.rate_dps,
        ),
        DesignColumn(
            f"{name}_cosine_rate",
            "encoder",
            "moving",
            *angle,
            in_catalogue=in_catalogue,
            compute=lambda terms: np.cos(order * terms.turn) * terms.rate_dps,
        ),
    )


ANGLE_COLUMNS: tuple[DesignColumn, ...] = (
    *_angle_columns("turn", 1.0, "once", in_catalogue=True),
    *_angle_columns("half_turn", 2.0, "twice", in_catalogue=False),
)
"""Of the angle within the turn."""
