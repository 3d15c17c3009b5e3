"""Noise of a reference: cameras and robots have references that scatter by far more than their steps.

The noise weakens every regression on the reference (errors in variables). A simulation with a reference without this
noise would show an effect more clearly than the recording does.
"""

from dataclasses import dataclass

import numpy as np

from gyrodrift.diagnose.recording.motion import ReplayedMotion
from gyrodrift.diagnose.recording.smoothing import gaussian
from gyrodrift.values.arrays import Floats
from gyrodrift.values.constants import NORMAL_MAD

CLIP_SIGMAS = 6.0
"""Standard deviations at which the noise is clipped. Chosen: larger deviations are slips or interpolated gaps."""


@dataclass(frozen=True, slots=True, eq=False)
class ReferenceNoise:
    """Deviation of a reference from the motion, deg, shape (n,), and the period of its samples, s."""

    deviation_deg: Floats
    period_s: float

    def drawn(self, rng: np.random.Generator) -> Floats:
        """(n,) random noise, deg, of the same size and spectrum near every sample.

        The deviation is multiplied by a random function that changes within about a second. So the noise has no
        relation to the motion.
        """
        sign = gaussian(rng.standard_normal(len(self.deviation_deg)), 1.0 / self.period_s)
        drawn_deg: Floats = self.deviation_deg * sign / np.sqrt(np.mean(np.square(sign)))
        return drawn_deg


def reference_noise_of(reference_deg: Floats, step_deg: float, motion: ReplayedMotion) -> ReferenceNoise | None:
    """Noise of a reference, (n,); None if it is at most three steps, which rounding may explain."""
    residual_deg = _without_effects(reference_deg - motion.angle_deg, motion)
    usual_deg = np.median(np.abs(residual_deg)) * NORMAL_MAD
    if usual_deg <= 3.0 * step_deg:
        return None
    return ReferenceNoise(np.clip(residual_deg, -CLIP_SIGMAS * usual_deg, CLIP_SIGMAS * usual_deg), motion.period_s)


def _without_effects(deviation_deg: Floats, motion: ReplayedMotion) -> Floats:
    """(n,) deviation without the errors of an encoder that is eccentric, tilted or has play: they are effects."""
    turn = np.deg2rad(motion.angle_deg)
    columns = [np.ones(len(turn)), np.sign(motion.rate_dps)]
    columns += [wave(times * turn) for times in (1, 2) for wave in (np.sin, np.cos)]  # an eccentric or tilted disc
    errors = np.column_stack(columns)
    residual_deg: Floats = deviation_deg - errors @ np.linalg.lstsq(errors, deviation_deg)[0]
    return residual_deg
