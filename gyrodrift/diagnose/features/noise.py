"""Features of the noise at rest and in motion: variances of short means, a spectral line, bursts and outliers."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from gyrodrift.diagnose.features.block_means import block_means
from gyrodrift.diagnose.features.design_matrix import DesignMatrix
from gyrodrift.diagnose.features.feature import (
    AMPLITUDE_DPS,
    OVER_MIDDLE,
    OVER_NEIGHBORS,
    OVER_USUAL,
    ResponseLaw,
    Statistic,
)
from gyrodrift.diagnose.features.spectral_line import LEAST_NOISE_DPS, spectral_line
from gyrodrift.diagnose.features.spreads import MOVING_LENGTHS, REST_GAIN, REST_LENGTHS, spreads_of
from gyrodrift.diagnose.recording.order_statistics import quantiles
from gyrodrift.diagnose.recording.outliers import Cleaned
from gyrodrift.values.arrays import Floats

LEAST_SPIKES_DPS = 0.05
"""RMS of outliers that is negligible. Chosen: the noise of a sample of a usual gyro."""

LEAST_SAMPLES, FEW_SECONDS = 25, 20
"""Minimum number of samples in a window, and of windows without motion, for a search for bursts. Chosen: mean squares
of fewer samples scatter too much, and two of 20 windows lie beyond the 90 % quantile."""

MIDDLE = (1, 2)
"""Indices in REST_LENGTHS of means of 4 and 8 samples: their mean log variance is the reference for all lengths.
Chosen: `WHITE_LENGTHS` of spectral lines."""


@dataclass(frozen=True, slots=True)
class SampleNoise:
    """Noise of a recording or simulation.

    rest, slow, fast
        Logarithm of the variance of means, scaled to single samples as for white noise, less that of MIDDLE at rest.
        One entry for every length in REST_LENGTHS or MOVING_LENGTHS.
    bends_dps
        Second differences of the rate, shape (n − 2,).
    """

    cleaned: Cleaned
    design: DesignMatrix
    dps_per_lsb: float
    rest: tuple[float, ...]
    slow: tuple[float, ...]
    fast: tuple[float, ...]
    bends_dps: Floats


def sample_noise_of(cleaned: Cleaned, design: DesignMatrix, dps_per_lsb: float) -> SampleNoise:
    """Compute the statistics of the noise.

    A quarter of a squared count is added to all variances. A steady rate between two counts may alternate between
    them, so a variance below this says nothing about the noise.
    """
    grain = dps_per_lsb**2 / 4.0
    spreads = spreads_of(cleaned.rate_dps, design.difference_indices)
    # Less than 3 s of rest gives no level: a trembling robot is calm for moments.
    if np.count_nonzero(design.regimes.at_rest) * design.period_s < 3.0:
        spreads = replace(spreads, rest=(0.0,) * len(REST_LENGTHS))
    rest, slow, fast = (_logs(spread, grain) for spread in (spreads.rest, spreads.slow, spreads.fast))
    level = 0.5 * (rest[MIDDLE[0]] + rest[MIDDLE[1]])
    rest, slow, fast = (tuple(value - level for value in values) for values in (rest, slow, fast))
    return SampleNoise(cleaned, design, dps_per_lsb, rest, slow, fast, np.diff(cleaned.rate_dps, 2))


def root_share(count: int, of: int) -> float:
    """Square root of a share, so that all small shares have the same standard error."""
    return float(np.sqrt(count / max(of, 1)))


def _logs(spreads: Iterable[float], grain: float) -> tuple[float, ...]:
    return tuple(float(np.log(spread + grain)) for spread in spreads)


def _burst_ratio(noise: SampleNoise) -> float:
    """Log of the 90 % quantile over the median of the mean squares of windows; 0 for few windows.

    A window has a second of samples, at least LEAST_SAMPLES. Only windows of rest or steady rotation count.
    """
    length, regimes = max(noise.design.block, LEAST_SAMPLES), noise.design.regimes
    is_calm = block_means((regimes.at_rest | regimes.is_steady)[2:].astype(np.float64), length) > 0.9
    squares = block_means(np.square(noise.bends_dps), length)[is_calm]
    if len(squares) < FEW_SECONDS:
        return 0.0
    usual, much = quantiles(squares, [0.5, 0.9])
    least = REST_GAIN * LEAST_NOISE_DPS**2
    return float(np.log((much + least) / (usual + least)))


def _rest(index: int, length: int) -> Statistic[SampleNoise]:
    return Statistic(
        f"noise_rest_{length}", "sensor", "rest", f"at rest the noise of {length}-sample means differs in shape", 0.08,
        "0.08 in ln of a variance: 4 % of the amplitude", reading=OVER_MIDDLE, response=ResponseLaw.LOG_VARIANCE,
        compute=lambda noise: noise.rest[index],
    )  # fmt: skip


def _slow(index: int, length: int) -> Statistic[SampleNoise]:
    return Statistic(
        f"noise_slow_{length}", "sensor", "slow", f"in slow motion the noise of {length}-sample means differs", 0.1,
        "0.1 in ln of a variance: 5 % of the amplitude", reading=OVER_MIDDLE, response=ResponseLaw.LOG_VARIANCE,
        compute=lambda noise: noise.slow[index],
    )  # fmt: skip


def _fast(index: int, length: int) -> Statistic[SampleNoise]:
    return Statistic(
        f"noise_fast_{length}", "sensor", "fast", f"in fast motion the noise of {length}-sample means differs", 0.22,
        "0.22 in ln of a variance: 11 % of the amplitude", reading=OVER_MIDDLE, response=ResponseLaw.LOG_VARIANCE,
        compute=lambda noise: noise.fast[index],
    )  # fmt: skip


def _spike_power(noise: SampleNoise) -> float:
    """Logarithm of the contribution of outliers to the mean square of all samples."""
    return float(np.log(np.square(noise.cleaned.spikes_dps).sum() / noise.design.samples + LEAST_SPIKES_DPS**2))


# fmt: off
NOISE: tuple[Statistic[SampleNoise], ...] = (
    *(_rest(index, length) for index, length in enumerate(REST_LENGTHS)),
    *(_slow(index, length) for index, length in enumerate(MOVING_LENGTHS)),
    *(_fast(index, length) for index, length in enumerate(MOVING_LENGTHS)),
    Statistic(
        "line", "sensor", "rest", "a tone exceeds the noise at rest", 0.25,
        "0.25 in ln: a quarter more than its neighbors", reading=OVER_NEIGHBORS, response=ResponseLaw.LOG_VARIANCE,
        compute=lambda noise: spectral_line(noise.cleaned, noise.design).log_height,
    ),
    Statistic(
        "noise_uneven", "sensor", "rest", "the noise comes in bursts", 0.15,
        "0.15 in ln of a variance: 8 % of the amplitude", reading=OVER_USUAL, response=ResponseLaw.LOG_VARIANCE,
        compute=_burst_ratio,
    ),
    Statistic(
        "spike_power", "sensor", "always", "single samples are outliers", 0.5,
        "0.5 in ln of a variance: a quarter of the amplitude", reading=AMPLITUDE_DPS, response=ResponseLaw.LOG_VARIANCE,
        compute=_spike_power,
    ),
)
# fmt: on
