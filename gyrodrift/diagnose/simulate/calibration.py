"""Calibration of a rig to a session, through the rig: base values at which it measures what the recording measured.

Indirect inference (C. Gourieroux, A. Monfort and E. Renault, 1993): a statistic is taken of the recording and of a
simulation of it, and the base value is moved until both agree. So noise that goes through a low-pass of the rig, or a
bias beside one that an effect of the rig adds, is counted once.
"""

from dataclasses import dataclass, replace

import numpy as np

from firmware_sim.effects.effect import Effect
from firmware_sim.measure import measure as play
from firmware_sim.rig import Base, Rig, with_replaced
from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.features.block_means import block_means
from gyrodrift.diagnose.features.block_residuals import block_residual_dps
from gyrodrift.diagnose.features.design_matrix import DesignMatrix
from gyrodrift.diagnose.features.spectral_line import white_dps
from gyrodrift.diagnose.features.spreads import turning_spread
from gyrodrift.diagnose.recording.gyro_noise import GyroModel
from gyrodrift.diagnose.recording.motion import ReplayedMotion
from gyrodrift.diagnose.recording.outliers import Cleaned
from gyrodrift.diagnose.recording.quick_motion import QuickMotion, quick_motion_of
from gyrodrift.diagnose.recording.recording import Recording, filled
from gyrodrift.diagnose.simulate.known_effects import error_dps, gyro_model_of
from gyrodrift.simulation.sessions import as_recorded

NEIGHBOURS = 100
"""Arrivals whose median is taken away: clocks that wander are no jitter."""

QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)

LEANING = 0.5
"""A scheduler's delays lean to one side: the lower nine twentieths span 0.28 of what the upper ones do. Waiting for the
tick of a bus spreads evenly, and clocks scatter to both sides: these span 1."""


def host_jitter_s(recording: Recording) -> float | None:
    """Mean of the exponential delay that arrivals show; None where there is none to be seen, s."""
    if recording.host_s is None:
        return None
    late_s = _without_wander(recording)
    low, lower, middle, upper, high = np.quantile(late_s, QUANTILES)
    if not (middle - low) < LEANING * (high - middle):
        return None
    return float((upper - lower) / np.log(3.0))  # interquartile range over mean of an exponential distribution


def host_delay_s(recording: Recording) -> float | None:
    """Of the host behind the device, s; None where their clocks have no common zero."""
    ahead_s = recording.host_ahead_s
    # Clocks that are further apart have zeros of their own.
    return ahead_s if ahead_s is not None and 0.0 <= ahead_s <= 1.0 else None


def with_host(base: Base, recording: Recording) -> Base:
    """The base with the delay and jitter of a session, as far as it shows them."""
    shown = {"host_jitter_s": host_jitter_s(recording), "host_delay_s": host_delay_s(recording)}
    return base.model_copy(update={name: value for name, value in shown.items() if value is not None})


def _without_wander(recording: Recording) -> Floats:
    assert recording.host_s is not None  # noqa: S101 - asked before
    away_s = recording.host_s - np.arange(len(recording.host_s)) * recording.period_s
    away_s = away_s[np.isfinite(away_s)]
    rows = away_s[: len(away_s) // NEIGHBOURS * NEIGHBOURS].reshape(-1, NEIGHBOURS)
    if not len(rows):
        rows = away_s[None]
    level: Floats = (rows - np.median(rows, axis=1, keepdims=True)).reshape(-1)
    return level


ROUNDS = 3
"""Simulations, each with the values that the one before led to."""


@dataclass(frozen=True, slots=True)
class Level:
    """What the base values are matched by: standard deviation of the white noise of a sample, and bias, deg/s."""

    white_dps: float
    bias_dps: float


def calibrated(
    cleaned: Cleaned, design: DesignMatrix, motion: ReplayedMotion, rig: Rig, least_noise_dps_rthz: float = 0.0
) -> Rig:
    """The rig with sample rate, noise, bias and host of a session; its motions begin at the encoder's own angles.

    least_noise_dps_rthz
        Less than that no recording of this device has, whatever it shows.
    """
    period_s = cleaned.recording.period_s
    step_dps = gyro_model_of(rig).count_dps
    in_motion = is_hidden_at_rest(cleaned, design, rig)
    gyro = gyro_model_of(rig) if scatters_by_motion(cleaned, design, rig, in_motion=in_motion) else None
    wanted = level_of(cleaned, design, step_dps, in_motion=in_motion, gyro=gyro)
    base = with_host(rig.base, cleaned.recording).model_copy(
        update={
            "encoder_phase_deg": 0.0,
            "sample_rate_hz": 1.0 / period_s,
            "noise_dps_rthz": wanted.white_dps * period_s**0.5,
            "bias_dps": wanted.bias_dps,
        }
    )
    for _ in range(ROUNDS):
        played = _played(cleaned, motion, rig.model_copy(update={"base": base}))
        found = level_of(played, design, step_dps, in_motion=in_motion, gyro=gyro)
        ratio = _above_rounding_dps(wanted, step_dps) / _above_rounding_dps(found, step_dps)
        noise = base.noise_dps_rthz * float(np.clip(ratio, 0.3, 3.0))  # bounds of the change in a round
        bias_dps = base.bias_dps + wanted.bias_dps - found.bias_dps
        base = base.model_copy(update={"noise_dps_rthz": max(noise, least_noise_dps_rthz), "bias_dps": bias_dps})
    return rig.model_copy(update={"base": base})


def is_hidden_at_rest(cleaned: Cleaned, design: DesignMatrix, rig: Rig) -> bool:
    """Whether noise and bias are hidden at rest: by a dead band, or by steps that are coarse beside both."""
    gyro, at_rest = gyro_model_of(rig), design.regimes.block_at_rest
    if gyro.hides_rest or not at_rest.any():
        return True
    left_dps = cleaned.rate_dps - design.motion.rate_dps
    squares, means_dps = (block_means(each, design.block) for each in (np.square(left_dps), left_dps))
    variance = float((squares - np.square(means_dps))[at_rest].mean())
    # Two levels in turn scatter by half a step and show no noise; noise of half a step scatters by 0.58.
    return variance < (0.55 * gyro.count_dps) ** 2


def scatters_by_motion(cleaned: Cleaned, design: DesignMatrix, rig: Rig, *, in_motion: bool) -> bool:
    """Whether motion is a part of what scatters from sample to sample, and no rest tells how much noise there is."""
    gyro = gyro_model_of(rig)
    quick = _quick_motion(cleaned, design, gyro)
    if quick.knows_rest or quick.white_dps is None:
        return False
    rates_dps = cleaned.rate_dps, design.motion.rate_dps
    scatters_dps = [
        _scatter_dps(replace(cleaned, rate_dps=rate_dps), design, gyro.count_dps, in_motion=in_motion)
        for rate_dps in rates_dps
    ]
    # A tenth of the variance: less of it by motion changes the noise by 5 %, as chance does.
    return scatters_dps[1] ** 2 > 0.1 * scatters_dps[0] ** 2


def level_of(
    cleaned: Cleaned, design: DesignMatrix, step_dps: float, *, in_motion: bool = False, gyro: GyroModel | None = None
) -> Level:
    """Noise and bias of a recording or of a simulation of it.

    in_motion
        Where something hides noise and bias at rest.
    gyro
        Of which the spectrum in motion says how much noise there is, where motion scatters too.
    """
    shows = _shows_bias(design, in_motion=in_motion)
    white = _quick_motion(cleaned, design, gyro).white_dps if gyro else None
    if white is None:
        white = _scatter_dps(cleaned, design, step_dps, in_motion=in_motion)
    return Level(white, float(np.median(block_residual_dps(cleaned, design)[shows])))


def _scatter_dps(cleaned: Cleaned, design: DesignMatrix, step_dps: float, *, in_motion: bool) -> float:
    """Standard deviation of what scatters from sample to sample."""
    turning_dps = float(np.sqrt(turning_spread(cleaned.rate_dps, design.difference_indices))) if in_motion else 0.0
    return turning_dps or white_dps(cleaned, design, step_dps)


def _quick_motion(cleaned: Cleaned, design: DesignMatrix, gyro: GyroModel) -> QuickMotion:
    rests = design.motion.rate_dps == 0.0
    return quick_motion_of(cleaned.rate_dps, rests, ~rests, design.period_s, gyro)


def remaining_bias_dps(cleaned: Cleaned, design: DesignMatrix, rig: Rig, effects: tuple[Effect, ...]) -> float:
    """The bias of a calibrated rig beside more effects, deg/s: what these add to the rate was taken for bias.

    A rate in coarse steps shows it: added to what is there already, it would stand elsewhere between two steps.
    """
    more = with_replaced(rig, effects)
    shows = _shows_bias(design, in_motion=is_hidden_at_rest(cleaned, design, more))
    residual_dps = block_residual_dps(cleaned, design)
    left_dps = [
        float(np.median((residual_dps - block_means(error_dps(each, design.motion), design.block))[shows]))
        for each in (more, rig)
    ]
    return rig.base.bias_dps + (left_dps[0] - left_dps[1])


def _shows_bias(design: DesignMatrix, *, in_motion: bool) -> Mask:
    """(blocks,) Rest, since what an effect adds in motion is no bias; but motion where something hides it at rest."""
    at_rest = design.regimes.block_at_rest
    shows: Mask = ~at_rest if in_motion else at_rest
    # With less than a tenth of the blocks, the bias is that of all.
    return shows if shows.sum() > len(shows) // 10 else np.ones(len(shows), dtype=np.bool_)


def _above_rounding_dps(level: Level, step_dps: float) -> float:
    """Rounding to counts is a noise that is always there; what is above it follows the noise of the rig."""
    grain = step_dps**2 / 12.0
    return float(np.sqrt(max(level.white_dps**2 - grain, 0.1 * grain)))


def _played(cleaned: Cleaned, motion: ReplayedMotion, rig: Rig) -> Cleaned:
    """A simulation of which only rate and angle are looked at, with nothing to clean but what never came."""
    block = next(play(rig, motion, 7_000_003, block_samples=len(motion.rate_dps)))  # a random stream of its own
    session = as_recorded(block, rig.base, cleaned.recording.name)
    assert session.encoder_deg is not None  # noqa: S101 - a rig whose sessions have an encoder has one
    rate_dps, angle_deg = np.full(len(motion.rate_dps), np.nan), np.full(len(motion.rate_dps), np.nan)
    rate_dps[block.seq], angle_deg[block.seq] = session.rate_dps, session.encoder_deg
    recording: Recording = cleaned.recording
    none: Floats = np.zeros(0)
    return Cleaned(recording, filled(rate_dps), filled(angle_deg), cleaned.step_deg, none, none, cleaned.delay_s)
