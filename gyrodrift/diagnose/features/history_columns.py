"""Regressors of how the motion changes and of where it came from: acceleration, reversals, directions, turns in all."""

import numpy as np

from gyrodrift.diagnose.features.design_column import DesignColumn
from gyrodrift.diagnose.features.regimes import SLOW_DPS

MEMORY_S = 10.0
"""Time constant of the recovery after a reversal."""

# fmt: off
HISTORY_COLUMNS: tuple[DesignColumn, ...] = (
    DesignColumn(
        "acceleration", "sensor", "accelerating", "the rate lags or leads when it changes", 3e-4, "0.3 ms of delay",
        compute=lambda terms: terms.acceleration_dpss,
    ),
    DesignColumn(
        "abs_acceleration", "sensor", "accelerating", "the bias grows with any acceleration", 2e-5,
        "0.002 deg/s at 100 deg/s²", in_catalogue=False, compute=lambda terms: np.abs(terms.sharp_dpss),
    ),
    DesignColumn(
        "reversal", "platform", "reversing", "the angle comes late after a reversal", 4e-3,
        "0.008 deg at each reversal", compute=lambda terms: np.gradient(terms.direction, terms.period_s),
    ),
    DesignColumn(
        "direction", "sensor", "rest", "the bias depends on the direction last gone in", 2e-3,
        "0.002 deg/s: 0.12 deg per minute", is_slow=True, in_catalogue=False, compute=lambda terms: terms.direction,
    ),
    DesignColumn(
        "moving", "sensor", "moving", "the bias is another one while it moves", 2e-3,
        "0.002 deg/s: 0.12 deg per minute", is_slow=True, in_catalogue=False,
        compute=lambda terms: (np.abs(terms.speed_dps) > SLOW_DPS).astype(np.float64),
    ),
    DesignColumn(
        "after_turn", "sensor", "reversing", "the bias is shifted after a reversal and recovers", 3e-3,
        "0.03 deg after each reversal", is_slow=True, in_catalogue=False,
        compute=lambda terms: terms.direction * np.exp(-terms.since_s / MEMORY_S),
    ),
    DesignColumn(
        "total_angle", "platform", "always", "the bias follows the angle turned in all", 1e-3,
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
