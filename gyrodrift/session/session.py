"""A recorded session as arrays."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import isnan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gyrodrift.io.result_table import ResultTable
from gyrodrift.session.aids import RowAids
from gyrodrift.session.damage import RecordingDamage
from gyrodrift.values.aid import Aid
from gyrodrift.values.arrays import Floats, Integers, Mask
from gyrodrift.values.constants import FULL_TURN_DEG
from gyrodrift.values.sample import NO_AXES, NO_YAW, DeviceYaw, Inertial, Sample

TABLE = "table"
"""Name of the metadata table about how a table of another program was read."""

GYRO_COLUMNS = ("gyro_x_dps", "gyro_y_dps", "gyro_z_dps")
ACCEL_COLUMNS = ("accel_x_mps2", "accel_y_mps2", "accel_z_mps2")
DEVICE_COLUMNS = ("device_yaw_deg", "device_yaw_sigma_deg", "device_bias_dps")
"""Columns of a device that runs a filter itself."""

SAMPLE_COLUMNS = ("t_device_s", "t_host_s", "seq", "rate_dps", "encoder_deg", "temp_c", "still")
COLUMNS = (*SAMPLE_COLUMNS, *GYRO_COLUMNS, *ACCEL_COLUMNS, *DEVICE_COLUMNS)
"""Columns of a session in a file, in this order."""

AXIS_COLUMNS = {
    name: (array, index)
    for array, names in (("gyro_dps", GYRO_COLUMNS), ("accel_mps2", ACCEL_COLUMNS))
    for index, name in enumerate(names)
}
"""Array and index of the axis, by the name of the column in a file."""

UPSIDE_DOWN = np.array([1.0, -1.0, -1.0])
"""Factors of x, y and z in a frame that is turned by 180° about x."""

FilterSample = tuple[float, float, Inertial | None, float, float]
"""Time in s, rate in deg/s, axes, still flag, and temperature in °C, as a filter takes them."""

ARRAYS = ("t_device_s", "rate_dps", "t_host_s", "seq", "encoder_deg", "temp_c", "still", *DEVICE_COLUMNS)
"""Arrays of a session of shape (n,)."""


@dataclass(frozen=True, slots=True, repr=False)
class Session(ResultTable):
    """A recording of a device in order of arrival; every array has the shape (n,), n ≥ 1.

    name
        Name of the file, without its folder and ending.
    t_device_s
        Device clock, s.
    rate_dps
        Measured yaw rate, deg/s.
    t_host_s, seq, encoder_deg, temp_c
        Arrival time in s, counter, reference angle in deg, temperature in °C; None without the column.
        Single missing values are NaN (−1 in `seq`).
    still
        1 if another source than the rate says that the device is at rest, 0 if it moves; None without the column.
    gyro_dps, accel_mps2
        Rates in deg/s and specific forces in m/s² about x, y and z of the sensor (see `sample.Inertial`), shape (n, 3);
        None without the columns. Missing values are NaN. `rate_dps` is then the rate about z.
    device_yaw_deg, device_yaw_sigma_deg, device_bias_dps
        Result of a filter that the device runs itself: yaw and its standard deviation in deg, estimated drift in deg/s.
        None without the columns; NaN for samples without a result. The zero of the yaw is that of the device.
    remarks
        Notes for the user about how it was read, a sentence each.
    metadata
        Named tables beside the samples: device, host, note; empty if the format has none.
    rate_scale, accel_scale, time_unit
        Units in the file before conversion: deg/s per unit of the rates, m/s² per unit of the accelerations, and s, ms,
        us or ns for device times.
    restarts_s
        Device times of the samples at which the device or its clock had restarted, on the clock of the session.
    aids
        Measurements of second sources, each with the index of the sample that it came with; None without the column.
    damage
        Lost samples, if the file is damaged and was read with `allow_damage`.
    """

    name: str
    t_device_s: Floats
    rate_dps: Floats
    t_host_s: Floats | None = None
    seq: NDArray[np.int64] | None = None
    encoder_deg: Floats | None = None
    temp_c: Floats | None = None
    metadata: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    still: Floats | None = None
    damage: RecordingDamage | None = None
    remarks: tuple[str, ...] = ()
    rate_scale: float = 1.0
    time_unit: str = "s"
    gyro_dps: Floats | None = None
    accel_mps2: Floats | None = None
    accel_scale: float = 1.0
    device_yaw_deg: Floats | None = None
    device_yaw_sigma_deg: Floats | None = None
    device_bias_dps: Floats | None = None
    restarts_s: tuple[float, ...] = ()
    aids: RowAids | None = None

    def __repr__(self) -> str:
        seconds = float(self.t_device_s[-1] - self.t_device_s[0])
        return f"Session({self.name!r}, {len(self.t_device_s)} samples, {seconds:.1f} s)"

    def columns(self) -> dict[str, Any]:
        """Arrays of the session by name; without the columns that it lacks."""
        names = (*ARRAYS[: -len(DEVICE_COLUMNS)], *AXIS_COLUMNS, *DEVICE_COLUMNS)
        return {name: column for name in names if (column := self.column(name)) is not None}

    def column(self, name: str) -> NDArray[Any] | None:
        """Column of a file by name, shape (n,); an axis is a column, such as `gyro_x_dps`."""
        array, index = AXIS_COLUMNS.get(name, (name, None))
        values: NDArray[Any] | None = getattr(self, array)
        return values if values is None or index is None else values[:, index]

    def filled(self, name: str) -> NDArray[Any]:
        """Column of a file by name, shape (n,); NaN (−1 in `seq`) without the column."""
        column = self.column(name)
        return np.full(len(self.rate_dps), -1 if name == "seq" else np.nan) if column is None else column

    def inertials(self) -> Sequence[Inertial | None]:
        """The axes of each sample; None for a session of one axis, and for samples without three rates."""
        if self.gyro_dps is None:
            return [None] * len(self.rate_dps)
        columns = [self.filled(name).tolist() for name in AXIS_COLUMNS]
        return [None if isnan(sum(values[:3])) else Inertial(*values) for values in zip(*columns, strict=True)]

    def filter_samples(self) -> Iterator[FilterSample]:
        """The samples as a filter takes them; NaN for a missing column."""
        names = ("t_device_s", "rate_dps", "still", "temp_c")
        t_s, rate_dps, still, temp_c = (self.filled(name).tolist() for name in names)
        return zip(t_s, rate_dps, self.inertials(), still, temp_c, strict=True)

    def part(self, start: int, end: int) -> "Session":
        """The samples from `start` to before `end`."""
        return self.rows(slice(start, end))

    def rows(self, rows: slice | Integers) -> "Session":
        """The samples at some indices."""
        arrays = {name: getattr(self, name) for name in (*ARRAYS, "gyro_dps", "accel_mps2")}
        present = {name: array[rows] for name, array in arrays.items() if array is not None}
        aids = None if self.aids is None else aids_of_rows(self.aids, rows, len(self.rate_dps))
        return replace(self, damage=None, aids=aids, **present)

    def timed(self, t_device_s: Floats) -> "Session":
        """The session with other times of its samples, shape (n,), s."""
        aids = self.aids and shifted_aids(self.aids, self.t_device_s, t_device_s)
        return replace(self, t_device_s=t_device_s, aids=aids)

    def scaled(self, factor: float) -> "Session":
        """The session with all rates times a factor."""
        gyro_dps = None if self.gyro_dps is None else self.gyro_dps * factor
        return self if factor == 1.0 else replace(self, rate_dps=self.rate_dps * factor, gyro_dps=gyro_dps)

    def upside_down(self) -> "Session":
        """The session in a frame that is turned by 180° about x: y, z, yaw rate and device's yaw change sign."""
        gyro_dps, accel_mps2 = (
            None if array is None else array * UPSIDE_DOWN for array in (self.gyro_dps, self.accel_mps2)
        )
        device_yaw_deg, device_bias_dps = (
            None if array is None else -array for array in (self.device_yaw_deg, self.device_bias_dps)
        )
        return replace(
            self,
            rate_dps=-self.rate_dps,
            gyro_dps=gyro_dps,
            accel_mps2=accel_mps2,
            device_yaw_deg=device_yaw_deg,
            device_bias_dps=device_bias_dps,
        )

    def with_yaw_rate(self, rate_dps: Floats) -> "Session":
        """The session with other rates about z, shape (n,), deg/s."""
        if self.gyro_dps is None:
            return replace(self, rate_dps=rate_dps)
        return replace(self, rate_dps=rate_dps, gyro_dps=np.column_stack([self.gyro_dps[:, :2], rate_dps]))

    def without_rates(self, is_missing: Mask) -> "Session":
        """The session without the rates of some samples, shape (n,)."""
        if not is_missing.any():
            return self
        gyro_dps = None if self.gyro_dps is None else np.where(is_missing[:, None], np.nan, self.gyro_dps)
        return replace(self, rate_dps=np.where(is_missing, np.nan, self.rate_dps), gyro_dps=gyro_dps)

    def with_axes(self, columns: Mapping[str, Floats | None]) -> "Session":
        """The session with three axes from columns by name; without them unless rates about x and y are given.

        Without `gyro_z_dps` the yaw rate is the rate about z. A driver of a single-axis gyro fills the messages of
        three axes with zeros: such axes count as missing.
        """
        z_dps = columns.get("gyro_z_dps")
        rates = {**columns, "gyro_z_dps": self.rate_dps if z_dps is None else z_dps}
        gyro_dps, accel_mps2 = stacked(rates, GYRO_COLUMNS), stacked(columns, ACCEL_COLUMNS)
        accel_mps2 = None if accel_mps2 is None or not accel_mps2.any() else accel_mps2
        if gyro_dps is None or (accel_mps2 is None and not gyro_dps[:, :2].any()):
            return self
        return replace(self, gyro_dps=gyro_dps, accel_mps2=accel_mps2)

    def with_device_yaw(self, columns: Mapping[str, Floats | None]) -> "Session":
        """The session with the results of the device's own filter, from columns by name; without any yaw as it is."""
        yaw_deg = columns.get("device_yaw_deg")
        if yaw_deg is None or np.isnan(yaw_deg).all():
            return self
        sigma_deg, bias_dps = columns.get("device_yaw_sigma_deg"), columns.get("device_bias_dps")
        return replace(self, device_yaw_deg=yaw_deg, device_yaw_sigma_deg=sigma_deg, device_bias_dps=bias_dps)


def stacked(columns: Mapping[str, Floats | None], names: Sequence[str]) -> Floats | None:
    """Columns side by side, shape (n, 3); None if a column is missing, or without any number."""
    present = [column for name in names if (column := columns.get(name)) is not None]
    if len(present) < len(names):
        return None
    array: Floats = np.column_stack(present)
    return None if np.isnan(array).all() else array


def session_of(name: str, samples: Sequence[Sample]) -> Session:
    """Session from samples, without the columns that they lack."""
    *numbers, axes, device_yaws, aids = zip(*samples, strict=True)
    columns = dict(zip(Sample._fields, map(np.array, numbers), strict=False))
    for optional in ("encoder_deg", "temp_c", "still"):
        if np.isnan(columns[optional]).all():
            del columns[optional]
    further = {**axis_columns(axes), **device_columns(device_yaws)}
    return session_of_columns(name, {**columns, **further}, aids=row_aids(aids))


def row_aids(aids: Iterable[Sequence[Aid]]) -> RowAids | None:
    """Measurements of second sources with the indices of their samples; None without any."""
    return tuple((row, aid) for row, of_sample in enumerate(aids) for aid in of_sample) or None


def session_of_columns(name: str, columns: Mapping[str, NDArray[Any] | None], **fields: Any) -> Session:
    """Session from columns by their names in a file; `fields` are fields that are no columns, such as `remarks`."""
    arrays = {column: columns.get(column) for column in SAMPLE_COLUMNS}
    return Session(name, **arrays, **fields).with_axes(columns).with_device_yaw(columns)  # type: ignore[arg-type]


def axis_columns(axes: Sequence[Inertial | None]) -> dict[str, Floats | None]:
    """Columns of the axes of samples, by name; NaN where a sample has none, empty without any."""
    if not any(inertial is not None for inertial in axes):
        return {}
    table = np.array([NO_AXES if inertial is None else inertial for inertial in axes], dtype=np.float64)
    return dict(zip(AXIS_COLUMNS, table.T, strict=True))


def device_columns(device_yaws: Sequence[DeviceYaw | None]) -> dict[str, Floats | None]:
    """Columns of the device's own filter, by name; NaN where a sample has none, empty without any."""
    if not any(device_yaw is not None for device_yaw in device_yaws):
        return {}
    table = np.array([device_yaw or NO_YAW for device_yaw in device_yaws], dtype=np.float64)
    return dict(zip(DEVICE_COLUMNS, table.T, strict=True))


def aids_of_rows(aids: RowAids, rows: slice | Integers, count: int) -> RowAids:
    """Measurements of some samples of `count`; those of a sample that is left out come with the next one."""
    kept = np.arange(count)[rows]
    order = np.argsort(kept, kind="stable")
    indices = np.searchsorted(kept[order], [row for row, _ in aids])
    first, last = (int(kept.min()), int(kept.max())) if len(kept) else (0, -1)
    pairs = zip(aids, indices.tolist(), strict=True)
    return tuple((int(order[index]), aid) for (row, aid), index in pairs if first <= row <= last)


def shifted_aids(aids: RowAids, before_s: Floats, after_s: Floats) -> RowAids:
    """Measurements on another clock, which gives their samples the times `after_s`, shape (n,)."""
    return tuple((row, aid._replace(t_s=float(aid.t_s + after_s[row] - before_s[row]))) for row, aid in aids)


def unwrapped(angle_deg: Floats) -> Floats:
    """Unwrap an angle in deg that was recorded from 0 to 360 or from −180 to 180; other angles stay."""
    is_finite = np.isfinite(angle_deg)
    angles = angle_deg[is_finite]
    if not len(angles) or np.ptp(angles) > FULL_TURN_DEG or not np.any(np.abs(np.diff(angles)) > FULL_TURN_DEG / 2.0):
        return angle_deg
    result = angle_deg.copy()
    result[is_finite] = np.unwrap(angles, period=FULL_TURN_DEG)
    return result
