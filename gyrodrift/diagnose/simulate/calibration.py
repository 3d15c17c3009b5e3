"""Calibration of a rig to a session: base values with which the simulation has the noise and bias of the recording.

Indirect inference (C. Gourieroux, A. Monfort and E. Renault, 1993): a statistic of the recording is compared with that
of its simulation, and the base value is adjusted until both agree. So noise is not low-passed twice, and a bias that an
effect of the rig adds is not counted twice.
"""

from dataclasses import dataclass, replace

import numpy as np

from firmware_sim.effects.effect import Effect
from firmware_sim.measure import measure as play
from firmware_sim.rig import Base, Rig, with_replaced
from gyrodrift.diagnose.features.block_means import block_means
from gyrodrift.diagnose.features.block_residuals import block_residual_dps, unexplained_dps
from gyrodrift.diagnose.features.design_matrix import DesignMatrix
from gyrodrift.diagnose.features.spectral_line import white_dps
from gyrodrift.diagnose.features.spreads import turning_spread
from gyrodrift.diagnose.recording.gyro_noise import GyroModel
from gyrodrift.diagnose.recording.motion import ReplayedMotion
from gyrodrift.diagnose.recording.motion_posterior import MotionPosterior
from gyrodrift.diagnose.recording.order_statistics import median
from gyrodrift.diagnose.recording.outliers import Cleaned
from gyrodrift.diagnose.recording.quick_motion import RISES_SIGMAS, QuickMotion, quick_motion_of
from gyrodrift.diagnose.recording.recording import Recording, filled
from gyrodrift.diagnose.simulate.known_effects import error_dps, gyro_model_of
from gyrodrift.simulation.sessions import as_recorded
from gyrodrift.values.arrays import Floats, Mask
from gyrodrift.values.constants import NORMAL_MAD

NEIGHBORS = 100
"""Arrivals in a group. The median of a group is subtracted. Chosen: a slow wander of the clocks is not jitter."""

QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)
"""Quantiles of the arrivals. Chosen: the quartiles, and both ends without rare stalls of the host."""

SKEWED = 0.5
"""Range of arrivals from 5 to 50 %, divided by that from 50 to 95 %, below which the delays count as exponential.
Chosen: exponential delays, as of a scheduler, have 0.28. Waiting for the tick of a bus, and clock noise, have 1."""


def host_jitter_s(recording: Recording) -> float | None:
    """Mean of the exponential delay of arrivals, s; None if the arrivals show no such delay."""
    if recording.host_s is None:
        return None
    late_s = _without_wander(recording)
    low, lower, middle, upper, high = np.quantile(late_s, QUANTILES)
    if not (middle - low) < SKEWED * (high - middle):
        return None
    return float((upper - lower) / np.log(3.0))  # interquartile range over mean of an exponential distribution


def host_delay_s(recording: Recording) -> float | None:
    """Delay of the host's times against the device's, s; None if the clocks have no common zero."""
    ahead_s = recording.host_ahead_s
    # A negative delay, or one of more than 1 s, means that each clock has its own zero.
    return ahead_s if ahead_s is not None and 0.0 <= ahead_s <= 1.0 else None


def with_host(base: Base, recording: Recording) -> Base:
    """The base values with the host delay and jitter that a session shows."""
    shown = {"host_jitter_s": host_jitter_s(recording), "host_delay_s": host_delay_s(recording)}
    return base.model_copy(update={name: value for name, value in shown.items() if value is not None})


def _without_wander(recording: Recording) -> Floats:
    """Delays of known arrivals against the sample numbers, s, less the median of their group of NEIGHBORS."""
    assert recording.host_s is not None  # noqa: S101 - asked before
    away_s = recording.host_s - np.arange(len(recording.host_s)) * recording.period_s
    away_s = away_s[np.isfinite(away_s)]
    rows = away_s[: len(away_s) // NEIGHBORS * NEIGHBORS].reshape(-1, NEIGHBORS)
    if not len(rows):
        rows = away_s[None]
    level: Floats = (rows - np.median(rows, axis=1, keepdims=True)).reshape(-1)
    return level


CALIBRATION, VIBRATIONS, RUNS = 7_000_003, 7_000_033, 4
"""Seeds of the simulations of a calibration and of those that show its blocks, and number of the latter. Chosen: other
seeds than those of sessions; half of the error of one simulation."""

ROUNDS = 3
"""Simulations in a calibration; every simulation uses the values adjusted after the previous one. Chosen: speed."""


WHITE_SIGMAS, MAD_ERROR = 3.0, 1.7
"""Standard errors by which blocks of a second must scatter less than white noise before a part of the noise counts as
vibration. The second number times 1/√n is the standard error of a log variance from the median of n absolute values.
Chosen: one white noise of 740 is beyond. Derived: 2/√1.36, as the median absolute deviation has 37 % of the efficiency
of the standard deviation."""


@dataclass(frozen=True, slots=True)
class GyroVibration:
    """Part of the noise that is not white: shaking of the gyro, whose angle stays too small for the encoder.

    Its rates average out within a second. So white noise of the same size would cover a hundred times the scale error.

    variance_ratio
        Variance of a sample by vibration, divided by that of the white noise.
    lowest_hz
        Frequency below which the vibration has no power.
    """

    variance_ratio: float = 0.0
    lowest_hz: float = 0.0

    def shaking(self, motion: ReplayedMotion, base: Base, rng: np.random.Generator) -> ReplayedMotion:
        """The motion with a random vibration that suits the white noise of a rig."""
        if not self.variance_ratio:
            return motion
        size = len(motion.rate_dps)
        lines = np.fft.rfft(rng.standard_normal(size))
        lines[np.fft.rfftfreq(size, motion.period_s) < self.lowest_hz] = 0.0
        vibration_dps = np.fft.irfft(lines, size)
        white_dps = base.noise_dps_rthz * base.sample_rate_hz**0.5
        sigma_dps = white_dps * self.variance_ratio**0.5
        return replace(motion, vibration_dps=vibration_dps * (sigma_dps / float(np.std(vibration_dps))))


NO_VIBRATION = GyroVibration()


@dataclass(frozen=True, slots=True)
class Level:
    """Statistics that are matched: standard deviation of the white noise of a sample, and bias, deg/s."""

    white_dps: float
    bias_dps: float


def calibrated(
    cleaned: Cleaned,
    design: DesignMatrix,
    motion: ReplayedMotion,
    rig: Rig,
    least_noise_dps_rthz: float = 0.0,
    vibration: GyroVibration = NO_VIBRATION,
) -> Rig:
    """The rig with sample rate, noise, bias and host times of a session, and without an offset of the encoder.

    least_noise_dps_rthz
        Lower bound of the noise.
    vibration
        Vibration that acts beside the white noise.
    """
    period_s = cleaned.recording.period_s
    step_dps = gyro_model_of(rig).count_dps
    in_motion = is_hidden_at_rest(cleaned, design, rig)
    gyro = gyro_model_of(rig) if scatters_by_motion(cleaned, design, rig, in_motion=in_motion) else None
    target = level_of(cleaned, design, step_dps, in_motion=in_motion, gyro=gyro)
    base = with_host(rig.base, cleaned.recording).model_copy(
        update={
            "encoder_phase_deg": 0.0,
            "sample_rate_hz": 1.0 / period_s,
            "noise_dps_rthz": target.white_dps * (period_s / (1.0 + vibration.variance_ratio)) ** 0.5,
            "bias_dps": target.bias_dps,
        }
    )
    for _ in range(ROUNDS):
        played = _played(cleaned, motion, rig.model_copy(update={"base": base}), vibration)
        simulated = level_of(played, design, step_dps, in_motion=in_motion, gyro=gyro)
        ratio = _above_rounding_dps(target, step_dps) / _above_rounding_dps(simulated, step_dps)
        noise = base.noise_dps_rthz * float(np.clip(ratio, 0.3, 3.0))  # bounds of the change in a round
        bias_dps = base.bias_dps + target.bias_dps - simulated.bias_dps
        base = base.model_copy(update={"noise_dps_rthz": max(noise, least_noise_dps_rthz), "bias_dps": bias_dps})
    return rig.model_copy(update={"base": base})


def vibration_of(
    cleaned: Cleaned,
    design: DesignMatrix,
    posterior: MotionPosterior,
    rig: Rig,
    vibration: GyroVibration = NO_VIBRATION,
) -> GyroVibration:
    """Vibration of a recording, by blocks of a second that scatter less than those of the calibrated rig.

    The noise of single samples is calibrated already. A rest shows it without vibration, so only noise that is measured
    in motion is divided. The vibration begins where the gyro has the least power: the power of a motion falls with the
    frequency.

    vibration
        Vibration to which the rig is calibrated.
    """
    quick = posterior.quick
    if not quick.bands.is_known or not is_hidden_at_rest(cleaned, design, rig):
        return vibration
    rng = np.random.default_rng(VIBRATIONS)
    runs = [_played(cleaned, posterior.mean, rig, vibration, int(seed)) for seed in rng.integers(1 << 31, size=RUNS)]
    ratio = block_variance(cleaned, design) / float(np.mean([block_variance(run, design) for run in runs]))
    blocks = len(design.regimes.block_at_rest)
    limit = np.exp(-WHITE_SIGMAS * MAD_ERROR * float(np.sqrt((1.0 + 1.0 / RUNS) / blocks)))
    if not vibration.variance_ratio and ratio >= limit:
        return vibration
    is_least = quick.gyro < quick.gyro.min() * (1.0 + RISES_SIGMAS * quick.bands.relative_error)
    lowest_hz = float(quick.bands.centers_hz[np.argmax(is_least)])
    return GyroVibration(max((1.0 + vibration.variance_ratio) / ratio - 1.0, 0.0), lowest_hz)


def block_variance(cleaned: Cleaned, design: DesignMatrix) -> float:
    """Variance of the differences of neighboring block residuals, by their median; steps hardly change it."""
    return (NORMAL_MAD * median(np.abs(np.diff(unexplained_dps(cleaned, design))))) ** 2


def is_hidden_at_rest(cleaned: Cleaned, design: DesignMatrix, rig: Rig) -> bool:
    """Whether noise and bias are invisible at rest, because of a dead band or of steps that are coarser than both."""
    gyro, at_rest = gyro_model_of(rig), design.regimes.block_at_rest
    if gyro.hides_rest or not at_rest.any():
        return True
    error_dps = cleaned.rate_dps - design.motion.rate_dps
    squares, means_dps = (block_means(values, design.block) for values in (np.square(error_dps), error_dps))
    variance = float((squares - np.square(means_dps))[at_rest].mean())
    # A rate that alternates between two levels has a standard deviation of 0.5 steps, whatever its noise. With noise of
    # half a step the standard deviation is 0.58 steps.
    return variance < (0.55 * gyro.count_dps) ** 2


def scatters_by_motion(cleaned: Cleaned, design: DesignMatrix, rig: Rig, *, in_motion: bool) -> bool:
    """Whether motion contributes to the scatter from sample to sample, and no rest shows the noise alone."""
    gyro = gyro_model_of(rig)
    quick = _quick_motion(cleaned, design, gyro)
    if quick.has_rest_spectrum or quick.white_dps is None:
        return False
    rates_dps = cleaned.rate_dps, design.motion.rate_dps
    scatters_dps = [
        _scatter_dps(replace(cleaned, rate_dps=rate_dps), design, gyro.count_dps, in_motion=in_motion)
        for rate_dps in rates_dps
    ]
    # A motion with less than a tenth of the variance changes the noise by less than 5 %, which is within its error.
    return scatters_dps[1] ** 2 > 0.1 * scatters_dps[0] ** 2


def level_of(
    cleaned: Cleaned, design: DesignMatrix, step_dps: float, *, in_motion: bool = False, gyro: GyroModel | None = None
) -> Level:
    """Noise and bias of a recording or of its simulation.

    in_motion
        Whether they are measured in motion, because they are hidden at rest.
    gyro
        Gyro whose spectrum in motion gives the noise, if motion adds to the scatter; None to take the scatter itself.
    """
    shows = _shows_bias(design, in_motion=in_motion)
    white = _quick_motion(cleaned, design, gyro).white_dps if gyro else None
    if white is None:
        white = _scatter_dps(cleaned, design, step_dps, in_motion=in_motion)
    return Level(white, median(block_residual_dps(cleaned, design)[shows]))


def _scatter_dps(cleaned: Cleaned, design: DesignMatrix, step_dps: float, *, in_motion: bool) -> float:
    """Standard deviation of the noise of a sample, deg/s: in motion by third differences, else by the spectrum."""
    turning_dps = float(np.sqrt(turning_spread(cleaned.rate_dps, design.difference_indices))) if in_motion else 0.0
    return turning_dps or white_dps(cleaned, design, step_dps)


def _quick_motion(cleaned: Cleaned, design: DesignMatrix, gyro: GyroModel) -> QuickMotion:
    rests = design.motion.rate_dps == 0.0
    return quick_motion_of(cleaned.rate_dps, rests, ~rests, design.period_s, gyro)


def remaining_bias_dps(cleaned: Cleaned, design: DesignMatrix, rig: Rig, effects: tuple[Effect, ...]) -> float:
    """Bias of a calibrated rig with more effects, deg/s: their median rate error is subtracted from the bias.

    The calibration counted this error as bias. Without the subtraction it would be counted twice, and a rate in coarse
    steps would lie elsewhere between two steps.
    """
    extended = with_replaced(rig, effects)
    shows = _shows_bias(design, in_motion=is_hidden_at_rest(cleaned, design, extended))
    residual_dps = block_residual_dps(cleaned, design)
    unexplained_dps = [
        median((residual_dps - block_means(error_dps(candidate_rig, design.motion), design.block))[shows])
        for candidate_rig in (extended, rig)
    ]
    return rig.base.bias_dps + (unexplained_dps[0] - unexplained_dps[1])


def _shows_bias(design: DesignMatrix, *, in_motion: bool) -> Mask:
    """Blocks that show the bias, shape (blocks,): rests, or motion if the bias is hidden at rest.

    At rest, no effect of the motion adds to the rate. All blocks are returned if no more than a tenth of them qualify.
    """
    at_rest = design.regimes.block_at_rest
    shows: Mask = ~at_rest if in_motion else at_rest
    return shows if shows.sum() > len(shows) // 10 else np.ones(len(shows), dtype=np.bool_)


def _above_rounding_dps(level: Level, step_dps: float) -> float:
    """Noise without the noise of rounding to steps, deg/s; at least a tenth of the rounding's variance."""
    grain = step_dps**2 / 12.0
    return float(np.sqrt(max(level.white_dps**2 - grain, 0.1 * grain)))


def _played(
    cleaned: Cleaned, motion: ReplayedMotion, rig: Rig, vibration: GyroVibration, seed: int = CALIBRATION
) -> Cleaned:
    """Simulation of which only rate and angle are used; lost samples are interpolated, and nothing else is cleaned."""
    shaken = vibration.shaking(motion, rig.base, np.random.default_rng(seed))
    block = next(play(rig, shaken, seed, block_samples=len(motion.rate_dps)))
    session = as_recorded(block, rig.base, cleaned.recording.name)
    assert session.encoder_deg is not None  # noqa: S101 - a rig whose sessions have an encoder has one
    rate_dps, angle_deg = np.full(len(motion.rate_dps), np.nan), np.full(len(motion.rate_dps), np.nan)
    rate_dps[block.seq], angle_deg[block.seq] = session.rate_dps, session.encoder_deg
    recording: Recording = cleaned.recording
    no_outliers: Floats = np.zeros(0)
    return Cleaned(
        recording, filled(rate_dps), filled(angle_deg), cleaned.step_deg, no_outliers, no_outliers, cleaned.delay_s
    )
