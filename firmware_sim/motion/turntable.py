"""Motion profile of the turntable: a list of segments with rates and exact angles.

Profiles are files in `config/profiles/`. A profile starts again when it is over.
"""

from collections.abc import Sequence
from functools import cached_property
from itertools import pairwise
from typing import Annotated

import numpy as np
from pydantic import Field, model_validator

from firmware_sim.effects.effect import Floats
from firmware_sim.effects.environment import sensor_temperature_c
from firmware_sim.motion.segments import Drive, Hold, Ramp, Rest, Sine, Steps
from firmware_sim.motion.waves import Chirp, Multisine
from firmware_sim.yaml_file import Checked

Segment = Annotated[Rest | Ramp | Hold | Steps | Sine | Chirp | Multisine | Drive, Field(discriminator="kind")]


class Ambient(Checked):
    """Air temperature `temp_c` at the time `at_s` of the profile, with linear interpolation."""

    at_s: Annotated[float, Field(ge=0.0, le=1e6)]
    temp_c: Annotated[float, Field(ge=-60.0, le=150.0)]


def check_times(ambient: Sequence[Ambient]) -> None:
    """Refuse temperatures whose times do not increase.

    Raises
    ------
    ValueError
        A time is not after the previous one.
    """
    if any(later.at_s <= earlier.at_s for earlier, later in pairwise(ambient)):
        raise ValueError("the times of ambient must increase")


def ambient_c_at(ambient: Sequence[Ambient], within_s: Floats) -> Floats:
    """Air temperature at times within a pass, °C, in their shape."""
    temps_c: Floats = np.interp(within_s, [point.at_s for point in ambient], [point.temp_c for point in ambient])
    return temps_c


class Profile(Checked):
    """Motion of the turntable, with its air temperature.

    about
        Description.
    segments
        Segments in order.
    powered_s
        Time since power-on at the beginning, s: 0 is a cold start.
    ambient
        Air temperature; 25 °C by default.
    """

    about: str
    segments: Annotated[tuple[Segment, ...], Field(min_length=1, strict=False)]
    powered_s: Annotated[float, Field(ge=0.0, le=1e6)] = 0.0
    ambient: Annotated[tuple[Ambient, ...], Field(min_length=1, strict=False)] = (Ambient(at_s=0.0, temp_c=25.0),)

    @model_validator(mode="after")
    def _times_rise(self) -> "Profile":
        check_times(self.ambient)
        return self

    @cached_property
    def _table(self) -> tuple[Floats, list[float], Floats]:
        """Starts of the segments, s, rates, deg/s, and angles, degrees, with the end as last entry."""
        starts_s, rates_dps, angles_deg = [0.0], [0.0], [0.0]
        for segment in self.segments:
            end_s = np.array([segment.seconds])
            starts_s.append(starts_s[-1] + segment.seconds)
            angles_deg.append(angles_deg[-1] + float(segment.angle_deg(end_s, rates_dps[-1])[0]))
            rates_dps.append(segment.end_rate_dps(rates_dps[-1]))
        return np.array(starts_s), rates_dps, np.array(angles_deg)

    @property
    def seconds(self) -> float:
        """Length of one pass, s."""
        return float(self._table[0][-1])

    def motion_at(self, t_s: Floats) -> tuple[Floats, Floats]:
        """True angle, degrees, and rate, deg/s, at `t_s`, in its shape; before 0 the table rests."""
        starts_s, rates_dps, angles_deg = self._table
        passes, within_s = np.divmod(np.maximum(t_s, 0.0), starts_s[-1])
        which = np.clip(np.searchsorted(starts_s, within_s, side="right") - 1, 0, len(self.segments) - 1)
        angle_deg = passes * angles_deg[-1]
        rate_dps = np.zeros_like(t_s)
        for index in np.unique(which):
            chosen = which == index
            into_s = within_s[chosen] - starts_s[index]
            angle_deg[chosen] += angles_deg[index] + self.segments[index].angle_deg(into_s, rates_dps[index])
            rate_dps[chosen] = self.segments[index].rate_dps(into_s, rates_dps[index])
        rate_dps[t_s < 0.0] = 0.0
        return angle_deg, rate_dps

    def ambient_at(self, t_s: Floats) -> Floats:
        """Air temperature at `t_s`, °C, in its shape."""
        return ambient_c_at(self.ambient, np.mod(np.maximum(t_s, 0.0), self.seconds))

    def sensor_c_at(self, t_s: Floats) -> Floats:
        """Temperature of the sensor at `t_s`, °C, in its shape."""
        return sensor_temperature_c(self.ambient_at(t_s), np.maximum(t_s, 0.0) + self.powered_s)
