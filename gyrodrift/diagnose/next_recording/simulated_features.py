"""Features of a motion under each hypothesis, from a few simulations.

A diagnosis calibrates the bias to each recording, so the bias says nothing about a hypothesis. The bias of each rig is
therefore shifted until its recordings show the same bias as those of the common rig.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from firmware_sim.measure import Motion
from firmware_sim.rig import Rig
from gyrodrift.diagnose.features.feature import Measured
from gyrodrift.diagnose.recording.recording import recording_of
from gyrodrift.diagnose.simulate.twin import subject_of
from gyrodrift.simulation.sessions import Simulation
from gyrodrift.values.arrays import Floats

NOTHING = "nothing"
"""Name of the hypothesis that no cause is missing in the rig."""


@dataclass(frozen=True, slots=True)
class RigHypothesis:
    """A possible explanation of the recordings.

    name
        Name of the cause in the report, or NOTHING.
    rig
        The calibrated rig, with the cause at its fitted size.
    weight
        Posterior probability; the weights of all hypotheses need not add up to 1.
    """

    name: str
    rig: Rig
    weight: float


def weights_of(hypotheses: Sequence[RigHypothesis]) -> Floats:
    """(H,) probabilities of the hypotheses, which add up to 1.

    Raises
    ------
    ValueError
        If there are fewer than two hypotheses, or a weight is not above 0.
    """
    weights = np.array([hypothesis.weight for hypothesis in hypotheses])
    if len(weights) < 2:
        raise ValueError("there have to be two hypotheses, or there is nothing to tell apart")
    if not (np.isfinite(weights).all() and (weights > 0.0).all()):
        raise ValueError("the weight of each hypothesis has to be above 0")
    shares: Floats = weights / weights.sum()
    return shares


def common_rig(hypotheses: Sequence[RigHypothesis]) -> Rig:
    """The rig that all hypotheses share: the base of the first rig, and the effects that all rigs have."""
    first, *remaining = (hypothesis.rig for hypothesis in hypotheses)
    shared = tuple(effect for effect in first.effects if all(effect in rig.effects for rig in remaining))
    return first.model_copy(update={"effects": shared})


@dataclass(frozen=True, slots=True)
class PlannedMotion:
    """A motion, which is a profile or a motion rebuilt from a recording, and the length of its recording, min."""

    motion: Motion
    minutes: float


@dataclass(frozen=True, slots=True, eq=False)
class SimulatedFeatures:
    """F features of a motion under H hypotheses, in R realizations.

    values
        (H, R, F) features; all hypotheses share the random numbers of a realization.
    thresholds
        (F,) relevance thresholds.
    base
        (F,) features of the common rig, with the random numbers of the first realization.
    """

    values: Floats = field(repr=False)
    thresholds: Floats = field(repr=False)
    base: Floats = field(repr=False)


def simulated_features(
    rigs: Sequence[Rig], base: Rig, planned: PlannedMotion, seed: int, realisations: int
) -> SimulatedFeatures:
    """Features of simulated sessions in which each rig plays the motion.

    Each session is calibrated by itself, as a recording is.
    """

    def simulate(rig: Rig, realization: int) -> _SimulatedSession:
        return _simulated_session(rig, base, planned, seed, realization)

    common = simulate(base, 0)
    rows = []
    for rig in rigs:
        shifted, first = (base, common) if rig == base else _with_bias(rig, common.bias_dps, simulate)
        rows.append([first, *(simulate(shifted, realization) for realization in range(1, realisations))])
    values = np.array([[session.measured.values for session in row] for row in rows])
    thresholds = np.array([session.measured.thresholds for row in rows for session in row])
    return SimulatedFeatures(values, np.median(thresholds, axis=0), common.measured.values)


class _SimulatedSession(NamedTuple):
    """Features of a session, and the bias that was calibrated to it, deg/s."""

    measured: Measured
    bias_dps: float


def _simulated_session(rig: Rig, base: Rig, planned: PlannedMotion, seed: int, realization: int) -> _SimulatedSession:
    """Simulate a session of `rig` and diagnose it with `base` as the simulator."""
    session = Simulation(rig, planned.motion, seed, realization, planned.minutes).whole()
    subject = subject_of(recording_of(session), base)
    return _SimulatedSession(subject.measured(), subject.rig.base.bias_dps)


def _with_bias(
    rig: Rig, bias_dps: float, simulate: Callable[[Rig, int], _SimulatedSession]
) -> tuple[Rig, _SimulatedSession]:
    """The rig with a bias whose calibration gives `bias_dps`, and its first session."""
    first = simulate(rig, 0)
    off_dps = first.bias_dps - bias_dps
    if abs(off_dps) < 0.002:  # 0.12 deg in a minute
        return rig, first
    base = rig.base.model_copy(update={"bias_dps": rig.base.bias_dps - off_dps})
    shifted = rig.model_copy(update={"base": base})
    repeated = simulate(shifted, 0)
    # A shift that leaves more than a fifth does not help: a dead band hides the bias.
    is_nearer = abs(repeated.bias_dps - bias_dps) < 0.2 * abs(off_dps)
    return (shifted, repeated) if is_nearer else (rig, first)
