"""The posterior of a recording's motion: all that its encoder and its gyro leave possible.

A count of an encoder says that the angle lies within an interval, and the moment at which it changes says where the
angle was. Where counts follow fast, each is a measurement with the variance of its interval; where one count stands
long, all its samples together are one such measurement, and what is known well is the edge that was crossed. What is
quicker than the counts is the gyro's: its bias walks in the model, so that slow errors of the gyro bend no motion.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.fft import next_fast_len
from scipy.integrate import cumulative_trapezoid
from scipy.ndimage import maximum_filter1d, uniform_filter1d

from gyrodrift.arrays import Floats, Integers, Mask
from gyrodrift.diagnose.recording.counted_rests import CountedRests
from gyrodrift.diagnose.recording.gyro_noise import NOISE_GAIN, GyroModel, middle_sigma, noise_dps
from gyrodrift.diagnose.recording.kalman import NOT_MEASURED, STATES, Passed, filtered, smoothed_back
from gyrodrift.diagnose.recording.local_cubic import local_cubic
from gyrodrift.diagnose.recording.motion import ReplayedMotion, rough_rate_dps, sensor_c_of
from gyrodrift.diagnose.recording.outliers import Cleaned, is_at_limit, steps_of
from gyrodrift.diagnose.recording.quick_motion import QuickMotion, quick_motion_of
from gyrodrift.diagnose.recording.rests import STANDS_MOST_S, rest_mask, samples_in, true_runs
from gyrodrift.diagnose.recording.smoothing import central_difference, gaussian

JERK_STEPS_S = (0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2)
JERK_WINDOW_STEPS = 3
"""How hard the motion is driven shows in second differences of the rate over short steps where it is quick, over long
ones where it is gentle; within so many steps."""

JERK_GAIN = 0.6
"""Variance of such a difference of means, over intensity of the jerk times the third power of the step."""

NOISE_SHARES = 5.0
"""So many times what noise makes of it, and less, is no jerk."""

STEADY_S = 4.0
"""Time over which the rate is averaged where nothing drives the motion."""

CROSSOVER_HZ = 0.1
"""Below it the encoder, above it the gyro says how the device moves."""

BIAS_SHARE, BIAS_STEP_S = 0.02, 0.1
"""Of its acceleration over so long, by which the bias of the gyro may change: errors of its gain go with the motion."""

SMOOTH_S = 0.35
"""Widest half window over which a motion is taken for a cubic."""

CREEP_LIKE = 0.5
"""A count that stands between two steps of one direction, and no longer than its neighbours over this, is creeping."""

STILL_DEG = 0.01
"""Stands for a count of an encoder that never moved."""

REST_VARIANCE, REST_JERK = 1e-6, 1e-3
"""Of the rate at rest, (deg/s)², and of the jerk beside that of steady motion."""

RAMP_SAMPLES = 512
"""Over so many, values go to 0 beyond either end before they are moved in time: a step there would ring."""

DRAW_SMOOTH_S = 0.1
"""Standard deviation of the Gaussian over what a drawn path is off the mean: the roughness of the model's white jerk,
which no table has, would pass for noise of the gyro."""


@dataclass(frozen=True, slots=True)
class MotionPosterior:
    """Distribution of a recording's motion, from which paths are drawn.

    mean
        The smoothed motion.
    passed
        What the forward filter gave.
    rests
        First sample, and the one after the last, of each rest.
    encoder_deg
        (n,) angles of the encoder that it follows.
    sigma_dps
        White noise of a sample of the gyro.
    quick, lacking
        Spectrum of the motion, and the power by band that is not in its mean.
    """

    mean: ReplayedMotion
    passed: Passed = field(repr=False)
    rests: tuple[tuple[int, int], ...] = field(repr=False)
    encoder_deg: Floats = field(repr=False)
    sigma_dps: float
    quick: QuickMotion = field(repr=False)
    lacking: Floats = field(repr=False)

    def draw(self, rng: np.random.Generator, within: CountedRests) -> ReplayedMotion:
        """A motion that encoder and gyro leave possible, and that rests within the counts that were seen."""
        noise = rng.standard_normal((len(self.mean.angle_deg), STATES))
        path = smoothed_back(self.mean.period_s, self.passed, noise, True)
        away_deg = gaussian(path[:, 0] - self.mean.angle_deg, DRAW_SMOOTH_S / self.mean.period_s)
        away_deg += within.correction_deg(self.mean.angle_deg + away_deg)
        # The rate is that of the very angles, or gyro and encoder would see two motions.
        away_dps = central_difference(away_deg, self.mean.period_s)
        mean, away = (
            np.column_stack(pair) for pair in ((self.mean.angle_deg, self.mean.rate_dps), (away_deg, away_dps))
        )
        return _motion(mean + away + self.quick.drawn(rng, self.lacking), self.mean, self.rests)


def motion_posterior_of(seen: Cleaned, gyro: GyroModel, encoder_deg: Floats | None = None) -> MotionPosterior:
    """Of a recording without holes, outliers and jumps; `encoder_deg` are its angles where they were corrected."""
    period_s = seen.recording.period_s
    angle_deg = seen.encoder_deg if encoder_deg is None else encoder_deg
    is_clipped = is_at_limit(seen.rate_dps, angle_deg, period_s)
    scatters = ~is_clipped & ((seen.rate_dps != 0.0) | (not gyro.hides_rest))
    sigma_dps = max(noise_dps(seen.rate_dps[scatters], period_s, gyro), gyro.count_dps / float(np.sqrt(12.0)))
    known_dps = seen.rate_dps
    if is_clipped.any():
        known_dps = np.where(is_clipped, rough_rate_dps(seen.recording, angle_deg), known_dps)
    rate_dps = _advanced(known_dps, gyro.delay_s / period_s)
    angles, edges, stands_s = _measurements(seen, angle_deg)
    at_rest = rest_mask(rate_dps, stands_s, sigma_dps, period_s, seen.step_deg)
    quick = quick_motion_of(rate_dps, at_rest, ~at_rest & ~is_clipped, period_s, gyro)
    # Motion that never ends widens an estimate by samples; where it has no part, both differ by less than a fifth.
    if quick.white_dps is not None and quick.white_dps < 0.8 * sigma_dps:
        sigma_dps = quick.white_dps
    jerk = _jerk(rate_dps, sigma_dps, period_s)
    least = sigma_dps**2 * period_s / STEADY_S**5
    jerk = np.where(at_rest, REST_JERK * least, np.maximum(jerk, least))
    change_dpss = np.gradient(uniform_filter1d(rate_dps, samples_in(BIAS_STEP_S, period_s)), period_s)
    crossover = sigma_dps**2 * period_s * (2.0 * np.pi * CROSSOVER_HZ) ** 2
    walk = crossover + BIAS_STEP_S * np.square(BIAS_SHARE * change_dpss)
    rates = rate_dps, np.where(is_clipped, NOT_MEASURED, sigma_dps**2)
    passed = filtered(period_s, angles, edges, rates, np.where(at_rest, REST_VARIANCE, NOT_MEASURED), (jerk, walk))
    none = np.zeros((1, STATES))
    path = _smooth(smoothed_back(period_s, passed, none, False), sigma_dps, period_s)
    path, lacking = quick.completed(path, rate_dps)
    found = true_runs(at_rest)
    like = ReplayedMotion(period_s, path[:, 0], path[:, 1], sensor_c_of(seen.recording), seen.recording.powered_s)
    return MotionPosterior(_motion(path, like, found), passed, found, angle_deg, sigma_dps, quick, lacking)


def _smooth(path: Floats, sigma_dps: float, period_s: float) -> Floats:
    """A path without the noise of the gyro, as far as it is smooth; what is slower than SMOOTH_S stays as it is."""
    angle_deg, rate_dps = path[:, 0], path[:, 1]
    less_dps = local_cubic(rate_dps, sigma_dps, samples_in(SMOOTH_S, period_s)) - rate_dps
    less_deg = cumulative_trapezoid(less_dps, dx=period_s, initial=0.0)
    slow_deg = gaussian(less_deg, SMOOTH_S / period_s)
    # A derivative of `less_deg` would leave in the path what alternates from sample to sample.
    less_dps -= central_difference(slow_deg, period_s)
    return np.column_stack([angle_deg + less_deg - slow_deg, rate_dps + less_dps])


def _motion(path: Floats, like: ReplayedMotion, rests: tuple[tuple[int, int], ...]) -> ReplayedMotion:
    """A path of angles and rates, that stands still where it rests."""
    angle_deg, rate_dps = path[:, 0].copy(), path[:, 1].copy()
    for first, end in rests:
        angle_deg[first:end] = angle_deg[first:end].mean()
        rate_dps[first:end] = 0.0
    return ReplayedMotion(like.period_s, angle_deg, rate_dps, like.sensor_c, like.powered_s)


def _measurements(seen: Cleaned, angle_deg: Floats) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats], Floats]:
    """Angles and edges with their variances, and how long the count of each sample stands, s; shape (n,) each.

    A count that stands while the device creeps does not stand at all.
    """
    steps_deg = steps_of(seen.recording.encoder_deg)
    count_deg = steps_deg.mean or STILL_DEG
    counts = np.rint(seen.encoder_deg / count_deg)
    begins = np.flatnonzero(np.concatenate([[True], np.diff(counts) != 0.0]))
    lengths = np.diff(np.concatenate([begins, [len(counts)]]))
    lasts = np.repeat(lengths, lengths)
    most = samples_in(STANDS_MOST_S, seen.recording.period_s)
    own = max(count_deg**2 / 12.0 + steps_deg.scatter**2, _encoder_noise_deg(seen) ** 2)
    variance = np.where(np.isfinite(seen.recording.encoder_deg), own * np.minimum(lasts, most), NOT_MEASURED)
    edge_deg, edge_variance = np.zeros(len(counts)), np.zeros(len(counts))
    shorter = np.minimum(lengths[1:], lengths[:-1])
    steps = counts[begins[1:]] - counts[begins[1:] - 1]
    clear = (np.abs(steps) == 1.0) & (shorter > 1)
    at = begins[1:][clear]
    between_deg = 0.5 * count_deg * steps[clear]
    edge_deg[at] = angle_deg[at] - between_deg
    edge_variance[at] = own / np.square(shorter[clear]) + steps_deg.scatter**2
    stands = np.where(np.repeat(_creeping(steps, lengths), lengths), 0, lasts)
    return (angle_deg, variance), (edge_deg, edge_variance), stands * seen.recording.period_s


def _creeping(steps: Floats, lengths: Integers) -> Mask:
    """Which counts are those of a slow motion: a stair of one direction, whose steps are of about one length."""
    creeping = np.zeros(len(lengths), bool)
    if len(lengths) > 2:
        one_way = steps[1:] * steps[:-1] > 0.0
        creeping[1:-1] = one_way & (np.minimum(lengths[:-2], lengths[2:]) > CREEP_LIKE * lengths[1:-1])
    return creeping


def _encoder_noise_deg(seen: Cleaned) -> float:
    """Standard deviation of an angle about the turn that the gyro feels, beyond its neighbours."""
    turned_deg = np.cumsum(seen.rate_dps) * seen.recording.period_s
    return middle_sigma(np.diff(seen.encoder_deg - turned_deg, 2)) / float(np.sqrt(NOISE_GAIN))


def _jerk(rate_dps: Floats, sigma_dps: float, period_s: float) -> Floats:
    """Intensity of the white noise that drives the acceleration, deg²/s⁵, at each sample."""
    intensity = np.zeros(len(rate_dps))
    sums = np.concatenate([[0.0], np.cumsum(rate_dps)])
    for points in dict.fromkeys(samples_in(step_s, period_s) for step_s in JERK_STEPS_S):
        if 3 * points > len(rate_dps):
            break
        means_dps = (sums[points:] - sums[:-points]) / points
        bends = np.square(means_dps[2 * points :] - 2.0 * means_dps[points:-points] + means_dps[: -2 * points])
        window = JERK_WINDOW_STEPS * points
        power = maximum_filter1d(uniform_filter1d(bends, window), window)
        over = np.maximum(power - NOISE_SHARES * NOISE_GAIN * sigma_dps**2 / points, 0.0)
        first = (3 * points) // 2
        over = np.pad(over, (first, len(rate_dps) - len(over) - first), mode="edge")
        intensity = np.where(intensity > 0.0, intensity, over / (JERK_GAIN * (points * period_s) ** 3))
    return intensity


def _advanced(values: Floats, samples: float) -> Floats:
    """Values earlier by so many samples, in between by their spectrum: straight lines would weaken quick motion."""
    if samples == 0.0:
        return values
    padded = np.pad(values, RAMP_SAMPLES, mode="linear_ramp")
    size = next_fast_len(len(padded), real=True)
    turns = np.fft.rfftfreq(size) * samples
    moved: Floats = np.fft.irfft(np.fft.rfft(padded, size) * np.exp(2j * np.pi * turns), size)
    return moved[RAMP_SAMPLES : RAMP_SAMPLES + len(values)]
