"""What a reference says beyond the motion: that of cameras and robots scatters by far more than its steps.

A simulation whose reference is quieter than the real one shows an effect more clearly than a recording does: what is
held against the reference is weakened by its noise (errors in variables).
"""

from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.recording.motion import ReplayedMotion
from gyrodrift.diagnose.recording.order_statistics import MEDIAN_TO_SIGMA
from gyrodrift.diagnose.recording.smoothing import gaussian

WILD_SIGMAS = 6.0
"""What is further off is no noise: a slip, or a hole that was filled."""


@dataclass(frozen=True, slots=True, eq=False)
class ReferenceNoise:
    """Angles of a reference about the motion, deg, shape (n,), and the period of its samples, s."""

    seen_deg: Floats
    period_s: float

    def drawn(self, rng: np.random.Generator) -> Floats:
        """Noise as large and as quick at every moment, shape (n,), deg."""
        # Keeps size and shape of each moment, not its relation to the motion.
        sign = gaussian(rng.standard_normal(len(self.seen_deg)), 1.0 / self.period_s)
        drawn_deg: Floats = self.seen_deg * sign / np.sqrt(np.mean(np.square(sign)))
        return drawn_deg


def reference_noise_of(reference_deg: Floats, step_deg: float, motion: ReplayedMotion) -> ReferenceNoise | None:
    """Of angles, shape (n,), beside their motion; None where it is no more than the steps of an encoder leave."""
    away_deg = _without_errors(reference_deg - motion.angle_deg, motion)
    usual_deg = np.median(np.abs(away_deg)) / MEDIAN_TO_SIGMA
    if usual_deg <= 3.0 * step_deg:  # steps leave less
        return None
    return ReferenceNoise(np.clip(away_deg, -WILD_SIGMAS * usual_deg, WILD_SIGMAS * usual_deg), motion.period_s)


def _without_errors(away_deg: Floats, motion: ReplayedMotion) -> Floats:
    """What is off, less what an encoder errs by that is eccentric, tilted or has play: effects, and no noise."""
    turn = np.deg2rad(motion.angle_deg)
    columns = [np.ones(len(turn)), np.sign(motion.rate_dps)]
    columns += [wave(times * turn) for times in (1, 2) for wave in (np.sin, np.cos)]  # an eccentric or tilted disc
    errors = np.column_stack(columns)
    left_deg: Floats = away_deg - errors @ np.linalg.lstsq(errors, away_deg)[0]
    return left_deg
