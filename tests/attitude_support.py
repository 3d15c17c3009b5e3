"""The attitude filter over a whole recording."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import NamedTuple

import numpy as np
from six_axis_sensors import Recorded

from gyrodrift.filters.attitude.model import AttitudeState, coefficients
from gyrodrift.filters.attitude.step import step
from gyrodrift.filters.restlevel.memory import AxisMemory, RestlevelMemory, begun
from gyrodrift.filters.restlevel.model import RestlevelParams
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.filters.three_axes import three_axis_version
from gyrodrift.values.arrays import Floats
from gyrodrift.values.mount import LEVEL


class Filtered(NamedTuple):
    """Attitudes and standard deviations at each sample."""

    q: Floats
    yaw_deg: Floats
    yaw_sigma_deg: Floats


def remembering(bias_dps: Sequence[float], sigma_dps: Sequence[float], age_s: float) -> AttitudeState:
    """State of a filter that begins with the biases of x, y and z of an earlier run."""
    x, y, z = (AxisMemory(*pair, None, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0) for pair in zip(bias_dps, sigma_dps, strict=True))
    memory = RestlevelMemory(**asdict(z), x=x, y=y)
    state: AttitudeState = three_axis_version(RESTLEVEL).state(begun(RestlevelParams(), memory, age_s, None), LEVEL)
    return state


def filtered(recorded: Recorded, state: AttitudeState | None = None, temp_c: Floats | None = None) -> Filtered:
    c, s = coefficients(RestlevelParams()), state or AttitudeState()
    temps = np.full(len(recorded.t_s), np.nan) if temp_c is None else temp_c
    rows, sigmas, yaws = [], [], []
    columns = (recorded.t_s, recorded.gyro_dps, recorded.accel_mps2, temps)
    for t_s, (gx, gy, gz), (ax, ay, az), warm_c in zip(*(column.tolist() for column in columns), strict=True):
        step(c, s, t_s, gx, gy, gz, ax, ay, az, temp_c=warm_c)
        rows.append(s.q)
        yaws.append(s.yaw_deg)
        sigmas.append(s.yaw_sigma_deg)
    return Filtered(np.array(rows), np.array(yaws), np.array(sigmas))
