"""Lines of the csv protocol captured by another program: `t_us,rate_dps[,encoder_deg[,temp_c[,still]]]`, no header.

With three axes: `t_us,gx,gy,gz,ax,ay,az[,encoder_deg[,temp_c[,still]]]`. Two to ten numbers may mean anything. A table
is read this way only if its first rows have the shape that is needed at a port, too; `examine` judges all rows.
"""

from itertools import pairwise
from math import isnan, nan
from statistics import median

from gyrodrift.columns.csv_line import LEAST_AXES, csv_reading
from gyrodrift.columns.shape import RateShape, has_csv_shape
from gyrodrift.columns.sizes import SAMPLE_RATES_HZ
from gyrodrift.session.session import ACCEL_COLUMNS
from gyrodrift.session.tables.plan import Head, TableColumns, UsedColumn
from gyrodrift.values.sample import Sample

FORM = "csv protocol of gyrodrift"
TARGETS = ("t_device_s", "rate_dps", "encoder_deg", "temp_c", "still")
AXES_TARGETS = ("t_device_s", "gyro_x_dps", "gyro_y_dps", "rate_dps", *ACCEL_COLUMNS, *TARGETS[2:])

MOST_US = 2.0**63


def wire_columns(head: Head) -> TableColumns | None:
    """Columns of such lines; None if the table is something else."""
    targets = AXES_TARGETS if head.width >= LEAST_AXES else TARGETS
    if head.labels or not 2 <= head.width <= len(targets) or head.width == len(TARGETS) + 1:
        return None
    try:
        rows = [[float(cell) for cell in row] for row in head.rows]
    except ValueError:
        return None
    times_us = [row[0] for row in rows]
    steps_us = [after - before for before, after in pairwise(times_us)]
    if not all(0.0 <= t_us < MOST_US and t_us % 1.0 == 0.0 for t_us in times_us) or len(steps_us) < 1:
        return None
    readings = [csv_reading(int(t_us), values) for t_us, *values in rows]
    is_steady = min(steps_us) > 0.0 and SAMPLE_RATES_HZ[0] <= 1e6 / median(steps_us) <= SAMPLE_RATES_HZ[1]
    is_still = all(isnan(reading.still) or reading.still in (0.0, 1.0) for reading in readings)
    if not (is_steady and is_still and has_csv_shape(readings)):
        return None
    samples = [
        Sample(-1, 1e-6 * t_us, nan, *reading[2:6], reading.inertial)
        for t_us, reading in zip(times_us, readings, strict=True)
    ]
    shape = RateShape()
    shape.take(samples)
    if shape.contradiction or shape.is_smooth:
        return None
    used = [
        UsedColumn(index, target, unit="" if index else "t_us") for index, target in enumerate(targets[: head.width])
    ]
    remark = "it has no header; its numbers are plausible as t_us, rate in deg/s of gyrodrift's csv protocol"
    return TableColumns(FORM, tuple(used), remarks=(remark,))
