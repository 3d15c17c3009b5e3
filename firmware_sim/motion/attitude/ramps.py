"""Vehicle on wheels that drives over ramps and banked ground, with stops: a small robot, or a car on level ground."""

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from firmware_sim.effects.effect import Floats, Rng
from firmware_sim.motion.attitude.generated import Generated, Legs, Offset, Tracks, lever
from firmware_sim.motion.attitude.rotations import RAD, product, rotated, yaw_pitch_roll
from firmware_sim.motion.attitude.track import PEAK_SLOPE, StepTrack, Track

TURN_S, STOP_S = (2.5, 8.5), (3.0, 8.0)
"""Lengths of a turn and of a stop, s; a turn takes longer if it would pull too much."""

TILT_S, SPEED_UP_S = 1.2, 1.5
"""Times to drive onto a ramp, and at least to change the speed, s."""

LARGEST_TURN_DEG = 120.0


@dataclass(frozen=True, slots=True)
class _Leg:
    """Speed, m/s, slopes, deg, and turn, deg, with the times of changing the speed and of turning, s."""

    speed_mps: float
    pitch_deg: float
    roll_deg: float
    turn_deg: float
    change_s: float
    turn_s: float


class Ramps(Generated):
    """Vehicle on ramps.

    speed_mps, slope_deg, bank_deg
        Largest speed, slope along the way, and slope across it.
    accel_mps2
        Largest acceleration of the vehicle, along the way and sideways.
    stop_share
        Share of legs at which the vehicle stands.
    sensor_m
        Position of the sensor ahead of, left of and above the point that follows the way, m.
    """

    kind: Literal["ramps"]
    speed_mps: Annotated[float, Field(ge=0.0, le=50.0)] = 0.8
    accel_mps2: Annotated[float, Field(gt=0.0, le=20.0)] = 1.5
    slope_deg: Annotated[float, Field(ge=0.0, le=45.0)] = 15.0
    bank_deg: Annotated[float, Field(ge=0.0, le=45.0)] = 5.0
    stop_share: Annotated[float, Field(ge=0.0, le=1.0)] = 0.3
    sensor_m: Offset = (0.1, 0.0, 0.1)

    def plan(self, rng: Rng) -> Tracks:
        """Legs with a turn, a slope and a speed, and stops on the slope between them."""
        yaw, pitch, roll, speed = (StepTrack() for _ in range(4))
        legs = Legs(self.seconds, closing_s=max(TILT_S, self._change_s(self.speed_mps)))
        while True:
            is_stop = bool(rng.random() < self.stop_share) and speed.end > 0.0
            leg = self._stop(rng, speed.end) if is_stop else self._leg(rng, speed.end)
            if not legs.is_open(leg.change_s + leg.turn_s):
                break
            speed.move_to(leg.speed_mps, legs.now_s, leg.change_s)
            legs.now_s += leg.change_s
            if not is_stop:
                pitch.move_to(leg.pitch_deg, legs.now_s, TILT_S)
                roll.move_to(leg.roll_deg, legs.now_s, TILT_S)
                yaw.move_to(yaw.end + leg.turn_deg, legs.now_s, leg.turn_s)
            legs.now_s += leg.turn_s
        pitch.move_to(0.0, legs.now_s, TILT_S)
        roll.move_to(0.0, legs.now_s, TILT_S)
        speed.move_to(0.0, legs.now_s, self._change_s(speed.end))
        return {"yaw": Track(yaw), "pitch": Track(pitch), "roll": Track(roll), "speed": Track(speed)}

    def _leg(self, rng: Rng, speed_mps: float) -> _Leg:
        to_mps = self.speed_mps * float(rng.uniform(0.3, 1.0))
        turn_deg = LARGEST_TURN_DEG * float(rng.uniform(-1.0, 1.0))
        sideways_s = PEAK_SLOPE * abs(turn_deg) * RAD * to_mps / self.accel_mps2
        return _Leg(
            speed_mps=to_mps,
            pitch_deg=self.slope_deg * float(rng.choice([-1.0, 0.0, 1.0])),
            roll_deg=self.bank_deg * float(rng.uniform(-1.0, 1.0)),
            turn_deg=turn_deg,
            change_s=self._change_s(to_mps - speed_mps),
            turn_s=max(float(rng.uniform(*TURN_S)), sideways_s),
        )

    def _stop(self, rng: Rng, speed_mps: float) -> _Leg:
        return _Leg(0.0, 0.0, 0.0, 0.0, self._change_s(speed_mps), float(rng.uniform(*STOP_S)))

    def _change_s(self, by_mps: float) -> float:
        return max(SPEED_UP_S, PEAK_SLOPE * abs(by_mps) / self.accel_mps2)

    def jets(self, tracks: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """Speed along the x axis of the vehicle, and the sensor at its place."""
        rotation = yaw_pitch_roll(tracks["yaw"], tracks["pitch"], tracks["roll"])
        forward = rotated(rotation, np.array([1.0, 0.0, 0.0]))
        velocity = product(np.multiply, tracks["speed"][:3, :, None], forward)
        arm = rotated(rotation, lever(self.sensor_m))
        return rotation, velocity[0] + arm[1], velocity[1] + arm[2]
