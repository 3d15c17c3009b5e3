"""What may be true of a device: a rig for each explanation that the recordings so far leave open."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from firmware_sim.rig import Rig
from gyrodrift.arrays import Floats

NOTHING = "nothing"
"""Name of the hypothesis that the rig as it stands explains the sessions."""


@dataclass(frozen=True, slots=True)
class RigHypothesis:
    """One explanation.

    name
        Of the cause, as a report names it, or NOTHING.
    rig
        The rig as it stands, with that cause at its fitted size, and with the noise that was calibrated beside it.
    weight
        Its posterior probability; those of all hypotheses need not add up to 1.
    """

    name: str
    rig: Rig
    weight: float


def weights_of(hypotheses: Sequence[RigHypothesis]) -> Floats:
    """Their probabilities among each other, (H,).

    Raises
    ------
    ValueError
        Where there are fewer than two, or a weight is not above 0.
    """
    weights = np.array([one.weight for one in hypotheses])
    if len(weights) < 2:
        raise ValueError("there have to be two hypotheses, or there is nothing to tell apart")
    if not (np.isfinite(weights).all() and (weights > 0.0).all()):
        raise ValueError("the weight of each hypothesis has to be above 0")
    shares: Floats = weights / weights.sum()
    return shares


def common_rig(hypotheses: Sequence[RigHypothesis]) -> Rig:
    """The rig as it stands: the base of the first, and the effects that all of them share."""
    first, *others = (one.rig for one in hypotheses)
    shared = tuple(effect for effect in first.effects if all(effect in rig.effects for rig in others))
    return first.model_copy(update={"effects": shared})
