"""Recordings of cheap six-axis parts in simulated motions, and the errors of an estimate.

`six_axis_motions` has the motions, and `six_axis_sensors` the physics and the errors of the parts.
"""

import numpy as np
from scipy.spatial.transform import Rotation
from six_axis_motions import MOTIONS
from six_axis_sensors import Recorded, measure, random_errors

from gyrodrift.values.arrays import Floats


def record(name: str, seed: int, seconds: float = 90.0) -> Recorded:
    """A recording of a motion with the errors of a random part."""
    rng = np.random.default_rng((seed, list(MOTIONS).index(name)))
    motion = MOTIONS[name](rng, seconds)
    return measure(motion, random_errors(rng), rng)


JUMP_DEG = 60.0
"""Change of the error between two samples that is another hypothesis, not a drift."""


def heading_errors_deg(q: Floats, attitude: Rotation) -> Floats:
    """Heading errors (n) of attitudes (n, 4), w first, from the first sample on.

    A drift may exceed half a turn. After a jump the error is within half a turn again.
    """
    error = (Rotation.from_quat(q, scalar_first=True) * attitude.inv()).as_quat(scalar_first=True)
    twist = np.degrees(np.unwrap(2.0 * np.arctan2(error[:, 3], error[:, 0])))
    twist -= twist[0]
    for index in np.flatnonzero(np.abs(np.diff(twist)) > JUMP_DEG) + 1:
        twist[index:] -= 360.0 * np.round(twist[index] / 360.0)
    return np.asarray(twist)


def inclination_errors_deg(q: Floats, attitude: Rotation) -> Floats:
    """Angles (n) between estimated and true vertical."""
    error = (Rotation.from_quat(q, scalar_first=True) * attitude.inv()).apply((0.0, 0.0, 1.0))
    return np.asarray(np.degrees(np.arccos(np.clip(error[:, 2], -1.0, 1.0))))
