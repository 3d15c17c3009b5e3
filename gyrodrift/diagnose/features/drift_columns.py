"""Regressors of temperature and time: what a bias and a gain may follow slowly."""

import numpy as np

from gyrodrift.diagnose.features.design_column import DesignColumn

DECAYS_S = (40.0, 160.0)
"""Time constants of a fast and of a slow settling after power-on."""

# fmt: off
DRIFT_COLUMNS: tuple[DesignColumn, ...] = (
    DesignColumn(
        "temperature", "environment", "warm", "the bias follows the temperature", 6e-4,
        "0.0006 deg/s per °C: 2 deg/h for each degree", is_slow=True, compute=lambda terms: terms.warm_c,
    ),
    DesignColumn(
        "temperature_squared", "environment", "warm", "the bias bends with the temperature", 6e-5,
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
