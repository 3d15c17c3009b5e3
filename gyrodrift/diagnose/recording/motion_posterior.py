"""Posterior distribution of the motion of a recording, given its encoder and its gyro.

An encoder count states an interval of the angle, and the moment of its change states the angle at an edge. If the
count changes at every sample, a sample is a measurement with the variance of the interval. If a count is constant for
long, all its samples together are a single such measurement, and the edge is known more precisely. Motion that is
quicker than the counts is taken from the gyro. Its bias is a random walk in the model, so that slow errors of the gyro
do not change the motion.
"""

from dataclasses import dataclass, field
from functools import cache

import numpy as np
from scipy.fft import next_fast_len
from scipy.integrate import cumulative_trapezoid
from scipy.ndimage import uniform_filter1d

from gyrodrift.diagnose.recording.counted_rests import CountedRests
from gyrodrift.diagnose.recording.gyro_noise import NOISE_GAIN, GyroModel, middle_sigma, noise_dps
from gyrodrift.diagnose.recording.kalman import NOT_MEASURED, STATES, FilteredStates, filter_forward, sample_backward
from gyrodrift.diagnose.recording.motion import ReplayedMotion, rough_rate_dps, sensor_c_of
from gyrodrift.diagnose.recording.order_statistics import running_maximum
from gyrodrift.diagnose.recording.outliers import Cleaned, is_at_limit, steps_of
from gyrodrift.diagnose.recording.quick_motion import QuickMotion, quick_motion_of
from gyrodrift.diagnose.recording.rests import STANDS_MOST_S, rest_mask
from gyrodrift.diagnose.recording.smoothing import central_difference, convolved, gaussian, with_ends
from gyrodrift.facts.arrays import samples_in, true_runs
from gyrodrift.io.compile import compiled_once
from gyrodrift.values.arrays import Floats, Integers, Mask

HALF_WINDOWS = (2, 4, 8, 16, 32, 64)
"""Number of samples on either side. Chosen: each is twice the last."""

WINDOWS_AVERAGED, DISAGREES = 2, 2.5
"""Number of windows over which the squared difference of two estimates is averaged, and its largest accepted value, in
variances of noise.

Chosen: averages over more windows reduce the noise on a sine to 0.3 of its size instead of 0.5. But then a slow corner
is rounded by twice as much.
"""


def local_cubic(values: Floats, sigma: float, widest: int) -> Floats:
    """(n,) smoothed values.

    values
        (n,) smooth values with white noise.
    sigma
        Standard deviation of the noise.
    widest
        Largest number of samples on either side.
    """
    kept, before, weights_before = values, values, np.ones(1)
    agrees: Mask = np.ones(len(values), bool)
    for half in HALF_WINDOWS:
        if half > widest or 2 * half + 1 > len(values):
            break
        weights = _weights(half)
        smooth = convolved(with_ends(values, half), weights[half:])
        expected = sigma**2 * float(np.square(_difference(weights, weights_before)).sum())
        power = uniform_filter1d(np.square(smooth - before), WINDOWS_AVERAGED * (2 * half + 1))
        agrees = agrees & (running_maximum(power, 2 * half + 1) <= DISAGREES * expected)
        kept = np.where(agrees, smooth, kept)
        before, weights_before = smooth, weights
    return kept


def _difference(weights: Floats, narrower: Floats) -> Floats:
    """Weights of the difference of two windows."""
    padding = (len(weights) - len(narrower)) // 2
    difference: Floats = weights - np.pad(narrower, padding)
    return difference


@cache
def _weights(half: int) -> Floats:
    """(2 half + 1,) weights of the value in the middle of a cubic least-squares fit (Savitzky and Golay, 1964)."""
    offsets = np.arange(-half, half + 1, dtype=np.float64)
    weights: Floats = np.linalg.pinv(np.vander(offsets, 4, increasing=True))[0]  # four coefficients of a cubic
    weights.flags.writeable = False
    return weights


JERK_STEPS_S = (0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2)
JERK_WINDOW_STEPS = 3
"""Steps over which second differences of the rate show the jerk, and the window of their mean square, in steps.

Chosen: quick motion shows in short steps, slow motion in long ones.
"""

JERK_GAIN = 0.55
"""Variance of a second difference of means, divided by the intensity of the jerk times the third power of the step.
Derived: 11/20 for long steps."""

NOISE_SHARES = 5.0
"""Multiple of the variance by noise that is subtracted from the mean square of these differences. Chosen: the largest
mean square in a window exceeds the mean."""

STEADY_S = 4.0
"""Time over which the filter averages the rate of a motion without jerk, s: sets the least intensity of the jerk.
Chosen: above JERK_STEPS_S."""

CROSSOVER_HZ = 0.1
"""Frequency below which the encoder determines the motion, and above which the gyro does. Chosen: the bias of a gyro
wanders more slowly."""

BIAS_SHARE, BIAS_STEP_S = 0.02, 0.1
"""Change of the bias in the model, as a share of the change of the rate in this time, s.

An error of the gain looks like a bias that changes with the rate. Chosen: common gyros have scale errors of 0.5 to 3 %.
"""

SMOOTH_S = 0.35
"""Widest half window in which a motion is approximated by a cubic, s. Chosen: wider windows would round slow motion."""

CREEP_LIKE = 0.5
"""Least ratio of the shorter neighboring count to a count, in time, at which the count belongs to a creeping motion.

Both steps must have the same direction. Chosen: counts of a steady creep are equally long, and a rest is longer than
its neighbors.
"""

STILL_DEG = 0.01
"""Step of an encoder that never moves. Chosen: finer than the counts of most encoders."""

REST_VARIANCE, REST_JERK = 1e-6, 1e-3
"""Variance of the rate at rest, (deg/s)², and the jerk at rest as a share of the least jerk. Chosen: 0.001 deg/s is far
below the noise of a gyro."""

RAMP_SAMPLES = 512
"""Length of a ramp to 0 that is added at both ends before a shift in time. Chosen: a step would cause ringing."""

DRAW_SMOOTH_S = 0.1
"""Standard deviation of the Gaussian that smooths the difference of a drawn path from the mean, s.

Chosen: the model has white jerk, and a table does not. The roughness of the model would count as noise of the gyro.
"""


@dataclass(frozen=True, slots=True)
class MotionPosterior:
    """Distribution of a recording's motion, from which paths are drawn.

    mean
        Smoothed motion.
    filtered
        Result of the forward filter.
    rests
        First and end sample of every rest.
    encoder_deg
        (n,) angles of the encoder, corrected for its known errors.
    sigma_dps
        White noise of a sample of the gyro.
    quick, lacking
        Spectrum of the motion, and its power by band that the mean lacks.
    """

    mean: ReplayedMotion
    filtered: FilteredStates = field(repr=False)
    rests: tuple[tuple[int, int], ...] = field(repr=False)
    encoder_deg: Floats = field(repr=False)
    sigma_dps: float
    quick: QuickMotion = field(repr=False)
    lacking: Floats = field(repr=False)

    def draw(self, rng: np.random.Generator, within: CountedRests) -> ReplayedMotion:
        """Random motion from the posterior that rests within the counts of the encoder."""
        noise = rng.standard_normal((len(self.mean.angle_deg), STATES))
        path = sample_backward(self.mean.period_s, self.filtered, noise, True)
        away_deg = gaussian(path[:, 0] - self.mean.angle_deg, DRAW_SMOOTH_S / self.mean.period_s)
        away_deg += within.correction_deg(self.mean.angle_deg + away_deg)
        # The rate is the derivative of these angles. Otherwise gyro and encoder would measure different motions.
        away_dps = central_difference(away_deg, self.mean.period_s)
        mean, away = (
            np.column_stack(pair) for pair in ((self.mean.angle_deg, self.mean.rate_dps), (away_deg, away_dps))
        )
        return _motion(mean + away + self.quick.drawn(rng, self.lacking), self.mean, self.rests)


def motion_posterior_of(cleaned: Cleaned, gyro: GyroModel, encoder_deg: Floats | None = None) -> MotionPosterior:
    """Posterior of the motion of a recording.

    encoder_deg
        (n,) angles of the encoder, corrected for its known errors; None takes those of the recording.
    """
    period_s = cleaned.recording.period_s
    angle_deg = cleaned.encoder_deg if encoder_deg is None else encoder_deg
    is_clipped = is_at_limit(cleaned.rate_dps, angle_deg, period_s)
    scatters = ~is_clipped & ((cleaned.rate_dps != 0.0) | (not gyro.hides_rest))
    sigma_dps = max(noise_dps(cleaned.rate_dps[scatters], period_s, gyro), gyro.count_dps / float(np.sqrt(12.0)))
    known_dps = cleaned.rate_dps
    if is_clipped.any():
        known_dps = np.where(is_clipped, rough_rate_dps(cleaned.recording, angle_deg), known_dps)
    rate_dps = _advanced(known_dps, gyro.delay_s / period_s)
    angles, edges, stands_s = _measurements(cleaned, angle_deg)
    at_rest = rest_mask(rate_dps, stands_s, sigma_dps, period_s, cleaned.step_deg)
    quick = quick_motion_of(rate_dps, at_rest, ~at_rest & ~is_clipped, period_s, gyro)
    # Motion that never ends increases the estimate from samples. Without it both estimates differ by less than a fifth.
    if quick.white_dps is not None and quick.white_dps < 0.8 * sigma_dps:
        sigma_dps = quick.white_dps
    jerk = _jerk(rate_dps, sigma_dps, period_s)
    least = sigma_dps**2 * period_s / STEADY_S**5
    jerk = np.where(at_rest, REST_JERK * least, np.maximum(jerk, least))
    change_dpss = np.gradient(uniform_filter1d(rate_dps, samples_in(BIAS_STEP_S, period_s)), period_s)
    crossover = sigma_dps**2 * period_s * (2.0 * np.pi * CROSSOVER_HZ) ** 2
    walk = crossover + BIAS_STEP_S * np.square(BIAS_SHARE * change_dpss)
    rates = rate_dps, np.where(is_clipped, NOT_MEASURED, sigma_dps**2)
    at_rests = np.where(at_rest, REST_VARIANCE, NOT_MEASURED)
    filtered = filter_forward(period_s, angles, edges, rates, at_rests, (jerk, walk))
    no_noise = np.zeros((1, STATES))
    path = _smooth(sample_backward(period_s, filtered, no_noise, False), sigma_dps, period_s)
    path, lacking = quick.completed(path, rate_dps)
    rests = true_runs(at_rest)
    recording = cleaned.recording
    model = ReplayedMotion(period_s, path[:, 0], path[:, 1], sensor_c_of(recording), recording.powered_s)
    return MotionPosterior(_motion(path, model, rests), filtered, rests, angle_deg, sigma_dps, quick, lacking)


def _smooth(path: Floats, sigma_dps: float, period_s: float) -> Floats:
    """(n, 2) path with less noise of the gyro. Motion slower than SMOOTH_S does not change."""
    angle_deg, rate_dps = path[:, 0], path[:, 1]
    change_dps = local_cubic(rate_dps, sigma_dps, samples_in(SMOOTH_S, period_s)) - rate_dps
    change_deg = cumulative_trapezoid(change_dps, dx=period_s, initial=0.0)
    slow_deg = gaussian(change_deg, SMOOTH_S / period_s)
    # The derivative of `change_deg` as the new rate would keep noise that alternates from sample to sample.
    change_dps -= central_difference(slow_deg, period_s)
    return np.column_stack([angle_deg + change_deg - slow_deg, rate_dps + change_dps])


def _motion(path: Floats, model: ReplayedMotion, rests: tuple[tuple[int, int], ...]) -> ReplayedMotion:
    """Motion of a path, (n, 2), with constant angles in its rests; period and temperature are those of `model`."""
    angle_deg, rate_dps = path[:, 0].copy(), path[:, 1].copy()
    for first, end in rests:
        angle_deg[first:end] = angle_deg[first:end].mean()
        rate_dps[first:end] = 0.0
    return ReplayedMotion(model.period_s, angle_deg, rate_dps, model.sensor_c, model.powered_s)


def _measurements(cleaned: Cleaned, angle_deg: Floats) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats], Floats]:
    """Angles and edges with their variances, and time for which the count of a sample is constant, s; all (n,).

    This time is 0 while the device creeps.
    """
    steps_deg = steps_of(cleaned.recording.encoder_deg)
    count_deg = steps_deg.mean or STILL_DEG
    counts = np.rint(cleaned.encoder_deg / count_deg)
    begins = np.flatnonzero(np.concatenate([[True], np.diff(counts) != 0.0]))
    lengths = np.diff(np.concatenate([begins, [len(counts)]]))
    lasts = np.repeat(lengths, lengths)
    most = samples_in(STANDS_MOST_S, cleaned.recording.period_s)
    count_variance = max(count_deg**2 / 12.0 + steps_deg.scatter**2, _encoder_noise_deg(cleaned) ** 2)
    # The samples of a constant count are a single measurement together.
    is_measured = np.isfinite(cleaned.recording.encoder_deg)
    variance = np.where(is_measured, count_variance * np.minimum(lasts, most), NOT_MEASURED)
    edge_deg, edge_variance = np.zeros(len(counts)), np.zeros(len(counts))
    shorter = np.minimum(lengths[1:], lengths[:-1])
    steps = counts[begins[1:]] - counts[begins[1:] - 1]
    clear = (np.abs(steps) == 1.0) & (shorter > 1)
    after = begins[1:][clear]
    between_deg = 0.5 * count_deg * steps[clear]
    edge_deg[after] = angle_deg[after] - between_deg
    # In a sample the angle moves by about a count divided by the samples of the shorter count.
    edge_variance[after] = count_variance / np.square(shorter[clear]) + steps_deg.scatter**2
    stands = np.where(np.repeat(_creeping(steps, lengths), lengths), 0, lasts)
    return (angle_deg, variance), (edge_deg, edge_variance), stands * cleaned.recording.period_s


def _creeping(steps: Floats, lengths: Integers) -> Mask:
    """(counts,) whether a count belongs to a creeping motion: steps of the same direction and similar length.

    steps
        (counts - 1,) changes from a count to the next.
    lengths
        (counts,) number of samples of a count.
    """
    creeping = np.zeros(len(lengths), bool)
    if len(lengths) > 2:
        one_way = steps[1:] * steps[:-1] > 0.0
        creeping[1:-1] = one_way & (np.minimum(lengths[:-2], lengths[2:]) > CREEP_LIKE * lengths[1:-1])
    return creeping


def _encoder_noise_deg(cleaned: Cleaned) -> float:
    """White noise of an angle, from second differences of the angle minus the integrated rate."""
    integrated_deg = np.cumsum(cleaned.rate_dps) * cleaned.recording.period_s
    return middle_sigma(np.diff(cleaned.encoder_deg - integrated_deg, 2)) / float(np.sqrt(NOISE_GAIN))


def _jerk(rate_dps: Floats, sigma_dps: float, period_s: float) -> Floats:
    """(n,) intensity of the white jerk, deg²/s⁵, from the shortest step in which it exceeds noise."""
    intensity = np.zeros(len(rate_dps))
    sums = np.concatenate([[0.0], np.cumsum(rate_dps)])
    for step in dict.fromkeys(samples_in(step_s, period_s) for step_s in JERK_STEPS_S):
        if 3 * step > len(rate_dps):
            break
        bends = np.empty(len(rate_dps) - 3 * step + 1)
        _square_bends(sums, step, bends)
        window = JERK_WINDOW_STEPS * step
        power = running_maximum(uniform_filter1d(bends, window), window)
        excess = np.maximum(power - NOISE_SHARES * NOISE_GAIN * sigma_dps**2 / step, 0.0)
        first = (3 * step) // 2
        _fill(excess / (JERK_GAIN * (step * period_s) ** 3), first, intensity)
    return intensity


@compiled_once()
def _square_bends(sums: Floats, step: int, bends: Floats) -> None:
    """Write the squared second differences of the means of `step` values, from the cumulative sums of the values."""
    for n in range(len(bends)):
        first = (sums[n + step] - sums[n]) / step
        second = (sums[n + 2 * step] - sums[n + step]) / step
        third = (sums[n + 3 * step] - sums[n + 2 * step]) / step
        bend = third - 2.0 * second + first
        bends[n] = bend * bend


@compiled_once()
def _fill(values: Floats, first: int, intensity: Floats) -> None:
    """Write values that begin at sample `first` where the intensity is 0; the ends are repeated beyond them."""
    for n in range(len(intensity)):
        if intensity[n] == 0.0:
            intensity[n] = values[min(max(n - first, 0), len(values) - 1)]


def _advanced(values: Floats, samples: float) -> Floats:
    """(n,) values that are earlier by a number of samples, by a phase shift of their spectrum.

    Linear interpolation would weaken quick motion.
    """
    if samples == 0.0:
        return values
    padded = np.pad(values, RAMP_SAMPLES, mode="linear_ramp")
    size = next_fast_len(len(padded), real=True)
    cycles = np.fft.rfftfreq(size) * samples
    shifted: Floats = np.fft.irfft(np.fft.rfft(padded, size) * np.exp(2j * np.pi * cycles), size)
    return shifted[RAMP_SAMPLES : RAMP_SAMPLES + len(values)]
