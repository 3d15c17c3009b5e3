"""Robot arm with the sensor at its end: moves between poses, with stops."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from firmware_sim.effects.effect import Floats, Rng
from firmware_sim.motion.attitude.generated import Generated, Legs, Tracks
from firmware_sim.motion.attitude.rotations import X, Y, Z, about, chained, rotated
from firmware_sim.motion.attitude.track import PEAK_SLOPE, StepTrack, Track

LIMITS_DEG = {"yaw": 160.0, "shoulder": 50.0, "elbow": 70.0, "wrist": 60.0}
"""Largest angles of the joints: about the vertical, two across the links, and along the last one."""


class Arm(Generated):
    """Robot arm with two links.

    upper_m, lower_m
        Lengths of the links; the sensor is at the end of the second.
    joint_dps
        Highest rate of a joint.
    stop_s
        Mean time in a pose.
    """

    kind: Literal["arm"]
    upper_m: Annotated[float, Field(ge=0.0, le=10.0)] = 0.4
    lower_m: Annotated[float, Field(ge=0.0, le=10.0)] = 0.4
    joint_dps: Annotated[float, Field(gt=0.0, le=1000.0)] = 60.0
    stop_s: Annotated[float, Field(ge=0.0, le=1000.0)] = 3.0

    def plan(self, rng: Rng) -> Tracks:
        """All joints move together; the slowest sets the time of a move."""
        joints = {name: StepTrack() for name in LIMITS_DEG}
        legs = Legs(self.seconds, closing_s=self._move_s(max(LIMITS_DEG.values())))
        while True:
            pose = {name: limit * float(rng.uniform(-1.0, 1.0)) for name, limit in LIMITS_DEG.items()}
            seconds = self._move_s(max(abs(pose[name] - joints[name].end) for name in pose))
            stop_s = self.stop_s * float(rng.uniform(0.5, 1.5))
            if not legs.is_open(seconds + stop_s):
                break
            for name, angle_deg in pose.items():
                joints[name].move_to(angle_deg, legs.now_s, seconds)
            legs.now_s += seconds + stop_s
        for steps in joints.values():
            steps.move_to(0.0, legs.now_s, self._move_s(max(LIMITS_DEG.values())))
        return {name: Track(steps) for name, steps in joints.items()}

    def _move_s(self, angle_deg: float) -> float:
        return max(0.5, PEAK_SLOPE * angle_deg / self.joint_dps)

    def jets(self, tracks: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """Forward kinematics of the chain; the sensor keeps the direction of the last link."""
        upper = chained(about(Z, tracks["yaw"]), about(Y, tracks["shoulder"]))
        lower = chained(upper, about(Y, tracks["elbow"]))
        end = rotated(upper, np.array([self.upper_m, 0.0, 0.0])) + rotated(lower, np.array([self.lower_m, 0.0, 0.0]))
        return chained(lower, about(X, tracks["wrist"])), end[1], end[2]
