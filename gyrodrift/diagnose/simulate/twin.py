"""A rig driven through a recording's own motion, and the result put through the same parsing as the recording."""

from dataclasses import dataclass, replace
from zlib import crc32

import numpy as np

from firmware_sim.effects.effect import Effect, Moments
from firmware_sim.measure import measure as play
from firmware_sim.rig import Rig
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features import residuals, timing
from gyrodrift.diagnose.features.block_residuals import block_residual_dps
from gyrodrift.diagnose.features.design_matrix import DesignMatrix, design_matrix_of
from gyrodrift.diagnose.features.feature import Measured
from gyrodrift.diagnose.features.spectral_line import white_dps
from gyrodrift.diagnose.features.vector import Facts, measure, measure_samples
from gyrodrift.diagnose.recording.outliers import Cleaned, cleaned
from gyrodrift.diagnose.recording.recording import Recording, recording_of
from gyrodrift.diagnose.simulate.candidate import Shape
from gyrodrift.session.session import Session
from gyrodrift.simulation.sessions import as_recorded

SHAPES = 1
"""Tells their random streams from those of effects, which go by their names."""


@dataclass(frozen=True, slots=True)
class BaseRun:
    """One realisation of the rig as it stands, driven through a recording's motion, and its features, (F,)."""

    seed: int
    seen: Cleaned
    values: Floats


@dataclass(frozen=True, slots=True)
class Subject:
    """A recording with its design, and the rig calibrated to it: sample rate, noise and bias of the session."""

    seen: Cleaned
    design: DesignMatrix
    rig: Rig

    @property
    def facts(self) -> Facts:
        """What the rig states."""
        return Facts(self.rig.base.dps_per_lsb, self.rig.base.encoder_cpr)

    def with_noise(self, share: float) -> "Subject":
        """The same with the noise of the rig multiplied."""
        base = self.rig.base.model_copy(update={"noise_dps_rthz": self.rig.base.noise_dps_rthz * share})
        return replace(self, rig=self.rig.model_copy(update={"base": base}))

    def measured(self) -> Measured:
        """Features of the recording itself."""
        return measure(self.seen, self.design, self.facts)

    def replayed(self, effects: tuple[Effect, ...], seed: int) -> Cleaned:
        """The rig with more effects, driven through the recording's motion; the same seed is the same realisation."""
        return cleaned(self._played(effects, seed))

    def simulated(self, effects: tuple[Effect, ...], seed: int) -> Measured:
        """Features of that."""
        return measure(self.replayed(effects, seed), self.design, self.facts)

    def base_run(self, seed: int) -> BaseRun:
        """The rig as it stands, driven through the recording's motion."""
        seen = self.replayed((), seed)
        return BaseRun(seed, seen, measure(seen, self.design, self.facts).values)

    def residual_features(self, seen: Cleaned) -> Floats:
        """The first features: those that a slow change of the rate moves."""
        return residuals.measure(seen, self.design).values

    def value_features(self, seen: Cleaned) -> Floats:
        """All features but those of times, which are the last."""
        of_samples = measure_samples(seen, self.design, self.facts).values
        return np.concatenate([self.residual_features(seen), of_samples])

    def time_features(self, effects: tuple[Effect, ...], seed: int) -> Floats:
        """Only those of clock and link, for effects that touch nothing else."""
        return timing.measure(self._played(effects, seed)).values

    def with_rate(self, effects: tuple[Effect, ...], seed: int, without: Cleaned) -> Cleaned:
        """What a simulation is with effects that only add to the rate, without playing it again."""
        motion = self.design.motion
        t_s: Floats = np.arange(self.design.samples, dtype=np.float64) * motion.period_s
        truth = Moments(
            t_s, t_s + motion.powered_s, motion.angle_deg, motion.rate_dps, motion.sensor_c, motion.period_s
        )
        rate_dps = without.rate_dps
        for effect in effects:
            rng = np.random.default_rng([self._stream(seed), crc32(effect.name.encode())])
            rate_dps = effect.begin(rng, 1.0 / motion.period_s)(rate_dps, truth)
        return replace(without, rate_dps=rate_dps)

    def with_shape(self, shape: Shape, size: float, seed: int, without: Cleaned) -> Cleaned:
        """What a simulation is with something added to its rate that is no effect."""
        added_dps = shape(self.design, np.random.default_rng([self._stream(seed), SHAPES]))
        return replace(without, rate_dps=without.rate_dps + size * added_dps)

    def _stream(self, seed: int) -> int:
        """No two sessions are the same realisation."""
        return crc32(self.seen.recording.name.encode()) + seed

    def session(self, effects: tuple[Effect, ...], seed: int) -> Session:
        """The rig with more effects, driven through the recording's motion, as a host would have recorded it."""
        rig = self.rig.model_copy(update={"effects": (*self.rig.effects, *effects)})
        block = next(play(rig, self.design.motion, self._stream(seed), block_samples=self.design.samples))
        return as_recorded(block, rig.base, self.seen.recording.name)

    def _played(self, effects: tuple[Effect, ...], seed: int) -> Recording:
        """A simulation holds what the recording holds: arrivals or numbers that it lacks are no difference."""
        recording, session = self.seen.recording, self.session(effects, seed)
        if recording.host_s is None:
            session = replace(session, t_host_s=None)
        if not recording.has_counter:
            session = replace(session, seq=None)
        return recording_of(session, self.design.samples)


def subject_of(recording: Recording, rig: Rig) -> Subject:
    """Rebuild the motion, and calibrate the rig."""
    seen = cleaned(recording)
    design = design_matrix_of(seen)
    residual_dps = block_residual_dps(seen, design)
    # A dead band hides the bias where it rests.
    moving = residual_dps[~design.regimes.block_at_rest]
    bias_dps = float(np.median(moving if len(moving) > len(residual_dps) // 10 else residual_dps))
    sigma_dps = white_dps(seen, design, rig.base.dps_per_lsb)
    base = rig.base.model_copy(
        update={
            "sample_rate_hz": 1.0 / recording.period_s,
            "noise_dps_rthz": sigma_dps * recording.period_s**0.5,
            "bias_dps": bias_dps,
        }
    )
    return Subject(seen, design, rig.model_copy(update={"base": base}))
