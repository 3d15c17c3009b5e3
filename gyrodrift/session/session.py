"""A recorded session as arrays."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gyrodrift.arrays import Floats, Integers
from gyrodrift.result_table import ResultTable
from gyrodrift.session.damage import RecordingDamage

TABLE = "table"
"""Name of the metadata table about how a table of another program was read."""


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
    remarks
        Notes for the user about how it was read, a sentence each.
    metadata
        Named tables beside the samples: device, host, note; empty if the format has none.
    rate_scale, time_unit
        Units in the file before conversion: deg/s per unit of the rates, and s, ms, us or ns for device times.
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

    def __repr__(self) -> str:
        seconds = float(self.t_device_s[-1] - self.t_device_s[0])
        return f"Session({self.name!r}, {len(self.t_device_s)} samples, {seconds:.1f} s)"

    def columns(self) -> dict[str, Any]:
        """Arrays of the session by name; without the columns that it lacks."""
        names = ("t_device_s", "rate_dps", "t_host_s", "seq", "encoder_deg", "temp_c", "still")
        return {name: column for name in names if (column := getattr(self, name)) is not None}

    def part(self, start: int, end: int) -> "Session":
        """The samples from `start` to before `end`."""
        return self.rows(slice(start, end))

    def rows(self, rows: slice | Integers) -> "Session":
        """The samples at some indices."""
        return Session(
            name=self.name,
            t_device_s=self.t_device_s[rows],
            rate_dps=self.rate_dps[rows],
            t_host_s=None if self.t_host_s is None else self.t_host_s[rows],
            seq=None if self.seq is None else self.seq[rows],
            encoder_deg=None if self.encoder_deg is None else self.encoder_deg[rows],
            temp_c=None if self.temp_c is None else self.temp_c[rows],
            still=None if self.still is None else self.still[rows],
            metadata=self.metadata,
            remarks=self.remarks,
            rate_scale=self.rate_scale,
            time_unit=self.time_unit,
        )
