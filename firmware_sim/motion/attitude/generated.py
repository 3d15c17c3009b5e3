"""Base of motions that are drawn from a seed: smooth tracks, repeated for ever."""

from abc import abstractmethod
from functools import cached_property
from typing import Annotated

import numpy as np
from pydantic import Field

from firmware_sim.effects.effect import Floats, Rng
from firmware_sim.motion.attitude.kinematics import Kinematics, of_jets
from firmware_sim.motion.attitude.track import StepTrack, Track
from firmware_sim.yaml_file import Checked

REST_S = 5.0
"""Rest at the beginning and at the end of a pass, s."""

Tracks = dict[str, Track]
Meters = Annotated[float, Field(ge=-10.0, le=10.0)]
Offset = Annotated[tuple[Meters, Meters, Meters], Field(strict=False)]

AXES = "xyz"


class Generated(Checked):
    """Motion of some minutes that starts and ends at rest, level, and at the same height; then it repeats.

    minutes
        Length of a pass.
    seed
        Seed of the motion.
    """

    minutes: Annotated[float, Field(ge=1.0, le=1000.0)] = 10.0
    seed: Annotated[int, Field(ge=0)] = 0

    @property
    def seconds(self) -> float:
        """Length of a pass, s."""
        return 60.0 * self.minutes

    @abstractmethod
    def plan(self, rng: Rng) -> Tracks:
        """Tracks by name; `yaw` among them, deg."""

    @abstractmethod
    def jets(self, tracks: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """Rotation (3, n, 3, 3), velocity (n, 3) and acceleration (n, 3) for the values of the tracks."""

    @cached_property
    def _tracks(self) -> Tracks:
        return self.plan(np.random.default_rng(self.seed))

    def kinematics_at(self, t_s: Floats) -> Kinematics:
        """True motion at times since the beginning; before 0 the sensor rests."""
        passes, within_s = np.divmod(np.maximum(t_s, 0.0), self.seconds)
        tracks = {name: track.values_at(within_s) for name, track in self._tracks.items()}
        motion = of_jets(*self.jets(tracks), tracks["yaw"][0])
        return motion.with_yaw(passes * self._tracks["yaw"].steps.end)


class Legs:
    """Clock of a plan: legs of random lengths between the rests at both ends of a pass."""

    def __init__(self, seconds: float, closing_s: float) -> None:
        self.now_s = REST_S
        self._until_s = seconds - REST_S - closing_s

    def is_open(self, leg_s: float) -> bool:
        """Whether a leg of this length still ends in time."""
        return self.now_s + leg_s <= self._until_s


def windowed(window: StepTrack, from_s: float, to_s: float, fade_s: float) -> None:
    """Open a window, and close it again."""
    window.move_to(1.0, from_s, fade_s)
    window.move_to(0.0, to_s - fade_s, fade_s)


def vector(tracks: dict[str, Floats], order: int) -> Floats:
    """Derivative of the position x, y, z, shape (n, 3)."""
    return np.stack([tracks[axis][order] for axis in AXES], axis=1)


def lever(offset_m: Offset) -> Floats:
    """Offset as a vector, shape (3,)."""
    return np.array(offset_m)
