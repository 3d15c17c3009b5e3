"""Blocks of measurements as arrays."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from firmware_sim.effects.effect import Floats

COUNTS_MAX = 32767
ACCEL_MISSING = -32768
"""Count of a missing acceleration; measured ones end at ±COUNTS_MAX."""

Row = tuple[int, int, float, int, bool, int, int, int]
"""Measurement as plain numbers, in the order of the arrays of a block."""


@dataclass(frozen=True, slots=True)
class Block:
    """Measurements in order; every array has the shape (n,).

    seq
        Counter from 0, not wrapped; lost samples leave gaps.
    t_device_us
        Device clock from 0, µs, not wrapped.
    t_host_s
        Arrival at the host, s after power-on, on the host clock.
    rate_raw, is_clipped
        Rate in counts, and whether it exceeded the range.
    temp_centi_c
        Temperature, hundredths of °C.
    encoder_counts
        Encoder counts, from the phase of the rig; zeros without an encoder.
    still
        Rest as the device reports it: 1 at rest, 0 in motion, −1 not reported.
    """

    seq: NDArray[np.int64]
    t_device_us: NDArray[np.int64]
    t_host_s: Floats
    rate_raw: NDArray[np.int16]
    is_clipped: NDArray[np.bool_]
    temp_centi_c: NDArray[np.int16]
    encoder_counts: NDArray[np.int64]
    still: NDArray[np.int8]

    def rows(self) -> Iterator[Row]:
        """Measurements as plain numbers, in the order of the arrays."""
        return zip(
            self.seq.tolist(),
            self.t_device_us.tolist(),
            self.t_host_s.tolist(),
            self.rate_raw.tolist(),
            self.is_clipped.tolist(),
            self.temp_centi_c.tolist(),
            self.encoder_counts.tolist(),
            self.still.tolist(),
            strict=True,
        )

    def only(self, kept: NDArray[np.bool_]) -> "Block":
        """Measurements for which `kept` is true."""
        return self.changed(lambda column: column[kept])

    def changed(self, change: Callable[[NDArray[Any]], NDArray[Any]]) -> "Block":
        """Measurements whose arrays went through a function, which sees the rows along the first axis."""
        columns: dict[str, Any] = {column.name: change(getattr(self, column.name)) for column in fields(self)}
        return replace(self, **columns)


@dataclass(frozen=True, slots=True)
class TriaxialBlock(Block):
    """Measurements of a device with three axes; `rate_raw` is the rate about z.

    gyro_xy_raw
        Rates about x and y in counts, shape (n, 2).
    accel_raw
        Acceleration in counts, shape (n, 3), ACCEL_MISSING where there is none; shape (n, 0) without accelerometer.
    accel_clipped
        Whether an acceleration exceeded the range, shape (n,).
    """

    gyro_xy_raw: NDArray[np.int16]
    accel_raw: NDArray[np.int16]
    accel_clipped: NDArray[np.bool_]

    def axes_rows(self) -> Iterator[tuple[list[int], list[int] | None, bool]]:
        """Rates about x, y and z, acceleration (None if missing), and whether it is clipped, as plain numbers."""
        gyro_raw = np.column_stack([self.gyro_xy_raw, self.rate_raw]).tolist()
        accel_raw = [row if row and ACCEL_MISSING not in row else None for row in self.accel_raw.tolist()]
        return zip(gyro_raw, accel_raw, self.accel_clipped.tolist(), strict=True)


def joined(first: Block, then: Block) -> Block:
    """Measurements of two blocks of one device, in one block."""
    columns: dict[str, Any] = {
        column.name: np.concatenate([getattr(first, column.name), getattr(then, column.name)])
        for column in fields(first)
    }
    return replace(first, **columns)


def in_counts(counts: Floats) -> NDArray[np.int16]:
    """Counts in the register of the device, in the shape of the argument."""
    return np.clip(counts, -COUNTS_MAX, COUNTS_MAX).astype(np.int16)


def accel_in_counts(accel_mps2: Floats, mps2_per_lsb: float) -> tuple[NDArray[np.int16], NDArray[np.bool_]]:
    """Accelerations in counts, shape (n, 3), and whether one exceeded the range, shape (n,).

    Without accelerometer the counts have the shape (n, 0).
    """
    if mps2_per_lsb == 0.0:
        return np.zeros((len(accel_mps2), 0), np.int16), np.zeros(len(accel_mps2), np.bool_)
    counts = np.rint(np.nan_to_num(accel_mps2) / mps2_per_lsb)
    raw = np.where(np.isnan(accel_mps2), np.int16(ACCEL_MISSING), in_counts(counts))
    return raw, np.any(np.abs(counts) > COUNTS_MAX, axis=1)
