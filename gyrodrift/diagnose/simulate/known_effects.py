"""What a rig says that stands between motion and measurement, taken out before the motion is rebuilt."""

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
from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.features.block_means import integral_of, slopes
from gyrodrift.diagnose.features.block_residuals import block_residual_dps
from gyrodrift.diagnose.features.design_matrix import DesignMatrix
from gyrodrift.diagnose.features.orthogonal import orthonormal_vectors
from gyrodrift.diagnose.recording.gyro_noise import GyroModel
from gyrodrift.diagnose.recording.motion import ReplayedMotion
from gyrodrift.diagnose.recording.outliers import Cleaned, at_limit
from gyrodrift.diagnose.simulate.candidates import KINDS

ONCE_PER_TURN = {"g_sensitivity": "amplitude_dps", "encoder_eccentricity": "amplitude_deg"}
"""Effects with a phase, by the names of their amplitudes."""

NOT_BY_ITSELF = frozenset({"quantization", *ONCE_PER_TURN})
"""Of these: steps that no noise smooths are others, and phases are what is looked for."""

TABLE_HZ = 20.0
"""What a table or a robot does is slower: of a motion of 5 Hz a low-pass of the first order there takes 3 %."""

PHASES_DEG = np.arange(0.0, 360.0, 3.0)


def gyro_model_of(rig: Rig) -> GyroModel:
    """In what steps the gyro of a rig reads, how late (by its delay, and by that of a low-pass), and what it hides."""
    low_passes, count_dps = _low_passes(rig), rig.base.dps_per_lsb
    delay_s = _late_s(low_passes)
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
    """Whether an effect hides noise and bias at rest; a dead band within a count leaves as much as rounding does."""
    return isinstance(effect, Deadband) and effect.width_dps > count_dps


def known_at_limit(rig: Rig, seen: Cleaned) -> Mask | None:
    """Where a gyro is at a limit that its rig knows of, whichever that is, (n,); None where it knows of none."""
    if not any(isinstance(effect, Saturation) for effect in rig.effects):
        return None
    return at_limit(seen.rate_dps, seen.encoder_deg, seen.recording.period_s)


class MotionSeen(NamedTuple):
    """What of a rig decides which motion is behind a recording.

    encoder
        Effects by which the encoder stands elsewhere.
    low_passes
        Those that take from the rate what a table does.
    """

    gyro: GyroModel
    encoder: tuple[Effect, ...]
    low_passes: tuple[Bandwidth, ...]

    @property
    def is_bent(self) -> bool:
        """Whether one of the two sees another motion than there is, but for its being late."""
        return bool(self.encoder or self.low_passes)


def motion_seen_by(rig: Rig) -> MotionSeen:
    """How its gyro and its encoder see a motion."""
    low_passes = tuple(effect for effect in _low_passes(rig) if effect.cutoff_hz < TABLE_HZ)
    return MotionSeen(gyro_model_of(rig), tuple(_of_encoder(rig)), low_passes)


def _low_passes(rig: Rig) -> tuple[Bandwidth, ...]:
    return tuple(effect for effect in rig.effects if isinstance(effect, Bandwidth))


def _late_s(low_passes: Iterable[Bandwidth]) -> float:
    """By how much they delay what they let through, one after the other."""
    return sum((effect.delay_s() for effect in low_passes), 0.0)


def taken_dps(rig: Rig, motion: ReplayedMotion, rate_dps: Floats) -> Floats:
    """(n,) What the low-passes of a rig take of a rate, as late as they let the others through, deg/s."""
    moments, found_dps = moments_of(motion), np.zeros(len(rate_dps))
    for effect in motion_seen_by(rig).low_passes:
        passed_dps = effect.begin(np.random.default_rng(0), 1.0 / motion.period_s)(rate_dps, moments)
        found_dps += np.interp(moments.t_s - effect.delay_s(), moments.t_s, rate_dps) - passed_dps
    return found_dps


def restored_dps(rig: Rig, motion: ReplayedMotion) -> Floats:
    """(n,) The rate of a motion that follows a low-passed gyro, with what was taken of it: a Neumann series.

    P. H. van Cittert, Zum Einfluß der Spaltbreite auf die Intensitätsverteilung in Spektrallinien II (1931).
    """
    low_passes, found_dps = motion_seen_by(rig).low_passes, motion.rate_dps
    if not low_passes:
        return found_dps
    t_s, late_s = moments_of(motion).t_s, _late_s(low_passes)
    for _ in range(6):  # terms of the series
        found_dps = motion.rate_dps + np.interp(t_s + late_s, t_s, taken_dps(rig, motion, found_dps))
    return found_dps


def angles_before(rig: Rig, encoder_deg: Floats, motion: ReplayedMotion) -> Floats:
    """Angles of the encoder without what the rig says it errs by, of a motion that is about right."""
    moments, angle_deg = moments_of(motion), motion.angle_deg
    for effect in _of_encoder(rig):
        angle_deg = effect.begin(np.random.default_rng(0), 1.0 / motion.period_s)(angle_deg, moments)
    corrected: Floats = encoder_deg - (angle_deg - motion.angle_deg)
    return corrected


def angles_read(rig: Rig, angle_deg: Floats) -> Floats:
    """What the encoder of a rig reads at angles, of their shape, but for what else the rig says it errs by."""
    coarser = [effect.cpr for effect in rig.effects if isinstance(effect, EncoderQuantization)]
    for count_deg in (360.0 / cpr for cpr in (*coarser, rig.base.encoder_cpr)):
        angle_deg = np.floor(angle_deg / count_deg + HALF_A_COUNT) * count_deg
    return angle_deg


def with_phases(rig: Rig, seen: Cleaned, design: DesignMatrix) -> Rig:
    """The rig with what comes once per turn at the phase of a session, where its encoder has no fixed zero."""
    turning = [effect for effect in rig.effects if effect.name in ONCE_PER_TURN]
    if rig.base.encoder_absolute or not turning:
        return rig
    # Where a table turns whole turns each way, a gain that differs by direction looks as if it came once per turn.
    left = _Left.of(seen, design, error_dps(rig, design.motion, NOT_BY_ITSELF))
    for effect in turning:
        left = left.without(effect)
    effects = list(rig.effects)
    for effect in turning:
        at = effects.index(effect)
        effects[at], left = left.turned(effect)
    return rig.model_copy(update={"effects": tuple(effects)})


@dataclass(frozen=True, slots=True)
class _Left:
    """Block residuals less what is known of them, deg/s, beside the columns of effects once per turn.

    A bias A·sin(θ + φ) is in the rate; an angle that errs by A·sin(θ + φ) takes A·ω·cos(θ + φ) from it. The amplitude
    is the rig's, and only the phase is fitted: where a session hardly turns, sine and cosine would take the bias.
    """

    residual_dps: Floats
    columns: dict[str, tuple[Floats, Floats]]

    @classmethod
    def of(cls, seen: Cleaned, design: DesignMatrix, known_dps: Floats) -> "_Left":
        """Of a rate that errs by what is known, shape (n,)."""
        turn, rate = np.deg2rad(design.motion.angle_deg), np.deg2rad(design.motion.rate_dps)
        sine, cosine = np.sin(turn), np.cos(turn)
        common = np.column_stack([np.ones(len(turn)), rate])

        def mean_of(values: Floats) -> Floats:
            return slopes(integral_of(values, design.period_s), design.period_s, design.block)

        basis = orthonormal_vectors(np.column_stack([mean_of(column) for column in common.T]))

        def beside(values: Floats) -> Floats:
            aside: Floats = values - basis @ (basis.T @ values)
            return aside

        pairs = {"g_sensitivity": (sine, cosine), "encoder_eccentricity": (-rate * cosine, rate * sine)}
        columns = {name: (beside(mean_of(first)), beside(mean_of(second))) for name, (first, second) in pairs.items()}
        return cls(beside(block_residual_dps(seen, design) - mean_of(known_dps)), columns)

    def _of(self, effect: Effect, phase_deg: float) -> Floats:
        first, second = self.columns[effect.name]
        phase, amplitude = np.deg2rad(phase_deg), float(getattr(effect, ONCE_PER_TURN[effect.name]))
        values: Floats = amplitude * (np.cos(phase) * first + np.sin(phase) * second)
        return values

    def without(self, effect: Effect) -> "_Left":
        """What an effect leaves, at the phase that it is given with."""
        phase_deg = float(effect.model_dump()["phase_deg"])
        return replace(self, residual_dps=self.residual_dps - self._of(effect, phase_deg))

    def turned(self, effect: Effect) -> tuple[Effect, "_Left"]:
        """An effect that was taken away, at its best phase; at its own where no phase is better than chance."""
        own_deg = float(effect.model_dump()["phase_deg"])
        residual_dps = self.residual_dps + self._of(effect, own_deg)
        costs = np.array([np.square(residual_dps - self._of(effect, phase)).sum() for phase in PHASES_DEG])
        chance = costs.min() / max(1, len(residual_dps) - 1)
        own_cost = float(np.square(residual_dps - self._of(effect, own_deg)).sum())
        is_better = own_cost - costs.min() > 9.0 * chance  # three standard deviations, in variances of a block
        phase_deg = float(PHASES_DEG[np.argmin(costs)]) if is_better else own_deg
        best = effect.model_copy(update={"phase_deg": phase_deg})
        return best, replace(self, residual_dps=residual_dps).without(best)


def error_dps(rig: Rig, motion: ReplayedMotion, without: Collection[str] = ("quantization",)) -> Floats:
    """(n,) By how much a rate errs through the bias of a rig and effects that leave nothing to chance, deg/s.

    without
        Names of effects to leave out.
    """
    moments = moments_of(motion)
    none, rate_hz = np.random.default_rng(0), 1.0 / motion.period_s
    seen_s = moments.t_s
    effects = [one for one in in_acting_order(rig.effects) if _leaves_no_chance(one) and one.name not in without]
    for effect in effects:
        if effect.slot is EffectSlot.LAG:
            seen_s = effect.begin(none, rate_hz)(seen_s, moments)
    rate_dps: Floats = np.interp(seen_s, moments.t_s, motion.rate_dps) + rig.base.bias_dps
    for place in (EffectSlot.LOW_PASS, EffectSlot.RATE, EffectSlot.OUTPUT):
        for effect in effects:
            if effect.slot is place:
                rate_dps = effect.begin(none, rate_hz)(rate_dps, moments)
    found: Floats = rate_dps - motion.rate_dps
    return found


def _leaves_no_chance(effect: Effect) -> bool:
    """As far as it is known: an effect may be registered with the simulator alone."""
    return effect.name in KINDS and KINDS[effect.name].realisations == 1


def moments_of(motion: ReplayedMotion) -> Moments:
    """The truth at its samples, as effects are handed it."""
    t_s: Floats = np.arange(len(motion.angle_deg), dtype=np.float64) * motion.period_s
    return Moments(t_s, t_s + motion.powered_s, motion.angle_deg, motion.rate_dps, motion.sensor_c, motion.period_s)


def _of_encoder(rig: Rig) -> list[Effect]:
    """Those whose errors follow from the motion: jumps come by chance, and are taken out as what they are."""
    return [effect for effect in rig.effects if effect.slot is EffectSlot.ENCODER and effect.name != "encoder_slip"]
