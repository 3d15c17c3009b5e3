"""Faults of the device: measurements that are missing, wrong, or at a wrong time."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from firmware_sim.faults.fault import Fault, Lasting, Seconds
from firmware_sim.measure import COUNTS_MAX, Block, joined

SENSOR_COLUMNS = ("rate_raw", "is_clipped", "gyro_xy_raw", "accel_raw", "accel_clipped")
"""Columns of a block that the sensor measures; a device with one axis has the first two."""


class DoubleRate(Lasting):
    """The device samples at twice the rate of HELLO: firmware and configuration differ.

    An additional measurement is interpolated between every two.
    """

    fault: ClassVar[str] = "double_rate"

    def on_blocks(self, blocks: Iterator[Block]) -> Iterator[Block]:
        """Measurements with the interpolated ones, which are counted, too."""
        last: Block | None = None
        inserted = 0
        for block in blocks:
            if not len(block.seq):
                continue
            before = joined(last if last is not None else _row(block, 0), block)
            halfway = _halfway(before, block)
            has_one = self.is_on_at(halfway) & (np.diff(before.seq) == 1)
            counted = replace(block, seq=block.seq + inserted + np.cumsum(has_one))
            between = replace(halfway.only(has_one), seq=counted.seq[has_one] - 1)
            last, inserted = _row(block, -1), inserted + int(has_one.sum())
            yield _inserted(counted, between, np.flatnonzero(has_one))


class StuckValue(Lasting):
    """Rates and acceleration are constant: the sensor hangs, and the firmware does not check."""

    fault: ClassVar[str] = "stuck_value"

    def on_blocks(self, blocks: Iterator[Block]) -> Iterator[Block]:
        """Measurements with the last values before the fault, or with the first of all."""
        last: Block | None = None
        for block in blocks:
            if len(block.seq):
                stuck = self.is_on_at(block)
                free = np.flatnonzero(~stuck)
                before = free[block.t_host_s[free] < self.from_s]
                if len(before) or last is None:
                    last = _row(block, int(before[-1]) if len(before) else 0)
                yield _hung(block, last, stuck)


def _hung(block: Block, last: Block, stuck: NDArray[np.bool_]) -> Block:
    """Block whose sensor repeats the values of a row where it is stuck."""
    columns: dict[str, Any] = {}
    for name in SENSOR_COLUMNS:
        if (values := getattr(block, name, None)) is not None:
            where = stuck.reshape(-1, *[1] * (values.ndim - 1))
            columns[name] = np.where(where, getattr(last, name), values)
    return replace(block, **columns)


class FullScale(Lasting):
    """The rate is at full scale and marked as clipped: a broken sensor, or a turn beyond the range.

    sign
        1 for counter-clockwise, -1 for clockwise.
    """

    fault: ClassVar[str] = "full_scale"
    sign: Literal[1, -1] = 1

    def on_blocks(self, blocks: Iterator[Block]) -> Iterator[Block]:
        """Measurements at full scale, marked as clipped."""
        for block in blocks:
            on = self.is_on_at(block)
            raw = np.where(on, self.sign * COUNTS_MAX, block.rate_raw).astype(np.int16)
            yield replace(block, rate_raw=raw, is_clipped=block.is_clipped | on)


class RateChange(Fault):
    """The sample rate drops: a firmware that saves power, or has a new setting.

    divide
        Factor by which the rate drops; the counter has no gaps.
    """

    fault: ClassVar[str] = "rate_change"
    divide: Annotated[int, Field(ge=2, le=1000)] = 2

    def on_blocks(self, blocks: Iterator[Block]) -> Iterator[Block]:
        """Every `divide`-th measurement from `from_s` on."""
        first: int | None = None
        for block in blocks:
            after = block.t_host_s >= self.from_s
            if first is None and after.any():
                first = int(block.seq[after][0])
            if first is None:
                yield block
                continue
            passed = block.seq - first
            taken = block.only(~after | (passed % self.divide == 0))
            passed = taken.seq - first
            yield replace(taken, seq=np.where(passed > 0, first + passed // self.divide, taken.seq))


class ClockStep(Fault):
    """The device clock jumps: firmware that sets it from a host, or counts overflows wrongly.

    step_s
        Step, s; negative for backward.
    """

    fault: ClassVar[str] = "clock_step"
    step_s: Annotated[float, Field(ge=-1e6, le=1e6)] = 30.0

    def on_blocks(self, blocks: Iterator[Block]) -> Iterator[Block]:
        """Measurements with shifted time stamps."""
        for block in blocks:
            step_us = np.where(block.t_host_s >= self.from_s, round(self.step_s * 1e6), 0)
            yield replace(block, t_device_us=block.t_device_us + step_us)


class MillisecondClock(Fault):
    """The clock counts milliseconds: a sketch that prints `millis()` where `micros()` is expected."""

    fault: ClassVar[str] = "millisecond_clock"
    from_s: Seconds = 0.0

    def on_blocks(self, blocks: Iterator[Block]) -> Iterator[Block]:
        """Measurements with whole milliseconds as microseconds."""
        for block in blocks:
            has_it = block.t_host_s >= self.from_s
            yield replace(block, t_device_us=np.where(has_it, block.t_device_us // 1000, block.t_device_us))


class Reset(Fault):
    """The device boots again, after a brown-out, a watchdog or DTR: silence, then all counts from 0.

    silent_s
        Time without measurements, s.
    """

    fault: ClassVar[str] = "reset"
    silent_s: Annotated[float, Field(ge=0.0, le=1e6)] = 0.5

    def on_blocks(self, blocks: Iterator[Block]) -> Iterator[Block]:
        """Measurements whose counter, clock and encoder restart after the silence."""
        back_s = self.from_s + self.silent_s
        zero: Block | None = None
        for block in blocks:
            kept = block.only((block.t_host_s < self.from_s) | (block.t_host_s >= back_s))
            after = kept.t_host_s >= back_s
            if zero is None and after.any():
                zero = _row(kept, int(np.flatnonzero(after)[0]))
            if zero is None:
                yield kept
                continue
            yield replace(
                kept,
                seq=kept.seq - after * zero.seq[0],
                t_device_us=kept.t_device_us - after * zero.t_device_us[0],
                encoder_counts=kept.encoder_counts - after * zero.encoder_counts[0],
            )


def _row(block: Block, index: int) -> Block:
    """Block of one measurement."""
    return block.changed(lambda column: column[index:][:1])


def _halfway(before: Block, block: Block) -> Block:
    """Block of the means of consecutive measurements of `before`, rounded down; host times are not rounded."""
    middle = before.changed(_mean_of_neighbors)
    return replace(middle, seq=block.seq, is_clipped=block.is_clipped, still=block.still)


def _mean_of_neighbors(column: NDArray[Any]) -> NDArray[Any]:
    values = column.astype(np.float64)
    middle = 0.5 * (values[1:] + values[:-1])
    return middle if column.dtype == np.float64 else np.floor(middle).astype(column.dtype)


def _inserted(block: Block, inserted: Block, indices: NDArray[np.intp]) -> Block:
    """Block with additional measurements before some of its own."""
    slots = np.arange(len(block.seq)) + np.searchsorted(indices, np.arange(len(block.seq)), side="right")
    order = np.argsort(np.concatenate([slots, indices + np.arange(len(indices))]), kind="stable")
    return joined(block, inserted).changed(lambda column: column[order])
