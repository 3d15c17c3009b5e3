"""What the turntable does: a profile is a list of segments, each with a rate and the exact angle that belongs to it.

Profiles live in `config/profiles/`. A device runs for ever, so a profile starts again when it is over.
"""

from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field, model_validator

from firmware_sim.effects.effect import Floats
from firmware_sim.effects.environment import sensor_temperature_c
from firmware_sim.motion.segments import Drive, Hold, Ramp, Rest, Sine, Steps
from firmware_sim.motion.waves import Chirp, Multisine
from firmware_sim.yaml_file import Checked, FileError, load

Segment = Annotated[Rest | Ramp | Hold | Steps | Sine | Chirp | Multisine | Drive, Field(discriminator="kind")]


class Ambient(Checked):
    """The air around the sensor is at `temp_c` at `at_s` into the profile, and in between on a straight line."""

    at_s: Annotated[float, Field(ge=0.0, le=1e6)]
    temp_c: Annotated[float, Field(ge=-60.0, le=150.0)]


class Profile(Checked):
    """A motion of the turntable, with its surroundings.

    about
        What it is for.
    segments
        What happens, one after the other.
    powered_s
        How long the device has been on when it begins, s: 0 is a cold start.
    ambient
        Temperature of the air; 25 °C where nothing is said.
    """

    about: str
    segments: Annotated[tuple[Segment, ...], Field(min_length=1, strict=False)]
    powered_s: Annotated[float, Field(ge=0.0, le=1e6)] = 0.0
    ambient: Annotated[tuple[Ambient, ...], Field(min_length=1, strict=False)] = (Ambient(at_s=0.0, temp_c=25.0),)

    @model_validator(mode="after")
    def _times_rise(self) -> "Profile":
        times_s = [point.at_s for point in self.ambient]
        if any(later <= earlier for earlier, later in pairwise(times_s)):
            raise ValueError("the times of ambient have to rise")
        return self

    @cached_property
    def _table(self) -> tuple[Floats, list[float], Floats]:
        """Start of each segment in s, its rate in deg/s and its angle in degrees, with the end as a last entry."""
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

    def at(self, t_s: Floats) -> tuple[Floats, Floats]:
        """True angle in degrees and rate in deg/s at the times `t_s`, both of its shape; before 0 the table rests."""
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
        """Temperature of the air in °C at the times `t_s`, of its shape."""
        within_s = np.mod(np.maximum(t_s, 0.0), self.seconds)
        points = ([point.at_s for point in self.ambient], [point.temp_c for point in self.ambient])
        temps_c: Floats = np.interp(within_s, *points)
        return temps_c

    def sensor_c_at(self, t_s: Floats) -> Floats:
        """Temperature of the sensor in °C at the times `t_s`, of its shape."""
        return sensor_temperature_c(self.ambient_at(t_s), np.maximum(t_s, 0.0) + self.powered_s)


def config_folder() -> Path:
    """Where rigs and profiles are: beside the package in a checkout, inside it when installed from a wheel."""
    installed = Path(__file__).parent.parent / "config"
    return installed if installed.is_dir() else Path(__file__).parent.parent.parent / "config"


def shipped_profiles() -> list[str]:
    """Names of the profiles that come with the simulator."""
    return sorted(path.stem for path in (config_folder() / "profiles").glob("*.yaml"))


def load_profile(name: str) -> Profile:
    """A profile by its path, or by the name of a shipped one.

    Raises
    ------
    FileError
        Where there is none, or it has mistakes.
    """
    if Path(name).is_file():
        return load(Path(name), Profile)
    if name not in shipped_profiles():
        known = ", ".join(shipped_profiles())
        raise FileError(f"{name}: there is no such profile; shipped are {known}, or give a file")
    return load(config_folder() / "profiles" / f"{name}.yaml", Profile)
