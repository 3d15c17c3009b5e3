"""The attitude filter over a whole session."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.evaluation.auxiliary import Auxiliary, InertialColumns
from gyrodrift.filters.filter import FilterParams
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.filters.run import FilterRun
from gyrodrift.values.arrays import Floats
from gyrodrift.values.sample import Inertial


@dataclass(frozen=True, slots=True)
class AttitudeHistory:
    """Results at each sample, shape (n,).

    yaw_deg, yaw_sigma_deg
        Yaw and its standard deviation, deg.
    heading_rate_dps
        Rate of the heading by the measured rates, deg/s.
    """

    yaw_deg: Floats
    yaw_sigma_deg: Floats
    heading_rate_dps: Floats


def attitude_history(
    t_s: Floats, axes: InertialColumns, auxiliary: Auxiliary, params: FilterParams | None = None
) -> AttitudeHistory:
    """Run the attitude filter with these parameters of restlevel, or with its defaults, over accepted samples."""
    run = FilterRun(RESTLEVEL, RESTLEVEL.params() if params is None else params, "3")
    filled, history = auxiliary.filled(len(t_s)), np.empty((3, len(t_s)))
    samples = zip(
        t_s.tolist(),
        axes.gyro_dps.tolist(),
        axes.accel_mps2.tolist(),
        filled.still.tolist(),
        filled.temp_c.tolist(),
        strict=True,
    )
    for row, (t, gyro_dps, accel_mps2, still, temp_c) in enumerate(samples):
        run.step(t, gyro_dps[2], Inertial(*gyro_dps, *accel_mps2), still, temp_c)
        state = run.state
        history[:, row] = state.yaw_deg, state.yaw_sigma_deg, state.heading_rate_dps
    return AttitudeHistory(*history)
