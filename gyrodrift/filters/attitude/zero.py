"""Restart of the yaw sigma: yaw turned before is the same in all hypotheses by definition."""

import numpy as np

from gyrodrift.filters.attitude.batch import from_rotation_vectors, products, unit
from gyrodrift.filters.attitude.hypotheses import HEADING
from gyrodrift.filters.attitude.model import AttitudeState


def zero_yaw(s: AttitudeState) -> None:
    """Give all hypotheses the heading of the output, without variance; yaw itself stays.

    The hypotheses are those of the block's beginning. Their yaw since then differs by less than 0.1 s of their biases.
    """
    if s.samples == 0:
        return
    h = s.hypotheses
    turns = np.zeros((len(h.weight), 3))
    turns[:, HEADING] = np.radians(s.start_yaw_deg - h.yaw_deg)
    h.q = unit(products(from_rotation_vectors(turns), h.q))
    h.yaw_deg = np.full(len(h.weight), s.start_yaw_deg)
    h.cov[:, HEADING, :] = 0.0
    h.cov[:, :, HEADING] = 0.0
    s.yaw_sigma_deg = 0.0
