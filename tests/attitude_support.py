"""The attitude filter over a whole recording."""

from typing import NamedTuple

import numpy as np
from six_axis_sensors import Recorded

from gyrodrift.filters.attitude.model import AttitudeState, coefficients
from gyrodrift.filters.attitude.step import step
from gyrodrift.filters.restlevel.model import RestlevelParams
from gyrodrift.values.arrays import Floats


class Filtered(NamedTuple):
    """Attitudes and standard deviations at each sample."""

    q: Floats
    yaw_deg: Floats
    yaw_sigma_deg: Floats


def filtered(recorded: Recorded) -> Filtered:
    c, s = coefficients(RestlevelParams()), AttitudeState()
    rows, sigmas, yaws = [], [], []
    columns = zip(recorded.t_s.tolist(), recorded.gyro_dps.tolist(), recorded.accel_mps2.tolist(), strict=True)
    for t_s, gyro, accel in columns:
        step(c, s, t_s, *gyro, *accel)
        rows.append(s.q)
        yaws.append(s.yaw_deg)
        sigmas.append(s.yaw_sigma_deg)
    return Filtered(np.array(rows), np.array(yaws), np.array(sigmas))
