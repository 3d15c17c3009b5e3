"""Reference of yaw and heading: the zero and the north that a person set, and other angles from the same zero."""

from dataclasses import dataclass
from math import copysign, inf, isfinite, nan, remainder

from gyrodrift.values.sample import DeviceYaw

FULL_TURN_DEG, HALF_TURN_DEG = 360.0, 180.0


@dataclass(slots=True)
class YawReference:
    """Converts yaw of the filter to yaw and heading of the output.

    zero_deg, raw_zero_deg
        Yaw of the filter, and integrated measured rate, at the zero of the output.
    north_deg
        Yaw of the filter at which the heading is 0; NaN until a heading is set.
    """

    zero_deg: float = 0.0
    raw_zero_deg: float = 0.0
    north_deg: float = nan

    @property
    def has_north(self) -> bool:
        """Whether a heading was set."""
        return isfinite(self.north_deg)

    def zero(self, yaw_deg: float, raw_deg: float) -> None:
        """Set the zero to this yaw."""
        self.zero_deg, self.raw_zero_deg = yaw_deg, raw_deg

    def set_heading(self, yaw_deg: float, heading_deg: float) -> None:
        """Set the north. A heading counts clockwise, yaw counter-clockwise."""
        self.north_deg = yaw_deg + heading_deg

    def shift(self, step_deg: float) -> None:
        """Keep yaw and heading of the output where yaw of the filter makes a step."""
        self.zero_deg, self.north_deg = self.zero_deg + step_deg, self.north_deg + step_deg

    def heading_deg(self, yaw_deg: float) -> float:
        """Heading from 0 to below 360; NaN without a north."""
        return (self.north_deg - yaw_deg) % FULL_TURN_DEG


@dataclass(slots=True)
class SmoothYaw:
    """A yaw that takes corrections in slowly, for a control loop.

    behind_deg
        Corrections of yaw that it has not taken in.
    """

    behind_deg: float = 0.0

    def follow(self, correction_deg: float, step_s: float, slew_dps: float) -> None:
        """Note the correction of a sample, and take in what is due since the sample before."""
        behind_deg = self.behind_deg + correction_deg
        self.behind_deg = copysign(max(0.0, abs(behind_deg) - slew_dps * step_s), behind_deg)


@dataclass(slots=True)
class EncoderReference:
    """Unwraps the encoder angle and aligns it with yaw at the first sample and at each zero, as `info` does."""

    _offset_deg: float = nan
    _last_deg: float = nan
    _low_deg: float = inf
    _high_deg: float = -inf

    def align(self) -> None:
        """Take the yaw of the next sample as the true one."""
        self._offset_deg = nan

    def angle_deg(self, encoder_deg: float, yaw_deg: float) -> float:
        """Encoder angle from the zero of yaw; NaN without a value of the encoder. `yaw_deg` is the output yaw.

        An encoder whose range exceeds a full turn counts turns itself and is not unwrapped.
        """
        if not isfinite(encoder_deg):
            return nan
        self._low_deg, self._high_deg = min(self._low_deg, encoder_deg), max(self._high_deg, encoder_deg)
        step_deg = encoder_deg - self._last_deg  # NaN at the first
        if abs(step_deg) > HALF_TURN_DEG and self._high_deg - self._low_deg <= FULL_TURN_DEG:
            self._offset_deg -= copysign(FULL_TURN_DEG, step_deg)
        self._last_deg = encoder_deg
        if not isfinite(self._offset_deg):
            self._offset_deg = yaw_deg - encoder_deg
        return encoder_deg + self._offset_deg


@dataclass(slots=True)
class DeviceReference:
    """Compares yaw with the device's own yaw, whose zero is that of the device.

    last
        Last result of the device's own filter; None before the first.
    difference_deg
        Yaw minus the device's own yaw at that result, −180 to 180 deg, 0 where the two were aligned.
    """

    last: DeviceYaw | None = None
    difference_deg: float = nan
    _offset_deg: float = nan

    def align(self) -> None:
        """Take the two as equal at the next result."""
        self._offset_deg = nan

    def take(self, device_yaw: DeviceYaw | None, yaw_deg: float) -> float:
        """Difference at the last result of the device; NaN before the first. `yaw_deg` is the output yaw."""
        if device_yaw is None:
            return self.difference_deg
        apart_deg = yaw_deg - device_yaw.yaw_deg
        if not isfinite(self._offset_deg):
            self._offset_deg = apart_deg
        self.last, self.difference_deg = device_yaw, remainder(apart_deg - self._offset_deg, FULL_TURN_DEG)
        return self.difference_deg
