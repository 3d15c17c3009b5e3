"""Motion between rests, from the reference angle."""

import numpy as np

from gyrodrift.arrays import Floats

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
    if is_known.sum() < 2:
        return 0.0
    grid_s = np.arange(t_s[0], t_s[-1] + STEP_S, STEP_S)
    angle_deg = np.interp(grid_s, t_s[is_known], reference_deg[is_known])
    is_moving = np.concatenate(([False], np.abs(np.diff(angle_deg)) >= REST_DEG, [False])).astype(np.int8)
    changes = np.flatnonzero(np.diff(is_moving))
    return float((changes[1::2] - changes[::2]).max(initial=0)) * STEP_S
