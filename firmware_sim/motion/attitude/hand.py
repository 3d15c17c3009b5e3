"""Sensor in a hand: it is taken up, moved and turned about all axes, and put down again."""

from typing import Annotated, Literal

from pydantic import Field

from firmware_sim.effects.effect import Floats, Rng
from firmware_sim.motion.attitude.generated import AXES, Generated, Legs, Tracks, vector, windowed
from firmware_sim.motion.attitude.rotations import yaw_pitch_roll
from firmware_sim.motion.attitude.track import StepTrack, Track, drawn_tones

MOVE_S, FADE_S = (8.0, 30.0), 1.5
"""Length of a motion, and time to take up and put down, s."""

HELD_DEG = 50.0
"""Largest pitch and roll at which the hand holds the sensor."""

REACH_M = 0.3


class Hand(Generated):
    """Sensor in a hand.

    swing_deg
        Root mean square of each angle while it moves.
    sway_m
        Root mean square of each coordinate while it moves.
    slowest_hz, fastest_hz
        Band of the motion.
    rest_s
        Mean time for which it lies on the table between two motions.
    """

    kind: Literal["hand"]
    swing_deg: Annotated[float, Field(ge=0.0, le=30.0)] = 20.0
    sway_m: Annotated[float, Field(ge=0.0, le=1.0)] = 0.05
    slowest_hz: Annotated[float, Field(gt=0.0, le=20.0)] = 0.2
    fastest_hz: Annotated[float, Field(gt=0.0, le=20.0)] = 2.0
    rest_s: Annotated[float, Field(ge=0.0, le=1000.0)] = 4.0

    def plan(self, rng: Rng) -> Tracks:
        """Motions from the table into the air and back."""
        steps = {name: StepTrack() for name in ("yaw", "pitch", "roll", *AXES)}
        window = StepTrack()
        legs = Legs(self.seconds, closing_s=0.0)
        while legs.is_open(MOVE_S[1]):
            end_s = legs.now_s + float(rng.uniform(*MOVE_S))
            windowed(window, legs.now_s, end_s, FADE_S)
            for name, track in steps.items():
                self._move(rng, name, track, legs.now_s, end_s)
            legs.now_s = end_s + self.rest_s * float(rng.uniform(0.5, 1.5))
        band_hz = (min(self.slowest_hz, 0.5 * self.fastest_hz), self.fastest_hz)
        sizes = dict.fromkeys(steps, self.sway_m) | dict.fromkeys(("yaw", "pitch", "roll"), self.swing_deg)
        return {name: Track(track, drawn_tones(rng, sizes[name], band_hz), window) for name, track in steps.items()}

    def _move(self, rng: Rng, name: str, track: StepTrack, start_s: float, end_s: float) -> None:
        """Up to a pose and down again; the heading stays where the hand has turned it."""
        share = float(rng.uniform(-1.0, 1.0))
        if name == "yaw":
            track.move_to(track.end + 180.0 * share, start_s, end_s - start_s)
            return
        track.move_to(share * (REACH_M if name in AXES else HELD_DEG), start_s, 2.0 * FADE_S)
        track.move_to(0.0, end_s - 2.0 * FADE_S, 2.0 * FADE_S)

    def jets(self, tracks: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """Angles and coordinates are the tracks."""
        rotation = yaw_pitch_roll(tracks["yaw"], tracks["pitch"], tracks["roll"])
        return rotation, vector(tracks, 1), vector(tracks, 2)
