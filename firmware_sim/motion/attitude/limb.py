"""Sensor on a limb that swings about a joint while its owner walks and turns, with short pauses."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from firmware_sim.effects.effect import Floats, Rng
from firmware_sim.motion.attitude.generated import Generated, Legs, Tracks, windowed
from firmware_sim.motion.attitude.rotations import Z, about, product, rotated, yaw_pitch_roll
from firmware_sim.motion.attitude.track import StepTrack, Track, drawn_tones

WALK_S, PAUSE_S, FADE_S = (20.0, 60.0), (0.5, 3.0), 1.0
"""Lengths of a walk and of a pause, and the time in which the swing grows, s."""

LARGEST_TURN_DEG = 360.0

HARMONIC = 2.0
"""The body rises twice per swing: once for each leg."""


class Limb(Generated):
    """Sensor on a limb.

    swing_deg
        Root mean square of the swing along the way; across it and about the limb it is a third.
    swing_hz
        Frequency of the swing.
    length_m
        Distance of the sensor from the joint, below it.
    bob_m
        Root mean square of the height of the joint.
    speed_mps
        Speed of the walk.
    """

    kind: Literal["limb"]
    swing_deg: Annotated[float, Field(ge=0.0, le=30.0)] = 20.0
    swing_hz: Annotated[float, Field(gt=0.0, le=10.0)] = 0.9
    length_m: Annotated[float, Field(ge=0.0, le=5.0)] = 0.4
    bob_m: Annotated[float, Field(ge=0.0, le=1.0)] = 0.02
    speed_mps: Annotated[float, Field(ge=0.0, le=20.0)] = 1.2

    def plan(self, rng: Rng) -> Tracks:
        """Walks with a turn each, and pauses between them."""
        yaw, speed, walk = StepTrack(), StepTrack(), StepTrack()
        legs = Legs(self.seconds, closing_s=0.0)
        while True:
            end_s = legs.now_s + float(rng.uniform(*WALK_S))
            pause_s, turn_deg = float(rng.uniform(*PAUSE_S)), LARGEST_TURN_DEG * float(rng.uniform(-1.0, 1.0))
            if not legs.is_open(end_s - legs.now_s):
                break
            windowed(walk, legs.now_s, end_s, FADE_S)
            speed.move_to(self.speed_mps, legs.now_s, FADE_S)
            speed.move_to(0.0, end_s - FADE_S, FADE_S)
            yaw.move_to(yaw.end + turn_deg, legs.now_s, end_s - legs.now_s)
            legs.now_s = end_s + pause_s
        band_hz = (0.9 * self.swing_hz, 1.1 * self.swing_hz)
        sizes = {"pitch": self.swing_deg, "roll": self.swing_deg / 3.0, "twist": self.swing_deg / 3.0}
        swings = {name: Track(StepTrack(), drawn_tones(rng, rms, band_hz), walk) for name, rms in sizes.items()}
        bob = drawn_tones(rng, self.bob_m, (HARMONIC * band_hz[0], HARMONIC * band_hz[1]))
        return {"yaw": Track(yaw), "speed": Track(speed), "bob": Track(StepTrack(), bob, walk), **swings}

    def jets(self, tracks: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """The joint walks and bobs; the sensor hangs below it."""
        rotation = yaw_pitch_roll(tracks["yaw"] + tracks["twist"], tracks["pitch"], tracks["roll"])
        way = rotated(about(Z, tracks["yaw"]), np.array([1.0, 0.0, 0.0]))
        velocity = product(np.multiply, tracks["speed"][:3, :, None], way)[:2]
        velocity[:, :, 2] += tracks["bob"][1:3]
        arm = rotated(rotation, np.array([0.0, 0.0, -self.length_m]))
        return rotation, velocity[0] + arm[1], velocity[1] + arm[2]
