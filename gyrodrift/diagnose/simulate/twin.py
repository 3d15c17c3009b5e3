"""Simulation of a recording: the rig is driven through a motion that is drawn from the posterior of the recording's.

The output is processed in the same way as a recording: numbering, checks, cleaning, and rebuilding of the motion from
encoder and gyro.
"""

from dataclasses import dataclass, field, replace
from functools import partial
from typing import NamedTuple
from zlib import crc32

import numpy as np

from firmware_sim.effects.effect import Effect
from firmware_sim.measure import measure as play
from firmware_sim.rig import Base, Rig, with_replaced
from gyrodrift.diagnose.features import timing
from gyrodrift.diagnose.features.block_means import blocks_with
from gyrodrift.diagnose.features.block_residuals import unexplained_dps
from gyrodrift.diagnose.features.design_matrix import DesignMatrix, design_matrix_of
from gyrodrift.diagnose.features.feature import Measured
from gyrodrift.diagnose.features.vector import (
    Facts,
    measure,
    measure_residuals,
    measure_samples,
    rounding_error_dps,
    with_rounding_error,
)
from gyrodrift.diagnose.features.within_second import lag_basis
from gyrodrift.diagnose.recording.counted_rests import CountedRests, counted_rests
from gyrodrift.diagnose.recording.gyro_noise import GyroModel
from gyrodrift.diagnose.recording.motion import ReplayedMotion
from gyrodrift.diagnose.recording.motion_posterior import MotionPosterior, motion_posterior_of
from gyrodrift.diagnose.recording.outliers import Cleaned, clean
from gyrodrift.diagnose.recording.recording import Recording, recording_of
from gyrodrift.diagnose.recording.reference_noise import ReferenceNoise, reference_noise_of
from gyrodrift.diagnose.simulate.calibration import (
    NO_VIBRATION,
    GyroVibration,
    calibrated,
    remaining_bias_dps,
    vibration_of,
)
from gyrodrift.diagnose.simulate.candidate import Shape
from gyrodrift.diagnose.simulate.known_effects import (
    SensorModel,
    angles_without_error,
    counted_angles,
    gyro_model_of,
    known_at_limit,
    low_pass_loss_dps,
    moments_of,
    restored_dps,
    sensor_model_of,
    with_phases,
)
from gyrodrift.session.session import Session
from gyrodrift.simulation.sessions import as_recorded
from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import DataError

SHAPES, MOTIONS, ARRIVALS, REFERENCES, VIBRATIONS = 1, 2, 3, 4, 5
"""Keys of the random streams for added shapes, motions, arrivals, reference noise and vibration; effects have
streams by name. Chosen: any five different numbers."""

REBUILT_LEAST, REBUILT_MOST = 2, 8
"""Rounds in which the motion is rebuilt from corrected angles; a round begins with the motion of the previous one. They
end when no angle changes by a count. Chosen: a play of 2 degrees takes six, a disc off its center two."""

VIBRATION_ROUNDS = 3
"""Rounds in which the share of the vibration in the noise is found. Chosen: the third is within its error."""


@dataclass(frozen=True, slots=True)
class BaseRun:
    """One simulation of the rig without further effects, driven through a recording's motion.

    design
        Design matrix of the motion that is rebuilt from the simulation.
    values
        Features, shape (F,).
    """

    seed: int
    cleaned: Cleaned
    design: DesignMatrix
    values: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Subject:
    """A recording, the posterior of its motion, and the rig calibrated to the recording.

    reference
        Noise of the reference angles; None if they scatter no more than the steps of an encoder.
    vibration
        Part of the gyro's noise that is not white.
    drawn
        Cache: motions drawn from the posterior, by seed.
    rebuilt_under
        Cache: subject with its motion rebuilt under a sensor model.
    """

    cleaned: Cleaned
    posterior: MotionPosterior
    design: DesignMatrix
    rig: Rig
    reference: ReferenceNoise | None = None
    vibration: GyroVibration = NO_VIBRATION
    drawn: dict[int, ReplayedMotion] = field(default_factory=dict, repr=False)
    rebuilt_under: dict[SensorModel, "Subject"] = field(default_factory=dict, repr=False)

    @property
    def facts(self) -> Facts:
        """Facts of the rig that no recording changes."""
        base, axes = self.rig.base, self.rig.base.three_axes
        has_gravity = axes is not None and axes.mps2_per_lsb > 0.0
        step_dps = gyro_model_of(self.rig).count_dps
        return Facts(base.dps_per_lsb, base.encoder_cpr, step_dps, axes is not None, has_gravity)

    def with_noise(self, factor: float) -> "Subject":
        """The subject with the noise of the rig multiplied by a factor."""
        base = self.rig.base.model_copy(update={"noise_dps_rthz": self.rig.base.noise_dps_rthz * factor})
        return self._with_base(base)

    def recalibrated(self, effects: tuple[Effect, ...]) -> "Subject":
        """The subject calibrated to the rig with more effects, for effects that hide noise and bias at rest."""
        motion = self.with_motion_under(effects).posterior.mean
        rig = with_replaced(self.rig, effects)
        return self._with_base(calibrated(self.cleaned, self.design, motion, rig, vibration=self.vibration).base)

    def with_remaining_bias(self, effects: tuple[Effect, ...]) -> "Subject":
        """The subject with the bias of the rig less the rate error of more effects; see `remaining_bias_dps`."""
        bias_dps = remaining_bias_dps(self.cleaned, self.design, self.rig, effects)
        return self._with_base(self.rig.base.model_copy(update={"bias_dps": bias_dps}))

    def with_motion_under(self, effects: tuple[Effect, ...]) -> "Subject":
        """The subject with its motion rebuilt under the assumption that the rig has more effects.

        The recorded angles already hold the error of these effects. If the motion followed the recorded angles, the
        simulation would add the error again: an eccentric disc would err twice as far, and a gyro lag twice as long.
        """
        rig = with_replaced(self.rig, effects)
        model = sensor_model_of(rig)
        if model == sensor_model_of(self.rig):
            return self
        if model not in self.rebuilt_under:
            # Only the latest is kept: sizes are simulated in sequence, and a motion is as large as a recording.
            self.rebuilt_under.clear()
            _, posterior = corrected(self.cleaned, rig, self.posterior)
            self.rebuilt_under[model] = replace(self, posterior=posterior, drawn={}, rebuilt_under={})
        return self.rebuilt_under[model]

    def motion(self, seed: int) -> ReplayedMotion:
        """A motion drawn from the posterior; a seed always gives the same motion."""
        if seed not in self.drawn:
            rng = np.random.default_rng([self._profile_hash() + seed, MOTIONS])
            self.drawn[seed] = self.posterior.draw(rng, self._counted_rests())
        return self.drawn[seed]

    def _counted_rests(self) -> CountedRests:
        """Rests of the motion, at angles for which the rig's encoder reads the recorded counts."""
        posterior = self.posterior
        return counted_rests(
            posterior.rests,
            self.cleaned.encoder_deg,
            posterior.encoder_deg,
            partial(counted_angles, self.rig),
            self.cleaned.step_deg,
        )

    def measured(self) -> Measured:
        """Features of the recording; the thresholds include the error by steps of the rate."""
        base = self.rig.base
        error_dps = rounding_error_dps(self.facts.step_dps, base.noise_dps_rthz * base.sample_rate_hz**0.5)
        residual_dps = unexplained_dps(self.cleaned, self.design)
        scatter_dps = float(np.sqrt(np.mean(np.square(residual_dps))))
        own = measure(self.cleaned, self.design, self.facts)
        return with_rounding_error(own, error_dps, self.facts.step_dps, scatter_dps, len(residual_dps))

    def replayed(self, effects: tuple[Effect, ...], seed: int) -> Cleaned:
        """Cleaned simulation of the rig with more effects; a seed always gives the same realization."""
        return clean(self.played(effects, seed))

    def simulated(self, effects: tuple[Effect, ...], seed: int) -> Measured:
        """Features of a simulation of the rig with more effects."""
        return self.measured_again(self.replayed(effects, seed))

    def measured_again(self, simulated: Cleaned) -> Measured:
        """Features of a simulation, with the motion rebuilt from the simulation itself."""
        return measure(simulated, rebuilt(simulated, self.rig).design, self.facts)

    def values_measured_again(self, simulated: Cleaned) -> Floats:
        """Values of `measured_again` without the features of times, which are the last."""
        design = rebuilt(simulated, self.rig).design
        return np.concatenate(
            [measure_residuals(simulated, design).values, measure_samples(simulated, design, self.facts).values]
        )

    def base_run(self, seed: int) -> BaseRun:
        """Simulation of the rig without further effects."""
        simulated = self.replayed((), seed)
        design = rebuilt(simulated, self.rig).design
        return BaseRun(seed, simulated, design, measure(simulated, design, self.facts).values)

    def design_for(self, simulated: Cleaned, base: BaseRun) -> DesignMatrix:
        """Design matrix of a simulation with an effect: that of its base run, with the lag basis of its own encoder.

        Rebuilding the motion would take ten times as long and changes little. It is rebuilt only if the gyro is at its
        limit in other blocks than in the base run. An effect that only adds to the rate moves no limit.
        """
        if simulated.encoder_deg is base.cleaned.encoder_deg:
            return base.design
        at_limit, design = known_at_limit(self.rig, simulated), base.design
        if at_limit is not None and not np.array_equal(
            blocks_with(at_limit, design.period_s, design.block), design.is_silent
        ):
            return rebuilt(simulated, self.rig).design
        if np.array_equal(simulated.encoder_deg, base.cleaned.encoder_deg):
            return base.design
        return replace(base.design, lag=lag_basis(simulated.encoder_deg, base.design.period_s))

    def residual_features(self, simulated: Cleaned, base: BaseRun) -> Floats:
        """Values of RESIDUAL_FEATURES, which are the first: slow changes of the rate change only these."""
        return measure_residuals(simulated, self.design_for(simulated, base)).values

    def value_features(self, simulated: Cleaned, base: BaseRun) -> Floats:
        """Values of all features without those of times, which are the last."""
        of_samples = measure_samples(simulated, base.design, self.facts).values
        return np.concatenate([self.residual_features(simulated, base), of_samples])

    def time_features(self, effects: tuple[Effect, ...], seed: int) -> Floats:
        """Values of the features of clock and link, for effects that change nothing else."""
        return timing.measure(self.played(effects, seed)).values

    def rate_with(self, effect: Effect, base: BaseRun, seed: int) -> Floats:
        """Rate of a base run with a realization of an effect that only adds to the rate, deg/s, shape (n,)."""
        motion = self.motion(base.seed)
        rng = np.random.default_rng([self._stream(seed), crc32(effect.name.encode())])
        rate_dps: Floats = effect.begin(rng, 1.0 / motion.period_s)(base.cleaned.rate_dps, moments_of(motion))
        return rate_dps

    def in_counts(self, simulated: Cleaned) -> Cleaned:
        """A simulation with its rate rounded to whole steps again, after something was added to the rate."""
        step_dps, rate_dps = self.facts.step_dps, simulated.rate_dps
        return replace(simulated, rate_dps=np.rint(rate_dps / step_dps) * step_dps if step_dps else rate_dps)

    def shape_dps(self, shape: Shape, seed: int) -> Floats:
        """Rate that an out-of-catalog model adds at size 1, deg/s, shape (n,)."""
        return shape(self.design, np.random.default_rng([self._stream(seed), SHAPES]))

    def _with_base(self, base: Base) -> "Subject":
        return replace(self, rig=self.rig.model_copy(update={"base": base}))

    def _profile_hash(self) -> int:
        """Hash of the motion profile, a seed for drawing motions.

        Sessions of one profile share the errors of rebuilding it, so they use the same random numbers. The angles are
        compared every 5 s, rounded to 45 degrees, since two sessions never have exactly the same counts.
        """
        stride = max(1, round(5.0 / self.cleaned.recording.period_s))
        away_deg = self.cleaned.encoder_deg[::stride] - self.cleaned.encoder_deg[0]
        return crc32(np.rint(away_deg / 45.0).astype(np.int32).tobytes())

    def _stream(self, seed: int) -> int:
        """Seed of the random streams; it includes the name, so that every session is a realization of its own."""
        return crc32(self.cleaned.recording.name.encode()) + seed

    def session(self, effects: tuple[Effect, ...], seed: int) -> Session:
        """Simulated session of the rig with more effects, as a host would have recorded it.

        An effect that the rig already has is replaced.
        """
        # A host's ticks have a random phase.
        phase_s = 0.1 * float(np.random.default_rng([self._stream(seed), ARRIVALS]).random())
        base = self.rig.base.model_copy(update={"host_delay_s": self.rig.base.host_delay_s + phase_s})
        rig = with_replaced(self.rig, effects).model_copy(update={"base": base})
        rng = np.random.default_rng([self._stream(seed), VIBRATIONS])
        motion = self.vibration.shaking(self.with_motion_under(effects).motion(seed), rig.base, rng)
        block = next(play(rig, motion, self._stream(seed), block_samples=self.design.samples))
        session = as_recorded(block, rig.base, self.cleaned.recording.name)
        if self.reference is None or session.encoder_deg is None:
            return session
        noise_deg = self.reference.drawn(np.random.default_rng([self._stream(seed), REFERENCES]))
        return replace(session, encoder_deg=session.encoder_deg + noise_deg[block.seq])

    def played(self, effects: tuple[Effect, ...], seed: int) -> Recording:
        """Recording of a simulated session; without a counter, arrival times or angles that the real one lacks."""
        real, session = self.cleaned.recording, self.session(effects, seed)
        if real.host_s is None:
            session = replace(session, t_host_s=None)
        recording = self._on_grid(session)
        lacks_angle = np.isfinite(real.rate_dps) & ~np.isfinite(real.encoder_deg)
        if not lacks_angle.any():
            return recording
        return replace(recording, encoder_deg=np.where(lacks_angle, np.nan, recording.encoder_deg))

    def _on_grid(self, session: Session) -> Recording:
        """Recording of a session, numbered by its clock if the real recording has no counter."""
        if self.cleaned.recording.has_counter:
            return recording_of(session, self.design.samples)
        try:
            return recording_of(replace(session, seq=None), self.design.samples)
        except DataError:  # stamps that scatter by many periods show no grid, but the simulator knows it
            return replace(recording_of(session, self.design.samples), has_counter=False)


def subject_of(recording: Recording, rig: Rig, least_noise_dps_rthz: float = 0.0) -> Subject:
    """Rebuild the motion of a recording, and calibrate the rig to it.

    least_noise_dps_rthz
        Lower bound of the calibrated noise.
    """
    cleaned = clean(recording)
    rig_with_phases, posterior, design, encoder_deg = rebuilt(cleaned, rig)
    reference = reference_noise_of(encoder_deg, cleaned.step_deg, posterior.mean)
    calibrate = partial(calibrated, cleaned, design, posterior.mean, rig_with_phases, least_noise_dps_rthz)
    rig_of_session, vibration = calibrate(), NO_VIBRATION
    for _ in range(VIBRATION_ROUNDS):
        before, vibration = vibration, vibration_of(cleaned, design, posterior, rig_of_session, vibration)
        if vibration == before:
            break
        rig_of_session = calibrate(vibration)
    return Subject(cleaned, posterior, design, rig_of_session, reference, vibration)


class Rebuilt(NamedTuple):
    """Motion rebuilt from a recording, its design matrix, and the rig with the phases of this session.

    encoder_deg
        Angles of the encoder without the errors that the rig states, shape (n,).
    """

    rig: Rig
    posterior: MotionPosterior
    design: DesignMatrix
    encoder_deg: Floats


def rebuilt(cleaned: Cleaned, rig: Rig) -> Rebuilt:
    """Rebuild the motion from the angles and rates of a recording, assuming this rig."""
    gyro = _with_recorded_delay(gyro_model_of(rig), cleaned)
    posterior, at_limit = motion_posterior_of(cleaned, gyro), known_at_limit(rig, cleaned)
    design = design_matrix_of(cleaned, posterior.mean, posterior.sigma_dps, at_limit)
    rig_with_phases = with_phases(rig, cleaned, design)
    if not sensor_model_of(rig).distorts_motion:
        return Rebuilt(rig_with_phases, posterior, design, cleaned.encoder_deg)
    encoder_deg, posterior = corrected(cleaned, rig_with_phases, posterior)
    design = design_matrix_of(cleaned, posterior.mean, posterior.sigma_dps, at_limit)
    return Rebuilt(rig_with_phases, posterior, design, encoder_deg)


def corrected(cleaned: Cleaned, rig: Rig, posterior: MotionPosterior) -> tuple[Floats, MotionPosterior]:
    """Angles of the encoder without the errors that a rig states, shape (n,), and the motion rebuilt from them.

    posterior
        An approximate motion to begin with.
    """
    gyro = _with_recorded_delay(gyro_model_of(rig), cleaned)
    if not sensor_model_of(rig).distorts_motion:
        return cleaned.encoder_deg, motion_posterior_of(cleaned, gyro)
    encoder_deg, rate_dps = cleaned.encoder_deg, restored_dps(rig, posterior.mean)
    for rounds in range(REBUILT_MOST):
        before_deg, encoder_deg = encoder_deg, angles_without_error(rig, cleaned.encoder_deg, posterior.mean)
        if rounds >= REBUILT_LEAST and float(np.abs(encoder_deg - before_deg).max()) < cleaned.step_deg:
            break
        restored = replace(cleaned, rate_dps=cleaned.rate_dps + low_pass_loss_dps(rig, posterior.mean, rate_dps))
        posterior = motion_posterior_of(restored, gyro, encoder_deg)
        rate_dps = posterior.mean.rate_dps
    return encoder_deg, posterior


def _with_recorded_delay(gyro: GyroModel, cleaned: Cleaned) -> GyroModel:
    """The gyro with the delay that the recording shows, if it differs from the rig's by 20 ms or more.

    With a wrong delay, rates would be assigned to the motion of another moment, and distort it.
    """
    if not cleaned.recording.has_motion:
        return gyro
    # A smaller difference changes the motion by less than the noise of gyro and encoder.
    return gyro if abs(cleaned.delay_s - gyro.delay_s) < 0.02 else replace(gyro, delay_s=cleaned.delay_s)
