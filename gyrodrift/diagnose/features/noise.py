"""Noise and numbers: how the rate scatters within a second at rest and in motion, and which values it takes."""

import numpy as np
from scipy.ndimage import median_filter

from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.features.design_matrix import Design, means
from gyrodrift.diagnose.features.feature import Feature, Measured
from gyrodrift.diagnose.recording.outliers import Cleaned, granularity

REST_POINTS = (1, 2, 4, 8, 16, 32)
MOVING_POINTS = (1, 2, 4)
WINDOW = 256
FEW_WINDOWS = 8
LINE_POINTS = 31
TAIL_SIGMAS = 5.0
NEAR_ZERO_DPS = 3.0
SMALLEST = 3
"""A dead band may leak twice."""

WHITE_BAND = (0.02, 0.12)
"""Shares of the sample rate: above what 1/f noise adds at rest, below what most filters take away."""

GRAIN_OF_NOISE = 0.3
"""Noise that is less than this share of a count does not show at rest."""

LEAST_POINTS, FEW_SECONDS = 25, 20

LEAST_POWER = 1e-6
"""Of a window whose samples scatter by 1e-4 deg/s: below it there is no noise for a tone to stand out of."""

FEATURES = (
    *(
        Feature(
            f"noise_rest_{points}", "sensor", "rest", f"at rest the noise of {points}-sample means differs in shape"
        )
        for points in REST_POINTS
    ),
    *(
        Feature(f"noise_slow_{points}", "sensor", "slow", f"in slow motion the noise of {points}-sample means differs")
        for points in MOVING_POINTS
    ),
    *(
        Feature(f"noise_fast_{points}", "sensor", "fast", f"in fast motion the noise of {points}-sample means differs")
        for points in MOVING_POINTS
    ),
    Feature("line", "sensor", "rest", "a tone stands out of the noise at rest"),
    Feature("noise_uneven", "sensor", "rest", "the noise comes in bursts"),
    Feature("tails_rest", "sensor", "rest", "the noise at rest has wild values"),
    Feature("tails_moving", "sensor", "moving", "the noise in motion has wild values"),
    Feature("spike_share", "sensor", "always", "single samples are wild"),
    Feature("equal_rest", "sensor", "rest", "neighbouring samples at rest are equal too often"),
    Feature("equal_moving", "link", "moving", "neighbouring samples in motion are equal too often"),
    Feature("equal_quick", "link", "accelerating", "samples repeat while the rate is changing"),
    Feature("zero_share", "sensor", "slow", "the rate reads exactly zero too often"),
    Feature("least_rate", "sensor", "slow", "small rates do not occur"),
    Feature("rate_step", "sensor", "always", "the rate comes in coarser steps than the rig says"),
    Feature("values", "sensor", "always", "fewer different values come than should"),
    Feature("reach", "sensor", "fast", "the largest rates do not reach those of the encoder"),
    Feature("angle_step", "encoder", "always", "the angle comes in coarser steps than the rig says"),
    Feature("angle_noise", "encoder", "moving", "the angle scatters from sample to sample"),
    Feature("slip_count", "encoder", "always", "the angle jumps"),
    Feature("slip_size", "encoder", "always", "the jumps of the angle are large"),
)

FLOORS = np.array(
    [0.08] * len(REST_POINTS)
    + [0.1] * len(MOVING_POINTS)
    + [0.22] * len(MOVING_POINTS)
    + [0.5, 0.15, 0.01, 0.01, 0.008, 0.02, 0.01, 0.035, 0.01, 0.5, 0.15, 0.15, 0.005, 0.15, 0.2, 0.4, 0.3]
)


def white_dps(seen: Cleaned, design: Design, dps_per_lsb: float) -> float:
    """Standard deviation of the white part of a sample, deg/s: of slow noise at rest, past any tone in it."""
    windows = _windows(seen.rate_dps, design.at_rest)
    if len(windows) >= FEW_WINDOWS:
        first, last = (round(share * WINDOW) for share in WHITE_BAND)
        level = float(np.median(_spectrum(windows)[:, first:last]) / np.log(2.0))
        found = np.sqrt(level / np.sum(np.hanning(WINDOW) ** 2))
        if found > GRAIN_OF_NOISE * dps_per_lsb:
            return float(found)
    spread = [_spread(seen.rate_dps, design.at_rest, points, 2) * points / 6.0 for points in (4, 8)]
    found = float(np.sqrt(max(sum(spread) / len(spread), 0.0)))
    return (
        found
        if found > GRAIN_OF_NOISE * dps_per_lsb
        else float(np.sqrt(_spread(seen.rate_dps, design.is_slow, 4, 3) / 5.0))
    )


def measure(seen: Cleaned, design: Design, dps_per_lsb: float, cpr: int) -> Measured:
    """FEATURES of a recording or of a simulation; the rig's facts say what steps are fine."""
    grain = dps_per_lsb**2 / 12.0
    rest = [_log(_spread(seen.rate_dps, design.at_rest, n, 2) * n / 6.0, grain) for n in REST_POINTS]
    slow = [_log(_spread(seen.rate_dps, design.is_slow, n, 3) * n / 20.0, grain) for n in MOVING_POINTS]
    fast = [_log(_spread(seen.rate_dps, design.is_fast, n, 3) * n / 20.0, grain) for n in MOVING_POINTS]
    level = 0.5 * (rest[2] + rest[3])
    values = [
        *(value - level for value in rest),
        *(value - level for value in slow),
        *(value - level for value in fast),
        line_of(seen, design)[0],
        _uneven(seen.rate_dps, design),
        _tails(seen.rate_dps, design.at_rest),
        _tails(seen.rate_dps, design.is_steady),
        _root_share(len(seen.spikes_dps), design.samples),
        *_numbers(seen, design, dps_per_lsb),
        *_angles(seen, design, cpr),
    ]
    return Measured(np.array(values), FLOORS)


def line_of(seen: Cleaned, design: Design) -> tuple[float, float, float]:
    """The strongest tone at rest: logarithm of its height over its neighbours', frequency in Hz, amplitude in deg/s."""
    windows = _windows(seen.rate_dps, design.at_rest)
    if len(windows) < FEW_WINDOWS:
        windows = _windows(seen.rate_dps - design.motion.rate_dps, np.ones(design.samples, bool))
    if not len(windows):
        return 0.0, 0.0, 0.0
    power = np.median(_spectrum(windows), axis=0)[3:]
    around = median_filter(power, LINE_POINTS, mode="nearest") + LEAST_POWER
    best = int(np.argmax(power / around))
    amplitude = 2.0 * np.sqrt(max(power[best] - around[best], 0.0)) / np.hanning(WINDOW).sum()
    return float(np.log(power[best] / around[best] + 1.0)), (best + 3) / (WINDOW * design.period_s), float(amplitude)


def _windows(values: Floats, allowed: Mask) -> Floats:
    """Half-overlapping windows that lie within the allowed samples, shape (windows, WINDOW)."""
    starts = np.arange(0, len(values) - WINDOW + 1, WINDOW // 2)
    total = np.concatenate([[0], np.cumsum(allowed)])
    inside = starts[total[starts + WINDOW] - total[starts] == WINDOW]
    windows: Floats = values[inside[:, None] + np.arange(WINDOW)]
    return windows


def _spectrum(windows: Floats) -> Floats:
    """Power of each, shape (windows, frequencies)."""
    level = windows - windows.mean(axis=1, keepdims=True)
    power: Floats = np.abs(np.fft.rfft(level * np.hanning(WINDOW))) ** 2
    return power


def _uneven(rate_dps: Floats, design: Design) -> float:
    """Logarithm of how much more than usual the noisiest tenth of all seconds scatters."""
    points = max(design.block, LEAST_POINTS)
    calm = means((design.at_rest | design.is_steady)[2:].astype(np.float64), points) > 0.9
    squares = means(np.square(np.diff(rate_dps, 2)), points)[calm]
    if len(squares) < FEW_SECONDS:
        return 0.0
    usual, much = np.quantile(squares, [0.5, 0.9])
    return float(np.log((much + LEAST_POWER) / (usual + LEAST_POWER)))


def _spread(values: Floats, allowed: Mask, points: int, order: int) -> float:
    """Mean square of differences of an order between neighbouring means, of those that lie within allowed samples."""
    count = len(values) // points
    means = values[: count * points].reshape(count, points).mean(axis=1)
    inside = allowed[: count * points].reshape(count, points)[:, 0]
    kept = inside[order:] & inside[:-order]
    for between in range(1, order):
        kept = kept & inside[between : between - order]
    squares = np.square(np.diff(means, order)[kept])
    if not len(squares):
        return 0.0
    limit = 30.0 * float(np.median(squares)) + 1e-12
    return float(np.minimum(squares, limit).mean())


def _log(variance: float, grain: float) -> float:
    return float(np.log(variance + grain))


def _tails(rate_dps: Floats, allowed: Mask) -> float:
    bent = np.abs(np.diff(rate_dps, 2)[allowed[2:]])
    if not len(bent):
        return 0.0
    sigma = float(np.median(bent)) / 0.6745 + 1e-9
    return _root_share(int(np.count_nonzero(bent > TAIL_SIGMAS * sigma)), len(bent))


def _root_share(count: int, of: int) -> float:
    return float(np.sqrt(count / max(of, 1)))


def _numbers(seen: Cleaned, design: Design, dps_per_lsb: float) -> list[float]:
    """Which values the rate takes; only of samples that came, not of those that were filled in."""
    rate_dps = seen.recording.rate_dps
    there = np.isfinite(rate_dps)
    counts = np.rint(np.where(there, rate_dps, 0.0) / dps_per_lsb)
    both = there[1:] & there[:-1]
    equal = (counts[1:] == counts[:-1]) & both
    shares = [
        _root_share(int(np.count_nonzero(equal & regime[1:])), int(np.count_nonzero(both & regime[1:])))
        for regime in (design.at_rest, design.is_fast | design.is_slow, design.is_quick)
    ]
    near = there & (np.abs(rate_dps) < NEAR_ZERO_DPS) if there.any() else there
    small = np.abs(counts[near])
    nonzero = small[small > 0.0]
    least = smallest(nonzero) if len(nonzero) else 1.0
    step = granularity(counts[near]) if near.any() else 1.0
    clean = np.abs(seen.rate_dps) / dps_per_lsb
    top = float(clean.max(initial=1.0))
    fastest = float(np.abs(design.speed_dps).max())
    reach = (top * dps_per_lsb + 1.0) / (fastest + 1.0)
    zeros = _root_share(int(np.count_nonzero(small == 0.0)), len(small))
    different = np.log(len(np.unique(counts[there])) + 1.0)
    return [*shares, zeros, np.log2(max(least, 1.0)), np.log2(max(step, 1.0)), different, np.log(reach)]


def smallest(sizes: Floats) -> float:
    """The smallest of some numbers above 0, but for a few that may be chance."""
    return float(np.partition(sizes, SMALLEST - 1)[SMALLEST - 1]) if len(sizes) >= SMALLEST else float(sizes.min())


def _angles(seen: Cleaned, design: Design, cpr: int) -> list[float]:
    """Steps, scatter and jumps of the angle."""
    count_deg = 360.0 / cpr
    step = max(granularity(seen.recording.encoder_deg) / count_deg, 1.0)
    scatter = _log(_spread(seen.encoder_deg, design.is_fast | design.is_slow, 1, 3) / 20.0, count_deg**2 / 12.0)
    slips = np.abs(seen.slips_deg)
    size = float(np.log2(1.0 + np.median(slips) / count_deg)) if len(slips) else 0.0
    return [np.log2(step), scatter, np.sqrt(len(slips)), size]
