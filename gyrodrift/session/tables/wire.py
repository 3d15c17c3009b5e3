"""Lines of the csv protocol captured by another program: `t_us,rate_dps[,encoder_deg[,temp_c[,still]]]`, no header.

With three axes: `t_us,gx,gy,gz,ax,ay,az[,encoder_deg[,temp_c[,still]]]`. Two to ten numbers may mean anything. A table
is read this way only if all columns are plausible.
"""

import numpy as np

from gyrodrift.columns.sizes import MEDIAN_ACCEL_MPS2, TEMPERATURES_C
from gyrodrift.session.session import ACCEL_COLUMNS
from gyrodrift.session.tables.plan import Head, TableColumns, UsedColumn
from gyrodrift.values.arrays import Floats
from gyrodrift.values.constants import FULL_TURN_DEG

FORM = "csv protocol of gyrodrift"
TARGETS = ("t_device_s", "rate_dps", "encoder_deg", "temp_c", "still")
AXES_TARGETS = ("t_device_s", "gyro_x_dps", "gyro_y_dps", "rate_dps", *ACCEL_COLUMNS, *TARGETS[2:])

LEAST_AXES, AXES_INDICES = 7, (1, 2, 4, 5, 6)
"""Least number of columns with three axes, and the indices of all of them but the yaw rate."""

STEP_US = (50.0, 1e6)
"""Time between samples of a gyro that a sketch prints: 20 kHz to 1 Hz."""

MOST_DPS = 4000.0
LEAST_ROWS = 10
MOST = 2.0**63
"""Limit of the numbers in the first columns."""

SHARE = 0.5
"""Largest share of the encoder motion that the integrated rate may fail to explain."""

LEVEL_DPS = 2.0
"""Largest change of the bias within some minutes (data sheets: less than 1 deg/s from -40 to 85 °C)."""

SMOOTH = 0.9
"""Correlation of neighboring samples: about 0 for the noise of a rate at rest, nearly 1 for an angle."""


def wire_columns(head: Head) -> TableColumns | None:
    """Columns of such lines; None if the table is something else."""
    has_axes = head.width >= LEAST_AXES
    targets = AXES_TARGETS if has_axes else TARGETS
    if head.labels or not 2 <= head.width <= len(targets) or head.width == len(TARGETS) + 1:
        return None
    try:
        table = np.array([[float(cell) for cell in row] for row in head.rows])
    except ValueError:
        return None
    single = np.delete(table, AXES_INDICES, axis=1) if has_axes else table
    if len(table) < LEAST_ROWS or not (np.abs(single[:, :3]) < MOST).all() or not _is_plausible(single):
        return None
    if has_axes and not _is_gravity(table[:, 4:LEAST_AXES]):
        return None
    used = [
        UsedColumn(index, target, unit="" if index else "t_us") for index, target in enumerate(targets[: head.width])
    ]
    remark = "it has no header; its numbers are plausible as t_us, rate in deg/s of gyrodrift's csv protocol"
    return TableColumns(FORM, tuple(used), remarks=(remark,))


def _is_gravity(forces: Floats) -> bool:
    """Whether the median length of the accelerations, shape (n, 3), is gravity in m/s²."""
    length = float(np.median(np.linalg.norm(forces, axis=1)))
    return MEDIAN_ACCEL_MPS2[0] < length < MEDIAN_ACCEL_MPS2[1]


def _is_plausible(table: Floats) -> bool:
    steps_us = np.diff(table[:, 0])
    is_clock = bool((table[:, 0] % 1.0 == 0.0).all() and (steps_us > 0.0).all())
    is_steady = STEP_US[0] <= float(np.median(steps_us)) <= STEP_US[1]
    return is_clock and is_steady and _is_rate(table) and _is_rest(table)


def _is_rate(table: Floats) -> bool:
    """Whether column 2 is a rate: no integer counts and, without an encoder, no angle, which is smooth at rest."""
    rate_dps = table[:, 1]
    if (rate_dps % 1.0 == 0.0).all() or not rate_dps.std() or not (np.abs(rate_dps) <= MOST_DPS).all():
        return False
    if table.shape[1] > 2:
        return _turns(table)
    quiet = _quiet(rate_dps)
    return bool(quiet) and not _is_smooth(min(quiet, key=np.ptp)) and _is_level(quiet[0], quiet[-1])


def _quiet(values: Floats) -> list[Floats]:
    """Parts that move little, in order of time."""
    size = max(LEAST_ROWS, len(values) // 16)
    parts = [values[start : start + size] for start in range(0, len(values) - size + 1, size)]
    spans = [float(np.ptp(part)) for part in parts]
    least = min((span for span in spans if span), default=0.0)
    return [part for part, span in zip(parts, spans, strict=True) if 0.0 < span <= 2.0 * least]


def _is_smooth(part: Floats) -> bool:
    return abs(float(np.corrcoef(part[1:], part[:-1])[0, 1])) >= SMOOTH


def _is_level(first: Floats, last: Floats) -> bool:
    """Whether the level returns: a rate does at rest, an angle stays turned."""
    return abs(float(np.median(last) - np.median(first))) <= max(LEVEL_DPS, float(np.ptp(first)))


def _turns(table: Floats) -> bool:
    """Whether the integrated rate follows the encoder; if the encoder stands still, whether the rate does too."""
    steps_deg = (np.diff(table[:, 2]) + 0.5 * FULL_TURN_DEG) % FULL_TURN_DEG - 0.5 * FULL_TURN_DEG
    expected_deg = table[1:, 1] * np.diff(table[:, 0]) * 1e-6
    moved_deg = float(np.ptp(np.cumsum(steps_deg)))
    if moved_deg == 0.0:
        return float(np.ptp(np.cumsum(expected_deg - np.median(expected_deg)))) < 1.0
    residuals_deg = np.cumsum(steps_deg - expected_deg)
    return (
        float(np.ptp(residuals_deg - np.linspace(residuals_deg[0], residuals_deg[-1], len(residuals_deg))))
        <= SHARE * moved_deg
    )


def _is_rest(table: Floats) -> bool:
    temp_c = table[:, 3] if table.shape[1] > 3 else np.empty(0)
    still = table[:, 4] if table.shape[1] > 4 else np.empty(0)
    is_warm = bool(((temp_c >= TEMPERATURES_C[0]) & (temp_c <= TEMPERATURES_C[1]) | np.isnan(temp_c)).all())
    return is_warm and bool((np.isin(still, (0.0, 1.0)) | np.isnan(still)).all())
