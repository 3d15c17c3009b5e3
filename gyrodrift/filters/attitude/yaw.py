"""Unwrapped heading of attitudes."""

import numpy as np

from gyrodrift.filters.attitude.hypotheses import Hypotheses
from gyrodrift.values.quaternion import Quaternion, heading_deg

INVERTED = 0.06698729810778066
"""w² + z² of an attitude below which the tilt is above 150°, where the twist turns fast. Derived: cos²(75°)."""


def unwrapped_deg(expected_deg: float, q: Quaternion) -> float:
    """Heading of q that is next to the expected one; the expected one itself above 150° of tilt."""
    w, _, _, z = q
    if w * w + z * z < INVERTED:
        return expected_deg
    twist = heading_deg(*q)
    return twist + 360.0 * round((expected_deg - twist) / 360.0)


def unwrap_headings(h: Hypotheses) -> None:
    """Headings of all hypotheses next to the expected ones in `yaw_deg`."""
    pairs = zip(h.yaw_deg.tolist(), h.q.tolist(), strict=True)
    h.yaw_deg = np.array([unwrapped_deg(expected_deg, tuple(q)) for expected_deg, q in pairs])
