"""Quadrotor: it tilts as its acceleration and drag ask for, so that thrust is along its z axis.

With thrust along z and drag proportional to the velocity, the z axis has the direction of a + g + k·v. Position and
heading determine the rest of the attitude, and its rates follow from jerk and snap (Mellinger and Kumar 2011).
"""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from firmware_sim.constants import STANDARD_GRAVITY_MPS2
from firmware_sim.effects.effect import Floats, Rng
from firmware_sim.motion.attitude.generated import AXES, REST_S, Generated, Legs, Tracks, vector, windowed
from firmware_sim.motion.attitude.rotations import Z, about, product, rotated
from firmware_sim.motion.attitude.track import StepTrack, Track, drawn_tones

CLIMB_S, WAY_S, HOVER_S, FADE_S = 4.0, (3.0, 6.0), (2.0, 10.0), 2.0
"""Times of a climb, of a way between two points, of a hover, and in which the air grows rough, s."""

LARGEST_TURN_DEG = 120.0

ROUGH_HZ = (0.3, 2.0)
"""Band of the corrections of a position controller."""


class Drone(Generated):
    """Quadrotor.

    reach_m, height_m
        Largest distance of a point from the start along each axis, and height.
    rough_mm
        Root mean square of the wobble of each coordinate, mm.
    drag_per_s
        Drag over mass, 1/s.
    """

    kind: Literal["drone"]
    reach_m: Annotated[float, Field(ge=0.0, le=1000.0)] = 6.0
    height_m: Annotated[float, Field(ge=0.0, le=1000.0)] = 3.0
    rough_mm: Annotated[float, Field(ge=0.0, le=200.0)] = 15.0
    drag_per_s: Annotated[float, Field(ge=0.0, le=5.0)] = 0.3

    def plan(self, rng: Rng) -> Tracks:
        """Up, from point to point, back, and down."""
        steps = {name: StepTrack() for name in ("yaw", *AXES)}
        air = StepTrack()
        legs = Legs(self.seconds, closing_s=WAY_S[1] + CLIMB_S)
        steps["z"].move_to(self.height_m, legs.now_s, CLIMB_S)
        windowed(air, REST_S, self.seconds - REST_S, FADE_S)
        legs.now_s += CLIMB_S
        while legs.is_open(WAY_S[1] + HOVER_S[1]):
            way_s = float(rng.uniform(*WAY_S))
            for name in ("x", "y"):
                steps[name].move_to(self.reach_m * float(rng.uniform(-1.0, 1.0)), legs.now_s, way_s)
            turn_deg = LARGEST_TURN_DEG * float(rng.uniform(-1.0, 1.0))
            steps["yaw"].move_to(steps["yaw"].end + turn_deg, legs.now_s, way_s)
            legs.now_s += way_s + float(rng.uniform(*HOVER_S))
        for name in ("x", "y"):
            steps[name].move_to(0.0, legs.now_s, WAY_S[1])
        steps["z"].move_to(0.0, self.seconds - REST_S - CLIMB_S, CLIMB_S)
        rough = {name: drawn_tones(rng, 1e-3 * self.rough_mm, ROUGH_HZ, fall=2.0) for name in AXES}
        return {name: Track(track, rough.get(name), air) for name, track in steps.items()}

    def jets(self, tracks: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """The z axis along the thrust; the x axis in the vertical plane of the heading."""
        thrust = np.stack(
            [vector(tracks, order + 2) + self.drag_per_s * vector(tracks, order + 1) for order in range(3)]
        )
        thrust[0, :, 2] += STANDARD_GRAVITY_MPS2
        up = _unit(thrust)
        ahead = rotated(about(Z, tracks["yaw"]), np.array([1.0, 0.0, 0.0]))
        leftward = _unit(product(np.cross, up, ahead))
        forward = product(np.cross, leftward, up)
        return np.stack([forward, leftward, up], axis=-1), vector(tracks, 1), vector(tracks, 2)


def _unit(vectors: Floats) -> Floats:
    """Jet of vectors over their lengths: s = v·v, and the derivatives of s^(−1/2)."""
    squared = product(lambda a, b: np.sum(a * b, axis=-1), vectors, vectors)
    inverse = squared[0] ** -0.5
    first = -0.5 * inverse / squared[0] * squared[1]
    second = 0.75 * inverse / squared[0] ** 2 * squared[1] ** 2 - 0.5 * inverse / squared[0] * squared[2]
    return product(np.multiply, np.stack([inverse, first, second])[:, :, None], vectors)
