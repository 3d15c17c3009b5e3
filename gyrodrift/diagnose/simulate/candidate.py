"""Candidate causes: an effect of the rig with its second parameter fixed, at a grid of sizes."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import Enum, StrEnum

import numpy as np

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import Effect
from gyrodrift.diagnose.features.design_matrix import DesignMatrix
from gyrodrift.values.arrays import Floats

Shape = Callable[[DesignMatrix, np.random.Generator], Floats]
"""Function of a session's design matrix and a random generator: rate to add at size 1, deg/s, shape (n,)."""


class Need(StrEnum):
    """Data that recordings need for an effect to be visible."""

    MOTION = "motion"
    TEMPERATURE = "temperature"
    HOST = "host"
    COUNTER = "counter"
    AXES = "axes"


class Touches(Enum):
    """Parts of a recording that an effect changes; all other features are copied from a simulation without it.

    TIMES        stamps and arrivals, but no rate and no angle
    SLOW_RATE    rate, by a disturbance that is slow compared with a sample: no noise, no sample numbers, no times
    RATE         rate, also from sample to sample: no sample numbers, no times
    VALUES       rates and angles: no sample numbers, no times
    EVERYTHING   anything
    """

    TIMES = "times"
    SLOW_RATE = "slow rate"
    RATE = "rate"
    VALUES = "values"
    EVERYTHING = "everything"


@dataclass(frozen=True, slots=True)
class Candidate:
    """An effect with its second parameter fixed, or an out-of-catalog model, at a grid of sizes.

    variant
        Label of the second parameter; unique among candidates of one name.
    make
        Function from a size to the effect.
    parameter
        Name of the parameter that is the size.
    grid_points
        Simulated sizes, ascending; 0 means no effect. Responses between them are interpolated.
    sizes
        Sizes of the fit, ascending.
    group
        Name of a group of effects with similar responses.
    needs, touches, realisations, is_exact, phase_deg
        As in `CandidateKind` and `Variant`.
    is_phase_free
        Whether every session has its own phase, as with an encoder that is zeroed anywhere.
    in_rig
        Effect of the same name in the rig, which `make` changes; None if the rig has none. Sizes of a linear effect are
        then additions to the size in the rig.
    shape
        Rate that an out-of-catalog model adds; None for an effect of the catalog.
    ruled_out
        Number of sizes that a recording rules out. They are no part of `sizes`, but they had their prior probability.
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
    ruled_out: int = 0

    def up_to(self, points: int) -> "Candidate":
        """The candidate at its first grid points only, if a recording rules out larger sizes."""
        if points == len(self.grid_points):
            return self
        kept = self.sizes <= self.grid_points[points - 1]
        return replace(
            self,
            grid_points=self.grid_points[:points],
            sizes=self.sizes[kept],
            ruled_out=self.ruled_out + int(np.count_nonzero(~kept)),
        )

    @property
    def stage(self) -> str:
        """Stage of the rig at which the effect acts."""
        return CATALOGUE[self.name].stage

    @property
    def is_out_of_catalogue(self) -> bool:
        """Whether this is a model outside of the catalog of effects."""
        return self.shape is not None

    def applied(self, size: float, effects: Sequence[Effect]) -> Effect:
        """The effect of a size, at the phase of this session; `effects` are those of the session's rig."""
        return self.at_rig_phase(self.make(size), effects)

    def at_rig_phase(self, effect: Effect, effects: Sequence[Effect]) -> Effect:
        """An effect at the phase of the rig's effect of this name; unchanged if that has no phase."""
        phase_deg = self._phase_deg(effects)
        return effect if phase_deg is None else effect.model_copy(update={"phase_deg": phase_deg})

    def added(self, size: float, effects: Sequence[Effect]) -> Effect:
        """The effect to add to the rate: for an effect that the rig has, only the difference from the rig's size."""
        if self.in_rig is None:
            return self.make(size)
        phase_deg = self._phase_deg(effects)
        if phase_deg is None:
            return self.in_rig.model_copy(update={self.parameter: size})
        signed_phase_deg = phase_deg + (180.0 if size < 0.0 else 0.0)
        return self.in_rig.model_copy(update={self.parameter: abs(size), "phase_deg": signed_phase_deg})

    def _phase_deg(self, effects: Sequence[Effect]) -> float | None:
        """Phase of the rig's effect of this name, degrees; None if it has no phase, or the rig lacks the effect."""
        own = next((effect for effect in effects if effect.name == self.name), None) if self.in_rig else None
        return None if own is None else own.model_dump().get("phase_deg")
