"""Errors that a rig states: they are removed from a recording before its motion is rebuilt."""

from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from firmware_sim.effects.catalogue import in_acting_order
from firmware_sim.effects.effect import Effect, EffectSlot, Moments
from firmware_sim.effects.encoder import EncoderQuantization
from firmware_sim.effects.sensor_curve import Deadband, Quantization, Saturation
from firmware_sim.effects.sensor_dynamics import Bandwidth, Latency
from firmware_sim.measure import HALF_A_COUNT
from firmware_sim.rig import Rig
from gyrodrift.diagnose.features.block_means import integral_of, slopes
from gyrodrift.diagnose.features.block_residuals import block_residual_dps
from gyrodrift.diagnose.features.design_matrix import DesignMatrix
from gyrodrift.diagnose.features.orthogonal import orthonormal_vectors
from gyrodrift.diagnose.recording.gyro_noise import GyroModel
from gyrodrift.diagnose.recording.motion import ReplayedMotion
from gyrodrift.diagnose.recording.outliers import Cleaned, is_at_limit
from gyrodrift.diagnose.simulate.candidates import KINDS
from gyrodrift.values.arrays import Floats, Mask

ONCE_PER_TURN = {"g_sensitivity": "amplitude_dps", "encoder_eccentricity": "amplitude_deg"}
"""Parameter that is the amplitude, by name of an effect with a phase."""

WITHOUT_PHASES = frozenset({"quantization", *ONCE_PER_TURN})
"""Effects left out of the stated rate error when phases are fitted. The phases are the unknowns. Steps of a rate
without noise differ from those of the noisy rate."""

TABLE_HZ = 20.0
"""Cutoff from which on a low-pass leaves the motion unchanged. Chosen: motions of tables and robots are slower. At 5
Hz, a first-order low-pass with this cutoff takes 3 % of the amplitude."""

PHASES_DEG = np.arange(0.0, 360.0, 3.0)
"""Phases that are tried for an effect with one period per turn. Chosen: an error of half a step takes 0.03 % of an
amplitude."""


def gyro_model_of(rig: Rig) -> GyroModel:
    """Model of the rig's gyro: step of its rates, delay with that of its low-passes, and white noise."""
    low_passes, count_dps = _low_passes(rig), rig.base.dps_per_lsb
    delay_s = _delay_s(low_passes)
    for effect in rig.effects:
        if isinstance(effect, Quantization):
            count_dps = max(count_dps, effect.step_dps)
        if isinstance(effect, Latency):
            delay_s += effect.delay_ms * 1e-3
    hides = any(hides_rest(effect, count_dps) for effect in rig.effects)
    unrestored = tuple(effect for effect in low_passes if effect.cutoff_hz >= TABLE_HZ)
    noise_dps = rig.base.noise_dps_rthz * rig.base.sample_rate_hz**0.5
    return GyroModel(count_dps, delay_s, hides, low_passes, unrestored, noise_dps)


def hides_rest(effect: Effect, count_dps: float) -> bool:
    """Whether an effect hides noise and bias at rest: a dead band wider than a count. A narrower one only rounds."""
    return isinstance(effect, Deadband) and effect.width_dps > count_dps


def known_at_limit(rig: Rig, cleaned: Cleaned) -> Mask | None:
    """Samples at which the gyro is at its limit, shape (n,); None if the rig has no saturation.

    The limit is read off the recording. The size that the rig states is ignored.
    """
    if not any(isinstance(effect, Saturation) for effect in rig.effects):
        return None
    return is_at_limit(cleaned.rate_dps, cleaned.encoder_deg, cleaned.recording.period_s)


class SensorModel(NamedTuple):
    """Parts of a rig that determine which motion is rebuilt from a recording.

    encoder
        Effects that shift the encoder's angle.
    low_passes
        Low-passes below TABLE_HZ, which take a part of the motion from the rate.
    """

    gyro: GyroModel
    encoder: tuple[Effect, ...]
    low_passes: tuple[Bandwidth, ...]

    @property
    def distorts_motion(self) -> bool:
        """Whether encoder or gyro changes the shape of the motion; a delay alone does not."""
        return bool(self.encoder or self.low_passes)


def sensor_model_of(rig: Rig) -> SensorModel:
    """Model of the rig's gyro and encoder."""
    low_passes = tuple(effect for effect in _low_passes(rig) if effect.cutoff_hz < TABLE_HZ)
    return SensorModel(gyro_model_of(rig), tuple(_encoder_effects(rig)), low_passes)


def _low_passes(rig: Rig) -> tuple[Bandwidth, ...]:
    return tuple(effect for effect in rig.effects if isinstance(effect, Bandwidth))


def _delay_s(low_passes: Iterable[Bandwidth]) -> float:
    """Sum of the low-pass filters' delays, s."""
    return sum((effect.delay_s() for effect in low_passes), 0.0)


def low_pass_loss_dps(rig: Rig, motion: ReplayedMotion, rate_dps: Floats) -> Floats:
    """Difference between the delayed rate and the low-passed rate, deg/s, shape (n,); the sum over all low-passes."""
    moments, loss_dps = moments_of(motion), np.zeros(len(rate_dps))
    for effect in sensor_model_of(rig).low_passes:
        passed_dps = effect.begin(np.random.default_rng(0), 1.0 / motion.period_s)(rate_dps, moments)
        loss_dps += np.interp(moments.t_s - effect.delay_s(), moments.t_s, rate_dps) - passed_dps
    return loss_dps


def restored_dps(rig: Rig, motion: ReplayedMotion) -> Floats:
    """Rate of a motion that follows a low-passed gyro, with the loss restored, deg/s, shape (n,).

    Deconvolution by a Neumann series.
    P. H. van Cittert, Zum Einfluß der Spaltbreite auf die Intensitätsverteilung in Spektrallinien II (1931).
    """
    low_passes, rate_dps = sensor_model_of(rig).low_passes, motion.rate_dps
    if not low_passes:
        return rate_dps
    t_s, delay_s = moments_of(motion).t_s, _delay_s(low_passes)
    for _ in range(6):  # terms of the series
        rate_dps = motion.rate_dps + np.interp(t_s + delay_s, t_s, low_pass_loss_dps(rig, motion, rate_dps))
    return rate_dps


def angles_without_error(rig: Rig, encoder_deg: Floats, motion: ReplayedMotion) -> Floats:
    """Angles of the encoder without the errors that the rig states, shape (n,).

    motion
        An approximate motion, from which the errors are computed.
    """
    moments, angle_deg = moments_of(motion), motion.angle_deg
    for effect in _encoder_effects(rig):
        angle_deg = effect.begin(np.random.default_rng(0), 1.0 / motion.period_s)(angle_deg, moments)
    corrected: Floats = encoder_deg - (angle_deg - motion.angle_deg)
    return corrected


def counted_angles(rig: Rig, angle_deg: Floats) -> Floats:
    """Angles rounded to the counts of the rig's encoder, in the shape of the angles; no other error is applied."""
    coarser = [effect.cpr for effect in rig.effects if isinstance(effect, EncoderQuantization)]
    for count_deg in (360.0 / cpr for cpr in (*coarser, rig.base.encoder_cpr)):
        angle_deg = np.floor(angle_deg / count_deg + HALF_A_COUNT) * count_deg
    return angle_deg


def with_phases(rig: Rig, cleaned: Cleaned, design: DesignMatrix) -> Rig:
    """The rig with once-per-turn effects at the phases of this session; unchanged if its encoder is absolute."""
    once_per_turn = [effect for effect in rig.effects if effect.name in ONCE_PER_TURN]
    if rig.base.encoder_absolute or not once_per_turn:
        return rig
    # On whole turns each way, a gain that differs by direction looks like a once-per-turn effect, so it is subtracted.
    fit = _PhaseFit.of(cleaned, design, error_dps(rig, design.motion, WITHOUT_PHASES))
    for effect in once_per_turn:
        fit = fit.without(effect)
    effects = list(rig.effects)
    for effect in once_per_turn:
        index = effects.index(effect)
        effects[index], fit = fit.at_best_phase(effect)
    return rig.model_copy(update={"effects": tuple(effects)})


@dataclass(frozen=True, slots=True)
class _PhaseFit:
    """Fit of the phases of once-per-turn effects to the block residuals.

    A bias A·sin(θ + φ) adds to the rate. An angle error A·sin(θ + φ) subtracts A·ω·cos(θ + φ) from it. Only the phase
    is fitted, and the amplitude is the rig's: in a session with little rotation, free amplitudes would absorb the bias.

    residual_dps
        Block residuals without the stated errors, deg/s, shape (blocks,).
    columns
        Regressors at the phases 0 and 90 degrees, by name of the effect; shape (blocks,).
    """

    residual_dps: Floats
    columns: dict[str, tuple[Floats, Floats]]

    @classmethod
    def of(cls, cleaned: Cleaned, design: DesignMatrix, stated_dps: Floats) -> "_PhaseFit":
        """Fit to a recording; `stated_dps` is the rate error that the rig states, shape (n,)."""
        turn, rate = np.deg2rad(design.motion.angle_deg), np.deg2rad(design.motion.rate_dps)
        sine, cosine = np.sin(turn), np.cos(turn)
        common = np.column_stack([np.ones(len(turn)), rate])

        def mean_of(values: Floats) -> Floats:
            return slopes(integral_of(values, design.period_s), design.period_s, design.block)

        basis = orthonormal_vectors(np.column_stack([mean_of(column) for column in common.T]))

        def without_bias_and_gain(values: Floats) -> Floats:
            remainder: Floats = values - basis @ (basis.T @ values)
            return remainder

        pairs = {"g_sensitivity": (sine, cosine), "encoder_eccentricity": (-rate * cosine, rate * sine)}
        columns = {
            name: (without_bias_and_gain(mean_of(first)), without_bias_and_gain(mean_of(second)))
            for name, (first, second) in pairs.items()
        }
        return cls(without_bias_and_gain(block_residual_dps(cleaned, design) - mean_of(stated_dps)), columns)

    def _effect_dps(self, effect: Effect, phase_deg: float) -> Floats:
        """Rate error of an effect at a phase in every block, deg/s."""
        first, second = self.columns[effect.name]
        phase, amplitude = np.deg2rad(phase_deg), float(getattr(effect, ONCE_PER_TURN[effect.name]))
        values: Floats = amplitude * (np.cos(phase) * first + np.sin(phase) * second)
        return values

    def without(self, effect: Effect) -> "_PhaseFit":
        """The fit with an effect subtracted, at the effect's own phase."""
        phase_deg = float(effect.model_dump()["phase_deg"])
        return replace(self, residual_dps=self.residual_dps - self._effect_dps(effect, phase_deg))

    def at_best_phase(self, effect: Effect) -> tuple[Effect, "_PhaseFit"]:
        """A subtracted effect at its best phase, and the fit without it.

        The effect keeps its own phase if no other phase fits better by three standard deviations.
        """
        own_deg = float(effect.model_dump()["phase_deg"])
        residual_dps = self.residual_dps + self._effect_dps(effect, own_deg)
        costs = np.array([np.square(residual_dps - self._effect_dps(effect, phase)).sum() for phase in PHASES_DEG])
        block_variance = costs.min() / max(1, len(residual_dps) - 1)
        own_cost = float(np.square(residual_dps - self._effect_dps(effect, own_deg)).sum())
        is_better = own_cost - costs.min() > 9.0 * block_variance  # three standard deviations
        phase_deg = float(PHASES_DEG[np.argmin(costs)]) if is_better else own_deg
        best = effect.model_copy(update={"phase_deg": phase_deg})
        return best, replace(self, residual_dps=residual_dps).without(best)


def error_dps(rig: Rig, motion: ReplayedMotion, without: Collection[str] = ("quantization",)) -> Floats:
    """Rate error by the bias of a rig and its deterministic effects, deg/s, shape (n,).

    without
        Names of effects to leave out.
    """
    moments = moments_of(motion)
    unused_rng, rate_hz = np.random.default_rng(0), 1.0 / motion.period_s
    delayed_s = moments.t_s
    effects = [
        effect for effect in in_acting_order(rig.effects) if _is_deterministic(effect) and effect.name not in without
    ]
    for effect in effects:
        if effect.slot is EffectSlot.LAG:
            delayed_s = effect.begin(unused_rng, rate_hz)(delayed_s, moments)
    rate_dps: Floats = np.interp(delayed_s, moments.t_s, motion.rate_dps) + rig.base.bias_dps
    for slot in (EffectSlot.LOW_PASS, EffectSlot.RATE, EffectSlot.OUTPUT):
        for effect in effects:
            if effect.slot is slot:
                rate_dps = effect.begin(unused_rng, rate_hz)(rate_dps, moments)
    difference_dps: Floats = rate_dps - motion.rate_dps
    return difference_dps


def _is_deterministic(effect: Effect) -> bool:
    """Whether an effect is deterministic; False for an effect without a record as a candidate."""
    return effect.name in KINDS and KINDS[effect.name].realisations == 1


def moments_of(motion: ReplayedMotion) -> Moments:
    """Times, angles, rates and temperatures of a motion at its samples, the input of effects."""
    t_s: Floats = np.arange(len(motion.angle_deg), dtype=np.float64) * motion.period_s
    return Moments(t_s, t_s + motion.powered_s, motion.angle_deg, motion.rate_dps, motion.sensor_c, motion.period_s)


def _encoder_effects(rig: Rig) -> list[Effect]:
    """Effects on the encoder whose error follows from the motion; random slips are removed as jumps of the angle."""
    return [effect for effect in rig.effects if effect.slot is EffectSlot.ENCODER and effect.name != "encoder_slip"]
