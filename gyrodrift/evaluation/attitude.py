"""The filter over a whole session: on three axes, or with second sources."""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import repeat

import numpy as np

from gyrodrift.evaluation.auxiliary import Auxiliary, InertialColumns
from gyrodrift.filters.filter import FilterParams
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.filters.run import FilterRun
from gyrodrift.session.aids import RowAids, aids_by_row
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
    t_s: Floats,
    axes: InertialColumns,
    auxiliary: Auxiliary,
) -> AttitudeHistory:
    """Run the attitude filter with the defaults of restlevel over accepted samples."""
    return filter_history(t_s, axes.gyro_dps[:, 2], axes, auxiliary)


def filter_history(
    t_s: Floats,
    rate_dps: Floats,
    axes: InertialColumns | None,
    auxiliary: Auxiliary,
    params: FilterParams | None = None,
    aids: RowAids | None = None,
) -> AttitudeHistory:
    """Run restlevel on one axis or on three over accepted samples, with what second sources measured."""
    chosen = RESTLEVEL.params() if params is None else params
    run = FilterRun(RESTLEVEL, chosen, "1" if axes is None else "3")
    filled, history, by_row = auxiliary.filled(len(t_s)), np.empty((3, len(t_s))), aids_by_row(aids or ())
    columns = (
        t_s.tolist(),
        rate_dps.tolist(),
        _inertials(axes, len(t_s)),
        filled.still.tolist(),
        filled.temp_c.tolist(),
    )
    for row, sample in enumerate(zip(*columns, strict=True)):
        run.step(sample[0], sample[1], sample[2], sample[3], sample[4])
        for aid in by_row.get(row, ()):
            run.aid(aid)
        state = run.state
        history[:, row] = state.yaw_deg, state.yaw_sigma_deg, sample[1] if axes is None else state.heading_rate_dps
    return AttitudeHistory(*history)


def _inertials(axes: InertialColumns | None, count: int) -> Iterable[Inertial | None]:
    """The axes of each sample; None for one axis."""
    if axes is None:
        return repeat(None, count)
    pairs = zip(axes.gyro_dps.tolist(), axes.accel_mps2.tolist(), strict=True)
    return (Inertial(*gyro_dps, *accel_mps2) for gyro_dps, accel_mps2 in pairs)
