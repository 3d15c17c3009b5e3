"""The motions of the hard cases: turns with rests, turns without, a constant spin, a drive with slow curves."""

from collections.abc import Callable

import numpy as np

from firmware_sim.effects.effect import Rng
from firmware_sim.motion.profile import Segment
from firmware_sim.motion.segments import Drive, Hold, Ramp, Rest

RAMP_S = 1.0
SLOWEST_DPS, FASTEST_DPS = 5.0, 180.0
STOP_EVERY = 15
"""Moves between two stops of a motion with few rests: a stop every 1.5 minutes."""

Motions = Callable[[Rng, float], tuple[Segment, ...]]
"""Gives segments of at least so many seconds in all; the first starts from rest."""


def either_sign(rng: Rng) -> float:
    """1 or −1 with equal probability."""
    return float(rng.choice([-1.0, 1.0]))


def _speed_dps(rng: Rng) -> float:
    """A log-uniform speed with a random sign, deg/s."""
    return either_sign(rng) * float(np.exp(rng.uniform(np.log(SLOWEST_DPS), np.log(FASTEST_DPS))))


def turns_with_rests(rng: Rng, seconds: float) -> tuple[Segment, ...]:
    """A turntable: turns and rests of some seconds."""
    segments: list[Segment] = []
    while sum(segment.seconds for segment in segments) < seconds:
        segments += [
            Ramp(kind="ramp", seconds=RAMP_S, to_dps=_speed_dps(rng)),
            Hold(kind="hold", seconds=float(rng.uniform(2.0, 6.0))),
            Ramp(kind="ramp", seconds=RAMP_S, to_dps=0.0),
            Rest(kind="rest", seconds=float(rng.uniform(3.0, 6.0))),
        ]
    return tuple(segments)


def turns_without_rests(rng: Rng, seconds: float) -> tuple[Segment, ...]:
    """Changing speeds with rare stops of two seconds."""
    segments: list[Segment] = []
    while sum(segment.seconds for segment in segments) < seconds:
        for _ in range(STOP_EVERY):
            segments += [
                Ramp(kind="ramp", seconds=RAMP_S, to_dps=_speed_dps(rng)),
                Hold(kind="hold", seconds=float(rng.uniform(2.0, 8.0))),
            ]
        segments += [Ramp(kind="ramp", seconds=RAMP_S, to_dps=0.0), Rest(kind="rest", seconds=2.0)]
    return tuple(segments)


def spin(rate_dps: float) -> Motions:
    """A constant speed in a random direction."""

    def motion(rng: Rng, seconds: float) -> tuple[Segment, ...]:
        to_dps = either_sign(rng) * rate_dps
        return (Ramp(kind="ramp", seconds=RAMP_S, to_dps=to_dps), Hold(kind="hold", seconds=seconds))

    return motion


def slow_curves(rng: Rng, seconds: float) -> tuple[Segment, ...]:
    """A vehicle whose curves last half a minute, with few stops."""
    minutes, seed = seconds / 60.0 + 1.0, int(rng.integers(2**31))
    return (Drive(kind="drive", minutes=minutes, rms_dps=4.0, curve_seconds=30.0, rest_share=0.03, seed=seed),)
