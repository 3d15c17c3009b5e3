"""Where yaw counts from, and which way north is: set by a person, and nothing that the filter knows of."""

from dataclasses import dataclass
from math import isfinite, nan


@dataclass(slots=True)
class YawReference:
    """Takes yaw as the filter has it to yaw and heading as they are sent.

    zero_deg, raw_zero_deg
        Yaw of the filter, and the integrated raw rate, where yaw is 0.
    north_deg
        Yaw of the filter at which the heading is 0; NaN until a heading was given.
    """

    zero_deg: float = 0.0
    raw_zero_deg: float = 0.0
    north_deg: float = nan

    @property
    def has_north(self) -> bool:
        """A heading was given."""
        return isfinite(self.north_deg)

    def zero(self, yaw_deg: float, raw_deg: float) -> None:
        """Yaw is 0 now."""
        self.zero_deg, self.raw_zero_deg = yaw_deg, raw_deg

    def set_heading(self, yaw_deg: float, heading_deg: float) -> None:
        """The compass heading is this now: clockwise from north, while yaw is counter-clockwise."""
        self.north_deg = yaw_deg + heading_deg

    def heading_deg(self, yaw_deg: float) -> float:
        """From 0 to below 360; NaN without a reference."""
        return (self.north_deg - yaw_deg) % 360.0
