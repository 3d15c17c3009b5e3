"""The parts of an evaluation by name, and how many cases each has where nobody asks for another number."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from evaluate import (
    aids_part,
    constants_part,
    diagnose_part,
    everyday_part,
    gyrogap_part,
    hard_cases_part,
    planted_part,
    real_causes_part,
    round_trip_part,
    simulators_part,
)
from evaluate.figures import Figure

Say = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class Part:
    """`measure(seed, count, folder, say)`; `count` is of cases of each kind, `folder` keeps results of this code."""

    about: str
    seed: int
    count: int
    measure: Callable[[int, int, Path, Say], list[Figure]]


PARTS = {
    "diagnose": Part("gyrodrift diagnose on blind cases of each row", 4711, 10, diagnose_part.measure),
    "round-trip": Part(
        "simulate and diagnose with the shipped rig, seeds of each effect", 1, 1, round_trip_part.measure
    ),
    "gyrogap": Part("gyrodrift diagnose on the open benchmark, cases of each row", 4712, 4, gyrogap_part.measure),
    "simulators": Part(
        "diagnose between sessions of MuJoCo, Bullet, Drake and pymunk, seeds of each case of the first two",
        20263,
        1,
        simulators_part.measure,
    ),
    "real_causes": Part(
        "diagnose on real recordings whose cause is known, cases of each device", 0, 6, real_causes_part.measure
    ),
    "planted": Part(
        "diagnose between halves of the recordings of a device, one with a planted flaw, cases",
        0,
        40,
        planted_part.measure,
    ),
    "everyday": Part("filters on everyday motions, sessions of each", 3, 15, everyday_part.measure),
    "aids": Part("restlevel beside a second source, rides of each kind", 59, 6, aids_part.measure),
    "constants": Part(
        "constants of restlevel at other values, everyday sessions of each", 5, 1, constants_part.measure
    ),
    "hard-cases": Part("restlevel on the hard cases, seeds of each", 101, 5, hard_cases_part.measure),
}
