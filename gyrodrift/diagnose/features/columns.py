"""Regressors of the block residuals, from rate, angle, temperature, time and history; and the feature `warming`."""

from collections.abc import Callable

import numpy as np

from gyrodrift.diagnose.features.block_means import block_means
from gyrodrift.diagnose.features.feature import RMS_DPS, Feature, ResponseLaw
from gyrodrift.diagnose.features.motion_terms import DesignColumn, MotionTerms
from gyrodrift.diagnose.features.orthogonal import Basis, orthonormal
from gyrodrift.diagnose.features.regimes import SLOW_DPS
from gyrodrift.diagnose.features.within_second import smoothed
from gyrodrift.values.arrays import Floats

Columns = tuple[DesignColumn, ...]

HINGES_DPS = (60.0, 120.0)
"""Rates above which the gain may differ, deg/s. Chosen: two rates within fast motion, an octave apart."""


def _beyond(rate_dps: Floats, hinge_dps: float) -> Floats:
    """Part of a rate beyond a hinge, in both directions, deg/s."""
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
"""Columns that are functions of the rate."""


Sines = Callable[[MotionTerms], Floats]


def _angle_columns(name: str, often: str, deg: str, sine: Sines, cosine: Sines, *, in_catalogue: bool) -> Columns:
    """Sine and cosine of a multiple of the angle, alone for a bias, and times the rate for an angle error."""
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
        lambda terms: 2.0 * terms.sine * terms.cosine,
        lambda terms: (terms.cosine - terms.sine) * (terms.cosine + terms.sine),
        in_catalogue=False,
    ),
)
"""Columns that are periodic in the angle."""


DECAYS_S = (40.0, 160.0)
"""Time constants of a fast and a slow decay of the bias after power-on, s. Chosen: one within the first minute, and one
over minutes."""

# fmt: off
DRIFT_COLUMNS: tuple[DesignColumn, ...] = (
    DesignColumn(
        "temperature", "environment", "warm", "the bias follows the temperature", 6e-4,
        "0.0006 deg/s per °C: 2 deg/h for each degree", is_slow=True, compute=lambda terms: terms.warm_c,
    ),
    DesignColumn(
        "temperature_squared", "environment", "warm", "the bias follows the temperature along a curve", 6e-5,
        "10 °C off the middle as much as a slope of 0.0006 deg/s per °C", is_slow=True,
        compute=lambda terms: terms.warm_c**2,
    ),
    DesignColumn(
        "temperature_rate", "environment", "warm", "the gain follows the temperature", 3e-5,
        "0.003 % of scale per °C: 0.01 deg per turn", compute=lambda terms: terms.warm_c * terms.rate_dps,
    ),
    DesignColumn(
        "decay_fast", "environment", "early", "the bias decays in the first minute after power-on", 6e-3,
        "0.006 deg/s at power-on: 0.24 deg until it is gone", is_slow=True,
        compute=lambda terms: np.exp(-terms.powered_s / DECAYS_S[0]),
    ),
    DesignColumn(
        "decay_slow", "environment", "early", "the bias decays over minutes after power-on", 6e-3,
        "0.006 deg/s at power-on: 1 deg until it is gone", is_slow=True,
        compute=lambda terms: np.exp(-terms.powered_s / DECAYS_S[1]),
    ),
    DesignColumn(
        "time", "sensor", "late", "the bias drifts from the beginning to the end", 6e-3,
        "0.003 deg/s either way of its mean", is_slow=True, in_catalogue=False, compute=lambda terms: terms.share,
    ),
    DesignColumn(
        "time_squared", "sensor", "late", "the bias drifts and comes back", 6e-3,
        "0.0015 deg/s between the middle and the ends", is_slow=True, compute=lambda terms: terms.share**2,
    ),
)
# fmt: on


WARMING_BLOCKS = 20
"""Blocks in a mean; differences of successive means of the bias are compared with those of the temperature. Chosen:
noise averages out, and a warm-up is longer."""

# fmt: off
WARMING = Feature(
    "warming", "environment", "warm", "the bias changes when the temperature changes", 6e-4,
    "0.0006 deg/s per °C, as of `temperature`", reading=RMS_DPS, response=ResponseLaw.LINEAR,
)
# fmt: on


def warming_basis(sensor_c: Floats, block: int) -> Basis:
    """Basis of WARMING, shape (steps, 1), from the temperature of every sample."""
    steps_c = np.diff(block_means(sensor_c, block * WARMING_BLOCKS))[:, None]
    vectors, thresholds = orthonormal(steps_c, np.array([WARMING.threshold]), 0)
    return Basis(vectors, np.hypot(thresholds, 4e-3))  # a bias that wanders by itself has such steps


def warming_coefficient(bias_dps: Floats, basis: Basis) -> Floats:
    """Coefficient of WARMING, shape (1,), from the bias of every block, deg/s."""
    coefficient: Floats = basis.vectors.T @ np.diff(block_means(bias_dps, WARMING_BLOCKS))
    return coefficient


MEMORY_S = 10.0
"""Time constant of the recovery after a reversal, s. Chosen: longer than a block, shorter than a minute."""

# fmt: off
HISTORY_COLUMNS: tuple[DesignColumn, ...] = (
    DesignColumn(
        "acceleration", "sensor", "accelerating", "the rate lags or leads when it changes", 3e-4, "0.3 ms of delay",
        compute=lambda terms: np.gradient(terms.speed_dps, terms.period_s),
    ),
    DesignColumn(
        "abs_acceleration", "sensor", "accelerating", "the bias grows with any acceleration", 2e-5,
        "0.002 deg/s at 100 deg/s²", in_catalogue=False,
        compute=lambda terms: np.abs(np.gradient(smoothed(terms.rate_dps, terms.period_s), terms.period_s)),
    ),
    DesignColumn(
        "reversal", "platform", "reversing", "the angle comes late after a reversal", 4e-3,
        "0.008 deg at each reversal", compute=lambda terms: np.gradient(terms.direction, terms.period_s),
    ),
    DesignColumn(
        "direction", "sensor", "rest", "the bias depends on the last direction of motion", 2e-3,
        "0.002 deg/s: 0.12 deg per minute", is_slow=True, in_catalogue=False, compute=lambda terms: terms.direction,
    ),
    DesignColumn(
        "moving", "sensor", "moving", "the bias differs in motion", 2e-3,
        "0.002 deg/s: 0.12 deg per minute", is_slow=True, in_catalogue=False,
        compute=lambda terms: (np.abs(terms.speed_dps) > SLOW_DPS).astype(np.float64),
    ),
    DesignColumn(
        "after_turn", "sensor", "reversing", "the bias is shifted after a reversal and recovers", 3e-3,
        "0.03 deg after each reversal", is_slow=True, in_catalogue=False,
        compute=lambda terms: terms.direction * np.exp(-terms.since_s / MEMORY_S),
    ),
    DesignColumn(
        "total_angle", "platform", "always", "the bias follows the total angle turned", 1e-3,
        "0.001 deg/s for each turn away from the start", is_slow=True, in_catalogue=False,
        compute=lambda terms: terms.motion.angle_deg / 360.0,
    ),
    DesignColumn(
        "time_rate", "sensor", "late", "the gain drifts with time", 4e-4,
        "0.02 % of scale either way of its mean: 0.07 deg per turn", in_catalogue=False,
        compute=lambda terms: terms.share * terms.rate_dps,
    ),
)
# fmt: on
