"""Robot on wheels that drives over ramps and banked ground, with stops."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from firmware_sim.effects.effect import Floats, Rng
from firmware_sim.motion.attitude.generated import Generated, Legs, Offset, Tracks, lever
from firmware_sim.motion.attitude.rotations import product, rotated, yaw_pitch_roll
from firmware_sim.motion.attitude.track import StepTrack, Track

LEG_S, STOP_S = (4.0, 10.0), (3.0, 8.0)
"""Lengths of a leg and of a stop, s."""

TILT_S, SPEED_UP_S = 1.2, 1.5
"""Times to drive onto a ramp, and to change the speed, s."""

LARGEST_TURN_DEG = 120.0


class Ramps(Generated):
    """Robot on ramps.

    speed_mps, slope_deg, bank_deg
        Largest speed, slope along the way, and slope across it.
    stop_share
        Share of legs at which the robot stands.
    sensor_m
        Position of the sensor ahead of, left of and above the point that follows the way, m.
    """

    kind: Literal["ramps"]
    speed_mps: Annotated[float, Field(ge=0.0, le=50.0)] = 0.8
    slope_deg: Annotated[float, Field(ge=0.0, le=45.0)] = 15.0
    bank_deg: Annotated[float, Field(ge=0.0, le=45.0)] = 5.0
    stop_share: Annotated[float, Field(ge=0.0, le=1.0)] = 0.3
    sensor_m: Offset = (0.1, 0.0, 0.1)

    def plan(self, rng: Rng) -> Tracks:
        """Legs with a turn, a slope and a speed, and stops on the slope between them."""
        yaw, pitch, roll, speed = (StepTrack() for _ in range(4))
        legs = Legs(self.seconds, closing_s=TILT_S + SPEED_UP_S)
        while legs.is_open(LEG_S[1] + SPEED_UP_S):
            if rng.random() < self.stop_share and speed.end:
                speed.move_to(0.0, legs.now_s, SPEED_UP_S)
                legs.now_s += SPEED_UP_S + float(rng.uniform(*STOP_S))
                continue
            leg_s = float(rng.uniform(*LEG_S))
            speed.move_to(self.speed_mps * float(rng.uniform(0.3, 1.0)), legs.now_s, SPEED_UP_S)
            pitch.move_to(self.slope_deg * float(rng.choice([-1.0, 0.0, 1.0])), legs.now_s + TILT_S, TILT_S)
            roll.move_to(self.bank_deg * float(rng.uniform(-1.0, 1.0)), legs.now_s + TILT_S, TILT_S)
            turn_deg = LARGEST_TURN_DEG * float(rng.uniform(-1.0, 1.0))
            yaw.move_to(yaw.end + turn_deg, legs.now_s + SPEED_UP_S, leg_s - SPEED_UP_S)
            legs.now_s += leg_s
        pitch.move_to(0.0, legs.now_s, TILT_S)
        roll.move_to(0.0, legs.now_s, TILT_S)
        speed.move_to(0.0, legs.now_s, SPEED_UP_S)
        return {"yaw": Track(yaw), "pitch": Track(pitch), "roll": Track(roll), "speed": Track(speed)}

    def jets(self, tracks: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """Speed along the x axis of the robot, and the sensor at its place."""
        rotation = yaw_pitch_roll(tracks["yaw"], tracks["pitch"], tracks["roll"])
        forward = rotated(rotation, np.array([1.0, 0.0, 0.0]))
        velocity = product(np.multiply, tracks["speed"][:3, :, None], forward)
        arm = rotated(rotation, lever(self.sensor_m))
        return rotation, velocity[0] + arm[1], velocity[1] + arm[2]
