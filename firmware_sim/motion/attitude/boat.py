"""Boat in waves: it rolls, pitches, heaves, and heels in turns; it is calm at both ends of a pass."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from firmware_sim.effects.effect import Floats, Rng
from firmware_sim.motion.attitude.generated import REST_S, Generated, Legs, Offset, Tracks, lever, windowed
from firmware_sim.motion.attitude.rotations import Z, about, product, rotated, yaw_pitch_roll
from firmware_sim.motion.attitude.track import StepTrack, Track, drawn_tones

COURSE_S, TURN_S, FADE_S = (10.0, 40.0), (8.0, 20.0), 8.0
"""Lengths of a course and of a turn; time in which waves and speed grow, s."""

LARGEST_TURN_DEG = 180.0

WAVES = (0.7, 1.6)
"""Band of the waves in units of the inverse period: most energy of a wind sea (Pierson and Moskowitz 1964)."""


class Boat(Generated):
    """Boat in waves.

    roll_deg, pitch_deg, heave_m, wander_deg
        Root mean squares of the motion by waves; `wander_deg` is that of the heading.
    period_s
        Period of the waves.
    speed_mps
        Speed.
    heel_deg_per_dps
        Heel for each deg/s of a turn.
    sensor_m
        Position of the sensor ahead of, left of and above the center of the motion, m.
    """

    kind: Literal["boat"]
    roll_deg: Annotated[float, Field(ge=0.0, le=20.0)] = 8.0
    pitch_deg: Annotated[float, Field(ge=0.0, le=20.0)] = 3.0
    heave_m: Annotated[float, Field(ge=0.0, le=10.0)] = 0.3
    wander_deg: Annotated[float, Field(ge=0.0, le=20.0)] = 2.0
    period_s: Annotated[float, Field(ge=1.0, le=30.0)] = 5.0
    speed_mps: Annotated[float, Field(ge=0.0, le=30.0)] = 3.0
    heel_deg_per_dps: Annotated[float, Field(ge=-5.0, le=5.0)] = 0.5
    sensor_m: Offset = (2.0, 0.0, 1.0)

    def plan(self, rng: Rng) -> Tracks:
        """Courses with turns between them, in waves from cast-off to mooring."""
        yaw, speed, sea = StepTrack(), StepTrack(), StepTrack()
        legs = Legs(self.seconds, closing_s=FADE_S)
        windowed(sea, REST_S, self.seconds - REST_S, FADE_S)
        speed.move_to(self.speed_mps, legs.now_s, FADE_S)
        legs.now_s += FADE_S
        while legs.is_open(COURSE_S[1] + TURN_S[1]):
            legs.now_s += float(rng.uniform(*COURSE_S))
            turn_s = float(rng.uniform(*TURN_S))
            yaw.move_to(yaw.end + LARGEST_TURN_DEG * float(rng.uniform(-1.0, 1.0)), legs.now_s, turn_s)
            legs.now_s += turn_s
        speed.move_to(0.0, self.seconds - REST_S - FADE_S, FADE_S)
        band_hz = (WAVES[0] / self.period_s, WAVES[1] / self.period_s)
        sizes = {"roll": self.roll_deg, "pitch": self.pitch_deg, "heave": self.heave_m, "wander": self.wander_deg}
        waves = {name: Track(StepTrack(), drawn_tones(rng, rms, band_hz), sea) for name, rms in sizes.items()}
        return {"yaw": Track(yaw), "speed": Track(speed), **waves}

    def jets(self, tracks: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """Heel follows the rate of the turn."""
        yaw = tracks["yaw"] + tracks["wander"]
        roll = tracks["roll"][:3] + self.heel_deg_per_dps * tracks["yaw"][1:4]
        rotation = yaw_pitch_roll(yaw, tracks["pitch"], roll)
        way = rotated(about(Z, tracks["yaw"]), np.array([1.0, 0.0, 0.0]))
        velocity = product(np.multiply, tracks["speed"][:3, :, None], way)[:2]
        velocity[:, :, 2] += tracks["heave"][1:3]
        arm = rotated(rotation, lever(self.sensor_m))
        return rotation, velocity[0] + arm[1], velocity[1] + arm[2]
