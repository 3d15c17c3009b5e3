"""Motion between rests, from the reference angle."""

import numpy as np

from gyrodrift.facts.arrays import true_runs
from gyrodrift.values.arrays import Floats

STEP_S = 1.0
REST_DEG = 0.5
"""A second is a rest if the reference angle changes by less than REST_DEG: chosen, above the scatter of encoders."""


def longest_motion_s(t_s: Floats, reference_deg: Floats) -> float:
    """Longest motion without a rest, s.

    Parameters
    ----------
    t_s
        Times of the samples, s, increasing, shape (n,).
    reference_deg
        Unwrapped reference angle, deg, NaN if unknown, shape (n,).
    """
    is_known = np.isfinite(reference_deg)
    known_s = t_s[is_known]
    if not len(known_s):
        return 0.0
    seconds, first = np.unique((known_s - known_s[0]) // STEP_S, return_index=True)
    start_s, angle_deg = known_s[first], reference_deg[is_known][first]
    is_moving = np.abs(np.diff(angle_deg)) >= REST_DEG * np.diff(seconds)
    return max((float(start_s[end] - start_s[first]) for first, end in true_runs(is_moving)), default=0.0)
