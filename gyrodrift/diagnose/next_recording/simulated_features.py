"""Features that a motion would show under each hypothesis, by simulating it a few times.

The bias of a device is calibrated in each recording, and tells nothing. So it is not left to the hypotheses: each
rig's bias is shifted until a recording of it shows the same one as the rig that all share.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from firmware_sim.measure import Motion
from firmware_sim.rig import Rig
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.feature import Measured
from gyrodrift.diagnose.recording.recording import recording_of
from gyrodrift.diagnose.simulate.twin import subject_of
from gyrodrift.simulation.sessions import Simulation

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


@dataclass(frozen=True, slots=True)
class PlannedMotion:
    """A motion and how long it is recorded, min; a profile, or what was recorded so far."""

    motion: Motion
    minutes: float


@dataclass(frozen=True, slots=True, eq=False)
class SimulatedFeatures:
    """Of one motion, H hypotheses, R realisations, F features.

    values
        (H, R, F); all hypotheses share the random numbers of a realisation.
    thresholds
        (F,) relevance thresholds.
    base
        (F,) of the rig that all hypotheses share, with the random numbers of the first realisation.
    """

    values: Floats = field(repr=False)
    thresholds: Floats = field(repr=False)
    base: Floats = field(repr=False)


def simulated_features(
    rigs: Sequence[Rig], base: Rig, planned: PlannedMotion, seed: int, realisations: int
) -> SimulatedFeatures:
    """Features of sessions in which each rig plays the motion; each is calibrated by itself, as a recording is."""

    def seen(rig: Rig, number: int) -> _Seen:
        return _seen(rig, base, planned, seed, number)

    common = seen(base, 0)
    rows = []
    for rig in rigs:
        alike, first = (base, common) if rig == base else _of_the_same_bias(rig, common.bias_dps, seen)
        rows.append([first, *(seen(alike, number) for number in range(1, realisations))])
    values = np.array([[one.measured.values for one in row] for row in rows])
    thresholds = np.array([one.measured.thresholds for row in rows for one in row])
    return SimulatedFeatures(values, np.median(thresholds, axis=0), common.measured.values)


class _Seen(NamedTuple):
    """Features of a session, and the bias that was calibrated to it, deg/s."""

    measured: Measured
    bias_dps: float


def _seen(rig: Rig, base: Rig, planned: PlannedMotion, seed: int, number: int) -> _Seen:
    """One session that a rig makes of a motion, as a diagnosis that takes the device for `base` sees it."""
    session = Simulation(rig, planned.motion, seed, number, planned.minutes).whole()
    subject = subject_of(recording_of(session), base)
    return _Seen(subject.measured(), subject.rig.base.bias_dps)


def _of_the_same_bias(rig: Rig, bias_dps: float, seen: Callable[[Rig, int], _Seen]) -> tuple[Rig, _Seen]:
    """The rig with a bias that makes recordings show this one, and its first session."""
    first = seen(rig, 0)
    off_dps = first.bias_dps - bias_dps
    if abs(off_dps) < 0.002:  # 0.12 deg in a minute
        return rig, first
    shifted = rig.base.model_copy(update={"bias_dps": rig.base.bias_dps - off_dps})
    alike = rig.model_copy(update={"base": shifted})
    again = seen(alike, 0)
    # A shift that leaves more is none of the bias: a dead band hides it.
    comes_nearer = abs(again.bias_dps - bias_dps) < 0.2 * abs(off_dps)
    return (alike, again) if comes_nearer else (rig, first)
