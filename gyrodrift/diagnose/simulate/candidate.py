"""Candidate causes: an effect of the rig with its second parameter fixed, at a grid of sizes."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum, StrEnum

import numpy as np

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import Effect
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.design_matrix import DesignMatrix

Shape = Callable[[DesignMatrix, np.random.Generator], Floats]
"""A session's design and random stream to what is added to its rate, deg/s at size 1, shape (n,)."""


class Need(StrEnum):
    """What recordings have to hold for an effect to show in them."""

    MOTION = "motion"
    TEMPERATURE = "temperature"
    HOST = "host"
    COUNTER = "counter"
    AXES = "axes"


class Touches(Enum):
    """What an effect changes in a recording; features of all else are taken over from a simulation without it.

    TIMES        stamps and arrivals; rate and angle of each sample stay as they were
    SLOW_RATE    it adds to the rate something slow beside a sample: noise, numbers and times stay
    RATE         it adds to the rate something that shows from sample to sample, too; numbers and times stay
    VALUES       rates and angles; which samples come and when stays
    EVERYTHING   anything
    """

    TIMES = "times"
    SLOW_RATE = "slow rate"
    RATE = "rate"
    VALUES = "values"
    EVERYTHING = "everything"


@dataclass(frozen=True, slots=True)
class Candidate:
    """An effect with its second parameter fixed, or an out-of-catalogue model, tried at some sizes.

    variant
        Tells it from others of the same name.
    make
        The effect of a size.
    parameter
        Which parameter is the size.
    grid_points
        Sizes that are simulated, rising; 0 stands for none, and sizes in between are interpolated.
    sizes
        Those that a fit decides between.
    group
        Effects of one group are easily taken for each other.
    needs, touches, realisations, is_exact, phase_deg
        As in `CandidateKind` and `Variant`.
    is_phase_free
        Whether the phase is another one in each session, as with an encoder that is zeroed wherever it stands.
    in_rig
        The effect as the rig has it already, which `make` changes; None where the rig has none. Where the effect is
        linear, sizes are what comes on top.
    shape
        Of an out-of-catalogue model: what is added to the rate.
    """

    name: str
    variant: str
    make: Callable[[float], Effect]
    parameter: str
    grid_points: Floats
    sizes: Floats
    group: str
    needs: tuple[Need, ...] = ()
    touches: Touches = Touches.EVERYTHING
    realisations: int = 1
    is_exact: bool = False
    phase_deg: float | None = None
    is_phase_free: bool = False
    in_rig: Effect | None = None
    shape: Shape | None = None

    @property
    def stage(self) -> str:
        """Of the rig."""
        return CATALOGUE[self.name].stage

    @property
    def is_out_of_catalogue(self) -> bool:
        """Whether it is no effect of the catalogue."""
        return self.shape is not None

    def applied(self, size: float, effects: Sequence[Effect]) -> Effect:
        """The effect of a size in a rig whose effects may have a phase of their own in this session."""
        return self.turned(self.make(size), effects)

    def turned(self, effect: Effect, effects: Sequence[Effect]) -> Effect:
        """An effect that changes one of a rig, at the phase that this has in a session."""
        phase_deg = self._phase_deg(effects)
        return effect if phase_deg is None else effect.model_copy(update={"phase_deg": phase_deg})

    def added(self, size: float, effects: Sequence[Effect]) -> Effect:
        """What is added to a rig that has the effect already, where sizes are what comes on top."""
        if self.in_rig is None:
            return self.make(size)
        phase_deg = self._phase_deg(effects)
        if phase_deg is None:
            return self.in_rig.model_copy(update={self.parameter: size})
        turned = phase_deg + (180.0 if size < 0.0 else 0.0)
        return self.in_rig.model_copy(update={self.parameter: abs(size), "phase_deg": turned})

    def _phase_deg(self, effects: Sequence[Effect]) -> float | None:
        """That of the effect as it stands in a rig, degrees; None where it has none, or does not stand there."""
        own = next((effect for effect in effects if effect.name == self.name), None) if self.in_rig else None
        return None if own is None else own.model_dump().get("phase_deg")
