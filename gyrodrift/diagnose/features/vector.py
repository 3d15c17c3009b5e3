"""All features of a recording, in one vector; masks and thresholds are derived from their records."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.features import residuals, timing
from gyrodrift.diagnose.features.angle_values import ANGLE_VALUES, AngleValues
from gyrodrift.diagnose.features.design_matrix import COLUMNS, DesignMatrix
from gyrodrift.diagnose.features.feature import Feature, Measured, ResponseLaw, numbers_of
from gyrodrift.diagnose.features.noise import NOISE, sample_noise_of
from gyrodrift.diagnose.features.rate_values import RATE_VALUES, rate_values_of
from gyrodrift.diagnose.recording.outliers import Cleaned

SAMPLE_FEATURES: tuple[Feature, ...] = (*NOISE, *RATE_VALUES, *ANGLE_VALUES)
FEATURES: tuple[Feature, ...] = (*residuals.FEATURES, *SAMPLE_FEATURES, *timing.FEATURES)
NUMBER = numbers_of(FEATURES)

STATIC = len(COLUMNS)
"""The first features: coefficients on one orthonormal basis, all in deg/s."""


def _mask(is_such: Callable[[Feature], bool]) -> Mask:
    return np.array([is_such(feature) for feature in FEATURES])


LINEAR = _mask(lambda feature: feature.response is ResponseLaw.LINEAR)
IS_LOG = _mask(lambda feature: feature.response is ResponseLaw.LOG_VARIANCE)
SLOW = LINEAR | _mask(
    lambda feature: feature.name.startswith(("wander", "walk", "step", "two_levels", "swing", "scatter_"))
)
"""What does not speak of single samples, so that another sample rate leaves it as it is."""

REGRESSORS_OF_MOTION = LINEAR & (np.arange(len(FEATURES)) < len(residuals.FEATURES))
"""Coefficients of a design matrix, which a motion may lack; the clock ratio is linear too, and no motion lacks it."""

OF_MOTION = SLOW | _mask(lambda feature: feature.name.endswith("ripple"))
"""What a motion is taken out of; values, noise, stamps and arrivals are seen without one."""

ALWAYS = ~LINEAR & _mask(lambda feature: feature.regime == "always")
"""What needs no motion."""

OF_TIMES = ALWAYS & _mask(lambda feature: feature.stage in {"clock", "link"})
"""What speaks of stamps and arrivals, whatever the motion."""

OF_LOSS = _mask(lambda feature: feature.name in {"drop_share", "drop_runs"})
"""What never arrived."""

REGRESSORS = np.arange(STATIC)
NOISE_IN_MOTION = tuple(
    np.array([number for name, number in NUMBER.items() if name.startswith(start)])
    for start in ("noise_slow_", "noise_fast_")
)
"""Numbers of features that share one error out among them: coefficients, and how rates scatter over some lengths."""

NOT_OF_STEPS = ~_mask(
    lambda feature: (
        feature.name in {"equal_rest", "equal_moving", "equal_quick", "zero_share", "least_rate", "rate_step"}
    )
)
"""What does not speak of the steps in which rates come."""

SAMPLE_THRESHOLDS = np.array([feature.threshold for feature in SAMPLE_FEATURES])


@dataclass(frozen=True, slots=True)
class Facts:
    """What the rig states and no recording changes.

    dps_per_lsb, encoder_cpr
        One count of the rate, deg/s; counts of the encoder per turn.
    step_dps
        The step that rates come in: a count, or the coarser step of an effect in the rig, deg/s.
    """

    dps_per_lsb: float
    encoder_cpr: int
    step_dps: float


def measure(seen: Cleaned, design: DesignMatrix, facts: Facts) -> Measured:
    """FEATURES of a recording, or of a simulation, against a design matrix."""
    parts = (residuals.measure(seen, design), measure_samples(seen, design, facts), timing.measure(seen.recording))
    return Measured(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def rms_scale(design: DesignMatrix) -> Floats:
    """By which coefficients on an orthonormal basis are divided to be RMS over a session, else 1; shape (features,)."""
    scale = np.ones(len(FEATURES))
    lags = STATIC + design.lag.vectors.shape[1]
    scale[:STATIC] = np.sqrt(len(design.static.vectors))
    scale[STATIC:lags] = np.sqrt(len(design.lag.vectors))
    return scale


def measure_samples(seen: Cleaned, design: DesignMatrix, facts: Facts) -> Measured:
    """Of these SAMPLE_FEATURES: what values come, and how they scatter from sample to sample."""
    noise = sample_noise_of(seen, design, facts.step_dps)
    rates = rate_values_of(seen, design, facts.dps_per_lsb)
    angle = AngleValues(seen, design, 360.0 / facts.encoder_cpr)
    values = [
        *(statistic.compute(noise) for statistic in NOISE),
        *(statistic.compute(rates) for statistic in RATE_VALUES),
        *(statistic.compute(angle) for statistic in ANGLE_VALUES),
    ]
    return Measured(np.array(values), SAMPLE_THRESHOLDS)
