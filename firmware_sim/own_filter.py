"""The filter that a simulated device runs on its own counts, as a board with the firmware's header does.

The filter itself is looked up by name when a rig asks for it, so that the device depends on no part of the host.
"""

from collections.abc import Iterator
from importlib import import_module
from math import nan
from typing import NamedTuple, Protocol

import numpy as np

from firmware_sim.block import Block, TriaxialBlock
from firmware_sim.rig import Base

MODULE, MAKER = "gyrodrift.filters.on_device", "device_filter"
"""Module with the Python twin of the firmware's filters, and its function from a name to a filter."""

Vector = tuple[float, float, float]
NO_FORCE: Vector = (nan, nan, nan)


class OwnYaw(NamedTuple):
    """Yaw and its standard deviation in deg, and drift in deg/s, as 32-bit floats; the sigma is NaN if unknown."""

    yaw_deg: float
    yaw_sigma_deg: float
    bias_dps: float


class DeviceFilter(Protocol):
    """A running filter."""

    def step(self, t_s: float, gyro_dps: Vector, accel_mps2: Vector, temp_c: float) -> tuple[float, float, float]:
        """Take a sample; yaw, its sigma and the drift after it."""
        ...


class OwnFilter:
    """Runs the filter of a rig over blocks of measurements; it starts again when the device clock restarts."""

    def __init__(self, base: Base) -> None:
        self._base = base
        self._filter = self._new()
        self._last_us = 0

    def _new(self) -> DeviceFilter:
        running: DeviceFilter = getattr(import_module(MODULE), MAKER)(self._base.own_yaw)
        return running

    def results(self, block: Block) -> Iterator[OwnYaw]:
        """Result after each measurement of the next block."""
        scale_dps = float(np.float32(self._base.dps_per_lsb))  # as the host is told
        for row, (gyro_raw, accel_mps2) in zip(block.rows(), _axes(block, self._base), strict=True):
            _, t_us, _, _, _, temp_centi_c, _, _ = row
            if t_us < self._last_us:
                self._filter = self._new()
            self._last_us = t_us
            x, y, z = (count * scale_dps for count in gyro_raw)
            values = self._filter.step(t_us / 1e6, (x, y, z), accel_mps2, temp_centi_c / 100.0)
            yield OwnYaw(*(float(np.float32(value)) for value in values))


def own_filter_of(base: Base) -> OwnFilter | None:
    """The filter of a device; None for a device that runs none."""
    return None if base.own_yaw is None else OwnFilter(base)


def _axes(block: Block, base: Base) -> Iterator[tuple[list[int], Vector]]:
    """Rates about x, y and z in counts, and accelerations; NaN where these are missing or clipped."""
    if not isinstance(block, TriaxialBlock) or base.three_axes is None:
        yield from (([0, 0, count], NO_FORCE) for count in block.rate_raw.tolist())
        return
    scale_mps2 = float(np.float32(base.three_axes.mps2_per_lsb))
    for gyro_raw, accel_raw, is_clipped in block.axes_rows():
        if accel_raw is None or is_clipped:
            yield gyro_raw, NO_FORCE
        else:
            x, y, z = (count * scale_mps2 for count in accel_raw)
            yield gyro_raw, (x, y, z)
