"""A rig driven through the motion of a recording, and the result put through all that the recording went through.

From its raw columns on a simulation is treated as a recording is: its own numbering, checks and cleaning, its own
encoder and gyro, from which its motion is rebuilt. The motion that drives it is drawn from what the recording leaves
possible.
"""

from dataclasses import dataclass, field, replace
from functools import partial
from typing import NamedTuple
from zlib import crc32

import numpy as np

from firmware_sim.effects.effect import Effect
from firmware_sim.measure import measure as play
from firmware_sim.rig import Base, Rig, with_replaced
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features import timing
from gyrodrift.diagnose.features.block_means import touches
from gyrodrift.diagnose.features.block_residuals import unexplained_dps
from gyrodrift.diagnose.features.design_matrix import DesignMatrix, design_matrix_of
from gyrodrift.diagnose.features.feature import Measured
from gyrodrift.diagnose.features.vector import (
    Facts,
    hidden_dps,
    measure,
    measure_residuals,
    measure_samples,
    with_hidden,
)
from gyrodrift.diagnose.features.within_second import lag_basis
from gyrodrift.diagnose.recording.counted_rests import CountedRests, counted_rests
from gyrodrift.diagnose.recording.gyro_noise import GyroModel
from gyrodrift.diagnose.recording.motion import ReplayedMotion
from gyrodrift.diagnose.recording.motion_posterior import MotionPosterior, motion_posterior_of
from gyrodrift.diagnose.recording.outliers import Cleaned, cleaned
from gyrodrift.diagnose.recording.recording import Recording, recording_of
from gyrodrift.diagnose.recording.reference_noise import ReferenceNoise, reference_noise_of
from gyrodrift.diagnose.simulate.calibration import bias_beside, calibrated
from gyrodrift.diagnose.simulate.candidate import Shape
from gyrodrift.diagnose.simulate.known_effects import (
    MotionSeen,
    angles_before,
    angles_read,
    gyro_model_of,
    known_at_limit,
    moments_of,
    motion_seen_by,
    restored_dps,
    taken_dps,
    with_phases,
)
from gyrodrift.session.session import Session
from gyrodrift.simulation.sessions import as_recorded

SHAPES, MOTIONS, ARRIVALS, REFERENCES = 1, 2, 3, 4
"""Tell their random streams from those of effects, which go by their names."""


@dataclass(frozen=True, slots=True)
class BaseRun:
    """One realisation of the rig as it stands, driven through a recording's motion, and its features, (F,)."""

    seed: int
    seen: Cleaned
    design: DesignMatrix
    values: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Subject:
    """A recording with what it leaves possible of its motion, and the rig calibrated to it."""

    seen: Cleaned
    posterior: MotionPosterior
    design: DesignMatrix
    rig: Rig
    reference: ReferenceNoise | None = None
    drawn: dict[int, ReplayedMotion] = field(default_factory=dict, repr=False)
    held: dict[MotionSeen, "Subject"] = field(default_factory=dict, repr=False)

    @property
    def facts(self) -> Facts:
        """What the rig states."""
        base, axes = self.rig.base, self.rig.base.three_axes
        has_gravity = axes is not None and axes.mps2_per_lsb > 0.0
        step_dps = gyro_model_of(self.rig).count_dps
        return Facts(base.dps_per_lsb, base.encoder_cpr, step_dps, axes is not None, has_gravity)

    def with_noise(self, share: float) -> "Subject":
        """The same with the noise of the rig multiplied."""
        base = self.rig.base.model_copy(update={"noise_dps_rthz": self.rig.base.noise_dps_rthz * share})
        return self._with_base(base)

    def recalibrated(self, effects: tuple[Effect, ...]) -> "Subject":
        """The same with noise and bias found beside more effects of the rig, which hide both at rest."""
        motion = self.held_to(effects).posterior.mean
        return self._with_base(calibrated(self.seen, self.design, motion, with_replaced(self.rig, effects)).base)

    def beside(self, effects: tuple[Effect, ...]) -> "Subject":
        """The same with the bias that is left beside more effects."""
        bias_dps = bias_beside(self.seen, self.design, self.rig, effects)
        return self._with_base(self.rig.base.model_copy(update={"bias_dps": bias_dps}))

    def held_to(self, effects: tuple[Effect, ...]) -> "Subject":
        """The same with the motion that is behind its angles and rates if the rig has more effects.

        What was recorded stands as it is, whatever is held to be behind it: a disc off its centre, added to a motion
        that follows its angles, would show them twice as far off, and a late gyro would be twice as late.
        """
        rig = with_replaced(self.rig, effects)
        seen_by = motion_seen_by(rig)
        if seen_by == motion_seen_by(self.rig):
            return self
        if seen_by not in self.held:
            self.held.clear()  # sizes are simulated one after the other, and a motion takes as much as a recording
            _, posterior = corrected(self.seen, rig, self.posterior)
            self.held[seen_by] = replace(self, posterior=posterior, drawn={}, held={})
        return self.held[seen_by]

    def motion(self, seed: int) -> ReplayedMotion:
        """A motion that the recording leaves possible; the same seed is the same motion."""
        if seed not in self.drawn:
            rng = np.random.default_rng([self._course() + seed, MOTIONS])
            self.drawn[seed] = self.posterior.draw(rng, self._counted_rests())
        return self.drawn[seed]

    def _counted_rests(self) -> CountedRests:
        """Where it rests, by what the rig's encoder would read."""
        posterior = self.posterior
        return counted_rests(
            posterior.rests,
            self.seen.encoder_deg,
            posterior.encoder_deg,
            partial(angles_read, self.rig),
            self.seen.step_deg,
        )

    def measured(self) -> Measured:
        """Features of the recording itself; thresholds know what steps of the rate hide."""
        base = self.rig.base
        hidden = hidden_dps(self.facts.step_dps, base.noise_dps_rthz * base.sample_rate_hz**0.5)
        left_dps = unexplained_dps(self.seen, self.design)
        scatter_dps = float(np.sqrt(np.mean(np.square(left_dps))))
        own = measure(self.seen, self.design, self.facts)
        return with_hidden(own, hidden, self.facts.step_dps, scatter_dps, len(left_dps))

    def replayed(self, effects: tuple[Effect, ...], seed: int) -> Cleaned:
        """The rig with more effects, driven through the recording's motion; the same seed is the same realisation."""
        return cleaned(self.played(effects, seed))

    def simulated(self, effects: tuple[Effect, ...], seed: int) -> Measured:
        """Features of that."""
        return self.measured_again(self.replayed(effects, seed))

    def measured_again(self, seen: Cleaned) -> Measured:
        """Features of a simulation, against the motion that is rebuilt from itself."""
        return measure(seen, rebuilt(seen, self.rig).design, self.facts)

    def values_measured_again(self, seen: Cleaned) -> Floats:
        """The same but for those of times, which are the last."""
        design = rebuilt(seen, self.rig).design
        return np.concatenate(
            [measure_residuals(seen, design).values, measure_samples(seen, design, self.facts).values]
        )

    def base_run(self, seed: int) -> BaseRun:
        """The rig as it stands, driven through the recording's motion."""
        seen = self.replayed((), seed)
        design = rebuilt(seen, self.rig).design
        return BaseRun(seed, seen, design, measure(seen, design, self.facts).values)

    def design_beside(self, seen: Cleaned, base: BaseRun) -> DesignMatrix:
        """The design of a run without an effect for what is seen with it: only what an encoder itself shows is new.

        Rebuilding the motion takes ten times as long, and changes little; but where another limit keeps the gyro from
        saying anything, other blocks tell. What is but added to the rate leaves limits where they were.
        """
        if seen.encoder_deg is base.seen.encoder_deg:
            return base.design
        at_limit, one = known_at_limit(self.rig, seen), base.design
        if at_limit is not None and not np.array_equal(touches(at_limit, one.period_s, one.block), one.is_silent):
            return rebuilt(seen, self.rig).design
        if np.array_equal(seen.encoder_deg, base.seen.encoder_deg):
            return base.design
        return replace(base.design, lag=lag_basis(seen.encoder_deg, base.design.period_s))

    def residual_features(self, seen: Cleaned, base: BaseRun) -> Floats:
        """The first features: those that a slow change of the rate moves."""
        return measure_residuals(seen, self.design_beside(seen, base)).values

    def value_features(self, seen: Cleaned, base: BaseRun) -> Floats:
        """All features but those of times, which are the last."""
        of_samples = measure_samples(seen, base.design, self.facts).values
        return np.concatenate([self.residual_features(seen, base), of_samples])

    def time_features(self, effects: tuple[Effect, ...], seed: int) -> Floats:
        """Only those of clock and link, for effects that touch nothing else."""
        return timing.measure(self.played(effects, seed)).values

    def with_rate(self, effects: tuple[Effect, ...], base: BaseRun, seed: int) -> Cleaned:
        """What a simulation is with a realisation of effects that only add to the rate, without playing it again."""
        motion = self.motion(base.seed)
        truth = moments_of(motion)
        rate_dps = base.seen.rate_dps
        for effect in effects:
            rng = np.random.default_rng([self._stream(seed), crc32(effect.name.encode())])
            rate_dps = effect.begin(rng, 1.0 / motion.period_s)(rate_dps, truth)
        return replace(base.seen, rate_dps=rate_dps)

    def in_counts(self, seen: Cleaned) -> Cleaned:
        """The same in whole counts again, after something was added to the rate."""
        step_dps = self.facts.step_dps
        return replace(seen, rate_dps=np.rint(seen.rate_dps / step_dps) * step_dps if step_dps else seen.rate_dps)

    def with_shape(self, shape: Shape, size: float, seed: int, without: Cleaned) -> Cleaned:
        """What a simulation is with something added to its rate that is no effect."""
        added_dps = shape(self.design, np.random.default_rng([self._stream(seed), SHAPES]))
        return replace(without, rate_dps=without.rate_dps + size * added_dps)

    def _with_base(self, base: Base) -> "Subject":
        return replace(self, rig=self.rig.model_copy(update={"base": base}))

    def _course(self) -> int:
        """Sessions that play one profile draw by the same random numbers: what is wrong in rebuilding it is shared.

        They are told by where they are from time to time, roughly, since no two of them have quite the same counts.
        """
        every = max(1, round(5.0 / self.seen.recording.period_s))
        away_deg = self.seen.encoder_deg[::every] - self.seen.encoder_deg[0]
        return crc32(np.rint(away_deg / 45.0).astype(np.int32).tobytes())

    def _stream(self, seed: int) -> int:
        """No two sessions are the same realisation."""
        return crc32(self.seen.recording.name.encode()) + seed

    def session(self, effects: tuple[Effect, ...], seed: int) -> Session:
        """The rig with more effects, driven through the recording's motion, as a host would have recorded it.

        An effect that stands in the rig already is replaced.
        """
        # Ticks of a host begin anywhere.
        later_s = 0.1 * float(np.random.default_rng([self._stream(seed), ARRIVALS]).random())
        base = self.rig.base.model_copy(update={"host_delay_s": self.rig.base.host_delay_s + later_s})
        rig = with_replaced(self.rig, effects).model_copy(update={"base": base})
        motion = self.held_to(effects).motion(seed)
        block = next(play(rig, motion, self._stream(seed), block_samples=self.design.samples))
        session = as_recorded(block, rig.base, self.seen.recording.name)
        if self.reference is None or session.encoder_deg is None:
            return session
        noise_deg = self.reference.drawn(np.random.default_rng([self._stream(seed), REFERENCES]))
        return replace(session, encoder_deg=session.encoder_deg + noise_deg[block.seq])

    def played(self, effects: tuple[Effect, ...], seed: int) -> Recording:
        """A simulation holds what the recording holds: arrivals or numbers that it lacks are no difference."""
        recording, session = self.seen.recording, self.session(effects, seed)
        if recording.host_s is None:
            session = replace(session, t_host_s=None)
        if not recording.has_counter:
            session = replace(session, seq=None)
        return recording_of(session, self.design.samples)


def subject_of(recording: Recording, rig: Rig, least_noise_dps_rthz: float = 0.0) -> Subject:
    """Rebuild the motion, and calibrate the rig, with no less noise than it is known to have."""
    seen = cleaned(recording)
    known, posterior, design, encoder_deg = rebuilt(seen, rig)
    reference = reference_noise_of(encoder_deg, seen.step_deg, posterior.mean)
    rig_of_session = calibrated(seen, design, posterior.mean, known, least_noise_dps_rthz)
    return Subject(seen, posterior, design, rig_of_session, reference)


class Rebuilt(NamedTuple):
    """The motion behind what was seen, the design matrix that it gives, and the rig with the phases of this session.

    encoder_deg
        Angles of the encoder without what the rig says it errs by.
    """

    rig: Rig
    posterior: MotionPosterior
    design: DesignMatrix
    encoder_deg: Floats


def rebuilt(seen: Cleaned, rig: Rig) -> Rebuilt:
    """What an encoder and a gyro of this rig say of how they were moved."""
    gyro = _as_late_as_it_is(gyro_model_of(rig), seen)
    posterior, at_limit = motion_posterior_of(seen, gyro), known_at_limit(rig, seen)
    design = design_matrix_of(seen, posterior.mean, posterior.sigma_dps, at_limit)
    known = with_phases(rig, seen, design)
    if not motion_seen_by(rig).is_bent:
        return Rebuilt(known, posterior, design, seen.encoder_deg)
    encoder_deg, posterior = corrected(seen, known, posterior)
    design = design_matrix_of(seen, posterior.mean, posterior.sigma_dps, at_limit)
    return Rebuilt(known, posterior, design, encoder_deg)


def corrected(seen: Cleaned, rig: Rig, posterior: MotionPosterior) -> tuple[Floats, MotionPosterior]:
    """Angles of the encoder without what a rig says it errs by, and the motion behind them, from one about right."""
    gyro = _as_late_as_it_is(gyro_model_of(rig), seen)
    if not motion_seen_by(rig).is_bent:
        return seen.encoder_deg, motion_posterior_of(seen, gyro)
    encoder_deg, rate_dps = seen.encoder_deg, restored_dps(rig, posterior.mean)
    for _ in range(2):  # rounds, each with the motion of the one before
        encoder_deg = angles_before(rig, seen.encoder_deg, posterior.mean)
        whole = replace(seen, rate_dps=seen.rate_dps + taken_dps(rig, posterior.mean, rate_dps))
        posterior = motion_posterior_of(whole, gyro, encoder_deg)
        rate_dps = posterior.mean.rate_dps
    return encoder_deg, posterior


def _as_late_as_it_is(gyro: GyroModel, seen: Cleaned) -> GyroModel:
    """The gyro with the delay that the recording shows, where that is far from the rig's.

    Else rates of one moment would be taken for the motion of another, and bend it.
    """
    if not seen.recording.has_motion:
        return gyro
    # A smaller delay costs the motion no more than the two disagree in noise.
    return gyro if abs(seen.late_s - gyro.delay_s) < 0.02 else replace(gyro, delay_s=seen.late_s)
