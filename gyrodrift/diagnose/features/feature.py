"""What a feature is, and what a group of them is measured with."""

from dataclasses import dataclass
from typing import NamedTuple

from gyrodrift.arrays import Floats


@dataclass(frozen=True, slots=True)
class Feature:
    """A statistic with a name.

    stage
        Of the rig, where what moves it most often sits: sensor, environment, platform, encoder, clock or link.
    regime
        Of the motion it speaks of: rest, slow, fast, moving, accelerating, reversing, cold, warm, early, late, always.
    says
        What a person reads when it is high; {amount} takes the figure in `unit`.
    """

    name: str
    stage: str
    regime: str
    says: str


class Measured(NamedTuple):
    """Values of some features and their floors, what is too small to matter for yaw; shape (features,) each."""

    values: Floats
    floors: Floats
