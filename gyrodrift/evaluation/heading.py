"""Heading of attitudes: the twist of a quaternion about the vertical, unwrapped."""

import numpy as np

from gyrodrift.values.arrays import Floats

INVERTED_DEG = 150.0
"""Tilt above which the twist turns fast for small rotations; there the heading follows the rate about the vertical.

At 180 deg the twist is undefined. Measured: on recordings that turn over, the twist alone jumps in 8 of 71.
"""


def heading_deg(quaternions: Floats) -> Floats:
    """Unwrapped heading of attitudes (w, x, y, z) from sensor to earth, z up, deg, shape (n,), 0 at the first.

    Above `INVERTED_DEG` of tilt the heading continues by the rotation about the vertical between samples.
    """
    w, x, y, z = quaternions.T
    twist_deg = np.rad2deg(2.0 * np.arctan2(z, w))
    step_deg = np.diff(twist_deg, prepend=twist_deg[0])
    step_deg = (step_deg + 180.0) % 360.0 - 180.0
    tilt_deg = np.rad2deg(2.0 * np.arctan2(np.hypot(x, y), np.hypot(w, z)))
    inverted = (tilt_deg > INVERTED_DEG) & (np.roll(tilt_deg, 1) > INVERTED_DEG)
    inverted[0] = False
    step_deg[inverted] = vertical_turn_deg(quaternions)[inverted]
    heading: Floats = np.cumsum(step_deg)
    return heading


def vertical_turn_deg(quaternions: Floats) -> Floats:
    """Rotation about the vertical from the attitude before to each, in the earth frame, deg, shape (n,), 0 first."""
    before = np.roll(quaternions, 1, axis=0)
    w, x, y, z = quaternions.T
    bw, bx, by, bz = before.T
    turn_w = w * bw + x * bx + y * by + z * bz
    turn_z = -w * bz - x * by + y * bx + z * bw
    sign = np.where(turn_w < 0.0, -1.0, 1.0)
    turn_deg: Floats = np.rad2deg(2.0 * np.arctan2(sign * turn_z, np.abs(turn_w)))
    turn_deg[0] = 0.0
    return turn_deg
