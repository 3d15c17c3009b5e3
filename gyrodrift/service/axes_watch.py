"""Warnings about a device of three axes that stops sending its accelerations, or two of its rates.

Yaw goes on in both cases, by fewer measurements, so the log has to say it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import hypot, nan
from typing import Any

from gyrodrift.filters.run import WITHOUT_AXES_S as LOST_S
from gyrodrift.values.sample import Sample

WITHOUT_ACCELERATIONS = "the device sends three rates without accelerations: the tilt is by the gyro, or unknown"
WITHOUT_AXES = "the device sends one rate: yaw is right while this axis is vertical"


@dataclass(slots=True)
class AxesWatch:
    """Reports `accelerations_missing` and `accelerations_back`, `axes_missing` and `axes_back`.

    Three zeros are no acceleration: a sensor has noise. A device that never sent three rates has one axis.
    """

    tell: Callable[..., Any]
    _axes_s: float = nan
    _accel_s: float = nan
    _has_axes: bool = True
    _has_accel: bool = True

    def take(self, samples: list[Sample]) -> None:
        """Examine new samples."""
        for sample in samples:
            if sample.inertial is not None:
                self._take_axes(sample.t_device_s, hypot(*sample.inertial[3:]) > 0.0)
            elif self._has_axes and sample.t_device_s - self._axes_s > LOST_S:
                self._has_axes = False
                self.tell("axes_missing", seconds=round(sample.t_device_s - self._axes_s, 3), hint=WITHOUT_AXES)

    def _take_axes(self, t_s: float, has_accel: bool) -> None:  # noqa: FBT001 - of the sample
        if not self._has_axes:
            self._has_axes = True
            self.tell("axes_back", seconds=round(t_s - self._axes_s, 3))
            self._accel_s = t_s
        if has_accel or self._axes_s != self._axes_s:  # or NaN, before the first sample
            if not self._has_accel:
                self._has_accel = True
                self.tell("accelerations_back", seconds=round(t_s - self._accel_s, 3))
            self._accel_s = t_s
        elif self._has_accel and t_s - self._accel_s > LOST_S:
            self._has_accel = False
            self.tell("accelerations_missing", seconds=round(t_s - self._accel_s, 3), hint=WITHOUT_ACCELERATIONS)
        self._axes_s = t_s
