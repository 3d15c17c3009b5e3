"""All features of a recording in one vector, masks of this vector, and the error of features by steps of the rate.

The mean of a rounded value with Gaussian noise of standard deviation σ has an error of at most
step/π·exp(−2π²·σ²/step²). Its sign depends on the position between two steps (B. Widrow, I. Kollár, Quantization Noise,
2008). Relevance thresholds include this error.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gyrodrift.diagnose.features import timing
from gyrodrift.diagnose.features.axes import AXES, axes_of
from gyrodrift.diagnose.features.block_means import LEAST_DPS
from gyrodrift.diagnose.features.block_residuals import block_residuals_of
from gyrodrift.diagnose.features.columns import WARMING, warming_coefficient
from gyrodrift.diagnose.features.design_matrix import COLUMNS, DesignMatrix
from gyrodrift.diagnose.features.feature import Feature, Measured, ResponseLaw, numbers_of
from gyrodrift.diagnose.features.noise import NOISE, sample_noise_of
from gyrodrift.diagnose.features.sample_values import ANGLE_VALUES, RATE_VALUES, AngleValues, rate_values_of
from gyrodrift.diagnose.features.wander import PERIODIC, SCATTER, WALK, WANDER
from gyrodrift.diagnose.features.within_second import LAG_FEATURES, lag_coefficients
from gyrodrift.diagnose.recording.outliers import Cleaned
from gyrodrift.values.arrays import Floats, Mask

BLOCK_STATISTICS = (*WANDER, *PERIODIC, *WALK, *SCATTER)
RESIDUAL_FEATURES: tuple[Feature, ...] = (*COLUMNS, *LAG_FEATURES, WARMING, *BLOCK_STATISTICS)
SAMPLE_FEATURES: tuple[Feature, ...] = (*NOISE, *RATE_VALUES, *ANGLE_VALUES, *AXES)
FEATURES: tuple[Feature, ...] = (*RESIDUAL_FEATURES, *SAMPLE_FEATURES, *timing.FEATURES)
NUMBER = numbers_of(FEATURES)
"""Index in the vector by name of the feature."""

STATIC = len(COLUMNS)
"""Number of static coefficients, the first features: they belong to one orthonormal basis, and are in deg/s."""


def _mask(is_included: Callable[[Feature], bool]) -> Mask:
    return np.array([is_included(feature) for feature in FEATURES])


def _begins(*names: str) -> Mask:
    return _mask(lambda feature: feature.name.startswith(names))


OF_AXES = _mask(lambda feature: feature in AXES)
"""Features of the axes x and y and of gravity; 0 in recordings without three axes."""

LINEAR = _mask(lambda feature: feature.response is ResponseLaw.LINEAR)
IS_LOG = _mask(lambda feature: feature.response is ResponseLaw.LOG_VARIANCE)

SLOW = LINEAR | _begins("wander", "walk", "scatter_")
"""Features that do not change with the sample rate."""

REGRESSORS_OF_MOTION = LINEAR & (np.arange(len(FEATURES)) < len(RESIDUAL_FEATURES))
"""Coefficients of regressors, which a motion may not determine. The clock ratio is linear, too, but needs no motion."""

OF_MOTION = SLOW | _mask(lambda feature: feature.name.endswith("ripple"))
"""Features that need the rebuilt motion; features of values, noise, stamps and arrivals do not."""

ALWAYS = ~LINEAR & _mask(lambda feature: feature.regime == "always")
"""Features that are measured in any regime, so that they need no motion."""

OF_TIMES = ALWAYS & _mask(lambda feature: feature.stage in {"clock", "link"})
"""Features of stamps and arrivals, which do not depend on the motion."""

OF_LOSS = _begins("drop_share", "drop_runs")
"""Features of lost samples."""

FAMILIES = (
    np.flatnonzero(_mask(lambda feature: feature.name != "acceleration") & (np.arange(len(FEATURES)) < STATIC)),
    *(np.flatnonzero(_begins(start)) for start in ("noise_slow_", "noise_fast_")),
)
"""Families of features with a common error: static coefficients, and noise in slow and in fast motion.

The coefficient of the acceleration is no member. From rest to rest, ∫ f(ω)·dω/dt dt is 0 for every f, so a delay is
orthogonal to any error that depends on the rate. The delay of robot wheels may exceed all other coefficients.
"""

OF_EVENTS = _begins("spike_", "slip_")
"""Features of rare events. Some recordings have no such event."""

NOT_OF_STEPS = ~_begins("equal_rest", "equal_moving", "equal_quick", "zero_share", "least_rate", "rate_step")
"""Features that do not depend on the step of the rate."""

BY_BIAS = _begins("wander", "walk", "ripple", "scatter", "line", "noise_uneven")
"""Features that increase with the scatter of block means."""

BY_STEPS = _begins("noise_", "equal_", "zero_share")
"""Features that depend on the levels of the rate."""

STEPS_MOST: Floats = np.where(IS_LOG, 2.0, 0.5)[BY_STEPS]
"""Error of a feature in BY_STEPS if the noise is far below a step: for log variances, and for roots of shares."""

STATIC_SHARE = 0.3
"""Coefficient of a regressor by errors that differ from rate to rate, divided by that of constant errors. Chosen: such
errors largely cancel over the rates of a session."""


@dataclass(frozen=True, slots=True)
class Facts:
    """Facts of the rig that no recording changes.

    dps_per_lsb, encoder_cpr
        One count of the rate, deg/s; counts of the encoder per turn.
    step_dps
        Step of the rates, deg/s: a count, or the coarser step of an effect in the rig.
    has_axes, has_gravity
        Whether the rig has three gyro axes, and an accelerometer. Then all recordings have them, too.
    """

    dps_per_lsb: float
    encoder_cpr: int
    step_dps: float
    has_axes: bool = False
    has_gravity: bool = False


def measure(cleaned: Cleaned, design: DesignMatrix, facts: Facts) -> Measured:
    """FEATURES of a recording or simulation with its design matrix."""
    parts = (
        measure_residuals(cleaned, design),
        measure_samples(cleaned, design, facts),
        timing.measure(cleaned.recording),
    )
    return Measured(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def measure_residuals(cleaned: Cleaned, design: DesignMatrix) -> Measured:
    """RESIDUAL_FEATURES, computed from the difference between gyro and encoder."""
    blocks = block_residuals_of(cleaned, design)
    lags = lag_coefficients(cleaned.rate_dps, cleaned.encoder_deg, design.lag, design.period_s)
    warming = warming_coefficient(blocks.bias_dps, design.warming)
    values = [statistic.compute(blocks) for statistic in BLOCK_STATISTICS]
    limits = [statistic.threshold for statistic in BLOCK_STATISTICS]
    thresholds = design.static.thresholds, design.lag.thresholds, design.warming.thresholds, limits
    return Measured(np.concatenate([blocks.static, lags, warming, values]), np.concatenate(thresholds))


def measure_samples(cleaned: Cleaned, design: DesignMatrix, facts: Facts) -> Measured:
    """SAMPLE_FEATURES, computed from single samples: noise, values, and axes."""
    noise = sample_noise_of(cleaned, design, facts.step_dps)
    rates = rate_values_of(cleaned, design, facts.dps_per_lsb)
    angle = AngleValues(cleaned, design, 360.0 / facts.encoder_cpr)
    axes = axes_of(cleaned.recording, design, has_gravity=facts.has_gravity) if facts.has_axes else None
    values = [
        *(statistic.compute(noise) for statistic in NOISE),
        *(statistic.compute(rates) for statistic in RATE_VALUES),
        *(statistic.compute(angle) for statistic in ANGLE_VALUES),
        *(0.0 if axes is None else statistic.compute(axes) for statistic in AXES),
    ]
    return Measured(np.array(values), np.array([feature.threshold for feature in SAMPLE_FEATURES]))


LOG_RANGE, LEAST_VARIANCE = 20.0, 1e-6
"""Largest logarithm that is taken as a variance, and the least variance of a sum. Chosen: neither overflows nor becomes
0."""

LOGARITHMS = np.flatnonzero(IS_LOG)
"""Indices of features that are logarithms of variances."""

ROOTS = np.flatnonzero(_mask(lambda feature: feature.response is ResponseLaw.ROOT_SHARE))
"""Indices of features that are roots of shares of samples."""


def combined(change: Floats, increment: Floats) -> Floats:
    """Sum of two changes of the features, (…, F).

    A change of a logarithm is that of a variance relative to the same base. If both variances grow, the increases add:
    log(exp(a) + exp(b) - 1). Otherwise the logarithms add.
    """
    added: Floats = change + increment
    first, second = (np.take(values, LOGARITHMS, axis=-1) for values in (change, increment))
    powers = np.exp(np.clip(first, -LOG_RANGE, LOG_RANGE)) + np.exp(np.clip(second, -LOG_RANGE, LOG_RANGE))
    powers_sum = np.log(np.maximum(powers - 1.0, LEAST_VARIANCE))
    added[..., LOGARITHMS] = np.where((first > 0.0) & (second > 0.0), powers_sum, first + second)
    return added


def in_device(change: Floats, offset: Floats, simulated: Floats) -> Floats:
    """Change of the features, (…, F), of a device that differs from its simulator, from the change of the simulator.

    Variances add. So a wander of 1 deg/h doubles that of a calm simulator, and hardly shows in a device that wanders by
    10 deg/h anyway. Shares of samples add in the same way.

    offset
        (F,) difference of the device to the simulator.
    simulated
        (F,) features of the simulator.
    """
    result = combined(np.broadcast_to(offset, change.shape), change) - offset
    added = np.take(change, ROOTS, axis=-1)
    base, device = simulated[ROOTS], np.maximum(simulated + offset, 0.0)[ROOTS]
    shares = np.square(device) + np.square(base + added) - np.square(base)
    result[..., ROOTS] = np.sqrt(np.maximum(shares, 0.0)) - device
    return result


def rms_scale(design: DesignMatrix) -> Floats:
    """Divisors, shape (F,), that turn coefficients of an orthonormal basis into an RMS; 1 for all further features."""
    scale = np.ones(len(FEATURES))
    lags = STATIC + design.lag.vectors.shape[1]
    scale[:STATIC] = np.sqrt(len(design.static.vectors))
    scale[STATIC:lags] = np.sqrt(len(design.lag.vectors))
    return scale


def rounding_error_dps(step_dps: float, sigma_dps: float) -> float:
    """Largest error of the mean of a rate with steps and white noise, deg/s; see the head of this module."""
    return float(step_dps / np.pi * np.exp(-2.0 * (np.pi * sigma_dps / step_dps) ** 2))


def with_rounding_error(
    measured: Measured, error_dps: float, step_dps: float, scatter_dps: float, blocks: int
) -> Measured:
    """Measured features with thresholds that include the error by steps of the rate.

    error_dps
        Largest error of a mean; see `rounding_error_dps`.
    scatter_dps
        Scatter of the block residuals, with which this error is compared.
    """
    if error_dps <= LEAST_DPS:
        return measured
    thresholds: Floats = measured.thresholds.copy()
    log_increase = np.log1p((error_dps / max(scatter_dps, LEAST_DPS)) ** 2)
    thresholds[BY_BIAS] = np.hypot(thresholds[BY_BIAS], log_increase)
    thresholds[:STATIC] = np.hypot(thresholds[:STATIC], STATIC_SHARE * error_dps * np.sqrt(blocks))
    thresholds[BY_STEPS] = np.hypot(thresholds[BY_STEPS], STEPS_MOST * np.pi * error_dps / step_dps)
    return measured._replace(thresholds=thresholds)
