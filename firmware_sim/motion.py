"""What the turntable does: a profile is a list of segments, each with an exact rate and an exact angle.

Profiles live in `config/profiles/`. A device runs for ever, so a profile starts again when it is over.
"""

from functools import cached_property
from math import pi
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from firmware_sim.yaml_file import Checked, FileError, load

Floats = NDArray[np.float64]
Seconds = Annotated[float, Field(gt=0.0, le=1e6)]
RateDps = Annotated[float, Field(ge=-4000.0, le=4000.0)]
FrequencyHz = Annotated[float, Field(gt=0.0, le=1000.0)]


class Rest(Checked):
    """Standing still for `seconds`."""

    kind: Literal["rest"]
    seconds: Seconds

    def end_rate_dps(self, start_dps: float) -> float:
        """Rate after the segment, deg/s."""
        return 0.0

    def rate_dps(self, t_s: Floats, start_dps: float) -> Floats:
        """Rate at `t_s` into the segment, deg/s."""
        return np.zeros_like(t_s)

    def angle_deg(self, t_s: Floats, start_dps: float) -> Floats:
        """Angle gained at `t_s` into the segment, degrees."""
        return np.zeros_like(t_s)


class Ramp(Checked):
    """From the present rate to `to_dps` at constant acceleration."""

    kind: Literal["ramp"]
    seconds: Seconds
    to_dps: RateDps

    def end_rate_dps(self, start_dps: float) -> float:
        """Rate after the segment, deg/s."""
        return self.to_dps

    def rate_dps(self, t_s: Floats, start_dps: float) -> Floats:
        """Rate at `t_s` into the segment, deg/s."""
        return start_dps + (self.to_dps - start_dps) * t_s / self.seconds

    def angle_deg(self, t_s: Floats, start_dps: float) -> Floats:
        """Angle gained at `t_s` into the segment, degrees."""
        return start_dps * t_s + 0.5 * (self.to_dps - start_dps) * t_s**2 / self.seconds


class Hold(Checked):
    """Going on at the present rate."""

    kind: Literal["hold"]
    seconds: Seconds

    def end_rate_dps(self, start_dps: float) -> float:
        """Rate after the segment, deg/s."""
        return start_dps

    def rate_dps(self, t_s: Floats, start_dps: float) -> Floats:
        """Rate at `t_s` into the segment, deg/s."""
        return np.full_like(t_s, start_dps)

    def angle_deg(self, t_s: Floats, start_dps: float) -> Floats:
        """Angle gained at `t_s` into the segment, degrees."""
        return start_dps * t_s


class Sine(Checked):
    """The present rate plus a sine of `amplitude_dps` at `frequency_hz`."""

    kind: Literal["sine"]
    seconds: Seconds
    amplitude_dps: RateDps
    frequency_hz: FrequencyHz

    def end_rate_dps(self, start_dps: float) -> float:
        """Rate after the segment, deg/s."""
        return start_dps

    def rate_dps(self, t_s: Floats, start_dps: float) -> Floats:
        """Rate at `t_s` into the segment, deg/s."""
        return start_dps + self.amplitude_dps * np.sin(2.0 * pi * self.frequency_hz * t_s)

    def angle_deg(self, t_s: Floats, start_dps: float) -> Floats:
        """Angle gained at `t_s` into the segment, degrees."""
        turn_rate = 2.0 * pi * self.frequency_hz
        return start_dps * t_s + self.amplitude_dps / turn_rate * (1.0 - np.cos(turn_rate * t_s))


Segment = Annotated[Rest | Ramp | Hold | Sine, Field(discriminator="kind")]


class Profile(Checked):
    """A motion of the turntable, as its file says it."""

    about: str
    segments: Annotated[tuple[Segment, ...], Field(min_length=1, strict=False)]

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
        """True angle in degrees and rate in deg/s at the times `t_s`, both of its shape."""
        starts_s, rates_dps, angles_deg = self._table
        passes, within_s = np.divmod(t_s, starts_s[-1])
        which = np.clip(np.searchsorted(starts_s, within_s, side="right") - 1, 0, len(self.segments) - 1)
        angle_deg = passes * angles_deg[-1]
        rate_dps = np.zeros_like(t_s)
        for index in np.unique(which):
            chosen = which == index
            into_s = within_s[chosen] - starts_s[index]
            angle_deg[chosen] += angles_deg[index] + self.segments[index].angle_deg(into_s, rates_dps[index])
            rate_dps[chosen] = self.segments[index].rate_dps(into_s, rates_dps[index])
        return angle_deg, rate_dps


def config_folder() -> Path:
    """Where rigs and profiles are: beside the package in a checkout, inside it when installed from a wheel."""
    installed = Path(__file__).parent / "config"
    return installed if installed.is_dir() else Path(__file__).parent.parent / "config"


def load_profile(name: str) -> Profile:
    """A profile by its path, or by the name of a shipped one.

    Raises
    ------
    FileError
        Where there is none, or it has mistakes.
    """
    folder = config_folder() / "profiles"
    if Path(name).is_file():
        return load(Path(name), Profile)
    shipped = sorted(path.stem for path in folder.glob("*.yaml"))
    if name not in shipped:
        raise FileError(f"{name}: there is no such profile; shipped are {', '.join(shipped)}, or give a file")
    return load(folder / f"{name}.yaml", Profile)
