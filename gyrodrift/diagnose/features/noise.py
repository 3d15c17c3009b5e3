"""Noise of the rate within a second, at rest and in motion: its level by averaging, a spectral line, bursts, tails."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.features.block_means import block_means
from gyrodrift.diagnose.features.design_matrix import DesignMatrix
from gyrodrift.diagnose.features.feature import (
    AMPLITUDE_DPS,
    OVER_MIDDLE,
    OVER_NEIGHBOURS,
    OVER_USUAL,
    PERCENT_OF_SAMPLES,
    ResponseLaw,
    Statistic,
)
from gyrodrift.diagnose.features.spectral_line import LEAST_POWER, spectral_line
from gyrodrift.diagnose.features.spreads import MOVING_POINTS, REST_POINTS, spreads_of
from gyrodrift.diagnose.recording.order_statistics import MEDIAN_TO_SIGMA
from gyrodrift.diagnose.recording.outliers import Cleaned

TAIL_SIGMAS = 5.0

GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
"""Multiples of it less their whole part are spread evenly, however many there are."""

LEAST_SPIKES_DPS = 0.05
"""RMS by outliers that does not matter: the noise of a sample of a usual gyro."""

LEAST_POINTS, FEW_SECONDS = 25, 20
"""Samples in a second whose scatter is known, and the seconds without motion that bursts are looked for in."""

MIDDLE = (2, 3)
"""Of REST_POINTS: means of 4 and 8 samples, whose mean is the level that all others are compared with."""


@dataclass(frozen=True, slots=True)
class SampleNoise:
    """Noise of a recording or simulation.

    rest, slow, fast
        Logarithm of the variance of means of REST_POINTS or MOVING_POINTS samples, taken to single samples as if it
        were white, less that of the middle at rest.
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
    """What the features of noise are computed from.

    A steady rate between two counts may come as either or as both: up to a quarter of a count squared is no noise.
    """
    grain = dps_per_lsb**2 / 4.0
    spreads = spreads_of(cleaned.rate_dps, design.difference_indices)
    # A robot that trembles happens to be calm for moments: with less than 3 s in all, rest gives no level.
    if np.count_nonzero(design.regimes.at_rest) * design.period_s < 3.0:
        spreads = replace(spreads, rest=(0.0,) * len(REST_POINTS))
    rest, slow, fast = (_logs(spread, grain) for spread in (spreads.rest, spreads.slow, spreads.fast))
    level = 0.5 * (rest[MIDDLE[0]] + rest[MIDDLE[1]])
    rest, slow, fast = (tuple(value - level for value in values) for values in (rest, slow, fast))
    return SampleNoise(cleaned, design, dps_per_lsb, rest, slow, fast, np.diff(cleaned.rate_dps, 2))


def root_share(count: int, of: int) -> float:
    """Square root of a share: small shares scatter equally in it."""
    return float(np.sqrt(count / max(of, 1)))


def _logs(spreads: Iterable[float], grain: float) -> tuple[float, ...]:
    return tuple(float(np.log(spread + grain)) for spread in spreads)


def _burst_ratio(noise: SampleNoise) -> float:
    """Logarithm of how much more than usual the noisiest tenth of all seconds scatters."""
    points, regimes = max(noise.design.block, LEAST_POINTS), noise.design.regimes
    # Share of samples that rest or turn steadily.
    calm = block_means((regimes.at_rest | regimes.is_steady)[2:].astype(np.float64), points) > 0.9
    squares = block_means(np.square(noise.bends_dps), points)[calm]
    if len(squares) < FEW_SECONDS:
        return 0.0
    usual, much = np.quantile(squares, [0.5, 0.9])
    return float(np.log((much + LEAST_POWER) / (usual + LEAST_POWER)))


def _tails(noise: SampleNoise, allowed: Mask) -> float:
    """Root of the share of second differences beyond TAIL_SIGMAS.

    They are spread evenly within their steps: else the median of few counts is one of two, and what is beyond it jumps.
    """
    bends_dps = noise.bends_dps[allowed[2:]]
    within = np.arange(len(bends_dps)) * GOLDEN % 1.0 - 0.5
    sizes = np.abs(bends_dps + noise.dps_per_lsb * within)
    if not len(sizes):
        return 0.0
    # Below 1.2 counts, steps of one count would pass for tails.
    sigma = max(np.median(sizes) / MEDIAN_TO_SIGMA, 1.2 * noise.dps_per_lsb)
    return root_share(int(np.count_nonzero(sizes > TAIL_SIGMAS * sigma)), len(sizes))


def _rest(number: int, points: int) -> Statistic[SampleNoise]:
    return Statistic(
        f"noise_rest_{points}", "sensor", "rest", f"at rest the noise of {points}-sample means differs in shape", 0.08,
        "0.08 in ln of a variance: 4 % of the amplitude", reading=OVER_MIDDLE, response=ResponseLaw.LOG_VARIANCE,
        compute=lambda noise: noise.rest[number],
    )  # fmt: skip


def _slow(number: int, points: int) -> Statistic[SampleNoise]:
    return Statistic(
        f"noise_slow_{points}", "sensor", "slow", f"in slow motion the noise of {points}-sample means differs", 0.1,
        "0.1 in ln of a variance: 5 % of the amplitude", reading=OVER_MIDDLE, response=ResponseLaw.LOG_VARIANCE,
        compute=lambda noise: noise.slow[number],
    )  # fmt: skip


def _fast(number: int, points: int) -> Statistic[SampleNoise]:
    return Statistic(
        f"noise_fast_{points}", "sensor", "fast", f"in fast motion the noise of {points}-sample means differs", 0.22,
        "0.22 in ln of a variance: 11 % of the amplitude", reading=OVER_MIDDLE, response=ResponseLaw.LOG_VARIANCE,
        compute=lambda noise: noise.fast[number],
    )  # fmt: skip


def _spike_power(noise: SampleNoise) -> float:
    """Logarithm of the mean square of all samples by their outliers alone."""
    return float(np.log(np.square(noise.cleaned.spikes_dps).sum() / noise.design.samples + LEAST_SPIKES_DPS**2))


# fmt: off
NOISE: tuple[Statistic[SampleNoise], ...] = (
    *(_rest(number, points) for number, points in enumerate(REST_POINTS)),
    *(_slow(number, points) for number, points in enumerate(MOVING_POINTS)),
    *(_fast(number, points) for number, points in enumerate(MOVING_POINTS)),
    Statistic(
        "line", "sensor", "rest", "a tone exceeds the noise at rest", 0.5,
        "0.5 in ln: two thirds more than its neighbours", reading=OVER_NEIGHBOURS, response=ResponseLaw.LOG_VARIANCE,
        compute=lambda noise: spectral_line(noise.cleaned, noise.design).log_height,
    ),
    Statistic(
        "noise_uneven", "sensor", "rest", "the noise comes in bursts", 0.15,
        "0.15 in ln of a variance: 8 % of the amplitude", reading=OVER_USUAL, response=ResponseLaw.LOG_VARIANCE,
        compute=_burst_ratio,
    ),
    Statistic(
        "tails_rest", "sensor", "rest", "the noise at rest has outliers", 0.01, "one sample in 10,000",
        reading=PERCENT_OF_SAMPLES, compute=lambda noise: _tails(noise, noise.design.regimes.at_rest),
    ),
    Statistic(
        "tails_moving", "sensor", "moving", "the noise in motion has outliers", 0.01, "one sample in 10,000",
        reading=PERCENT_OF_SAMPLES, compute=lambda noise: _tails(noise, noise.design.regimes.is_steady),
    ),
    Statistic(
        "spike_power", "sensor", "always", "single samples are outliers", 0.5,
        "0.5 in ln of a variance: a quarter of the amplitude", reading=AMPLITUDE_DPS, response=ResponseLaw.LOG_VARIANCE,
        compute=_spike_power,
    ),
)
# fmt: on
