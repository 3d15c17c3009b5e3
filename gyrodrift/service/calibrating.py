"""Applies the calibration of the config to samples before the filter.

A calibration of another device is not applied. The device may be known late, and change when another one is plugged in.
"""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from math import nan
from typing import Any

from gyrodrift.filters.filter import FilterState
from gyrodrift.io.logger import FilteringBoundLogger
from gyrodrift.link.link import Link
from gyrodrift.link.protocols.decoder import DeviceDescription
from gyrodrift.values.calibration import NO_CALIBRATION, OLD_DAYS, Calibration, device_identity
from gyrodrift.values.sample import Sample
from gyrodrift.values.vectors import Vector

Bias = float | Vector
"""Estimate of a filter, deg/s: of one axis, or about x, y and z."""


def bias_of(state: FilterState) -> Bias:
    """Bias estimate of a filter, deg/s; about x, y and z if it runs on three axes."""
    bias_dps: Bias = getattr(state, "bias_xyz_dps", state.bias_dps)
    return bias_dps


@dataclass(slots=True)
class Calibrating:
    """Applies a calibration that may change while the filter runs; the bias estimate of the filter stays valid.

    given
        Calibration of the config; None without one.
    applied
        Calibration in force; None without one.
    """

    link: Link
    log: FilteringBoundLogger
    tell: Callable[[str, dict[str, Any]], Any]
    given: Calibration | None = None
    applied: Calibration | None = None
    _device: DeviceDescription | None = None
    _temp_c: float = nan
    _has_begun: bool = False

    def take(self, samples: list[Sample], bias_dps: Bias) -> list[Sample]:
        """Samples with calibrated rates; `bias_dps` is the present estimate of the filter."""
        if not samples:
            return samples
        if self.link.device != self._device:  # a device sends its name once a second
            self._decide(bias_dps)
        if self.applied is None:
            return samples
        self._temp_c = samples[-1].temp_c
        return [self.applied.sample(sample) for sample in samples]

    def follow(self, given: Calibration | None, bias_dps: Bias) -> None:
        """Apply the calibration of a new config."""
        if given != self.given:
            self.given = given
            if self._has_begun:
                self._decide(bias_dps)

    def _decide(self, bias_dps: Bias) -> None:
        new, self._device = self._applicable(), self.link.device
        if new is None and self.applied is None:
            self._has_begun = True
            return
        if self._has_begun:
            new = (new or NO_CALIBRATION).following(self.applied or NO_CALIBRATION, bias_dps, self._temp_c)
        self.applied, self._has_begun = new, True

    def _applicable(self) -> Calibration | None:
        """Calibration of the config if it is for this device; warns of another device and of an old date."""
        if self.given is None:
            return None
        given, device_id = self.given, device_identity(self.link.device.device_id, self.link.name)
        if not given.is_for(device_id):
            self._warn(
                "calibration_of_another_device",
                calibrated=given.device_id,
                device_id=device_id,
                hint="it is not applied; calibrate this one with gyrodrift calibrate",
            )
            return None
        age_days = given.age_days(datetime.now(UTC))
        if age_days > OLD_DAYS:
            self._warn(
                "calibration_old", days=round(age_days), hint="it is applied; gyrodrift calibrate makes a new one"
            )
        fields = {
            "date": given.date,
            "sign": given.sign,
            "scale_ccw": given.scale_ccw,
            "scale_cw": given.scale_cw,
            "bias_dps": given.bias_dps,
            "device_id": device_id or "unknown",
            **({"axes": 3} if given.has_axes else {}),
        }
        self.log.info("calibration_applied", **fields)
        self.tell("calibration_applied", fields)
        return given

    def _warn(self, event: str, **fields: Any) -> None:
        self.log.warning(event, **fields)
        self.tell(event, fields)
