"""The motion to record next: the pair of maneuvers that separates the hypotheses best.

1. Every maneuver is simulated briefly and a few times, and the better half once more (successive halving).
2. The best maneuver is paired with every other maneuver. The information of a pair is estimated from the sum of the
   log-likelihoods of its maneuvers.
3. The best pairs are simulated as whole motions. This step is skipped if the best maneuver already answers the
   question.

The prediction for the chosen pair uses new realizations, because realizations that choose a motion also flatter it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from firmware_sim.motion.profile import Profile
from firmware_sim.rig import Rig
from gyrodrift.diagnose.next_recording.information import (
    Discrimination,
    discrimination_of,
    entropy,
    held_out_log_likelihoods,
    information_bound,
)
from gyrodrift.diagnose.next_recording.maneuvers import FAMILY, Maneuver, MotionLimits, limits_of
from gyrodrift.diagnose.next_recording.profiles import profile_of
from gyrodrift.diagnose.next_recording.simulated_features import (
    PlannedMotion,
    RigHypothesis,
    common_rig,
    simulated_features,
    weights_of,
)
from gyrodrift.io.parallel import Workers, workers
from gyrodrift.values.arrays import Floats

SCREENED, FINAL, PREDICTED, COMPARED = 2, 3, 5, 3
"""Numbers of realizations of a motion: in each round of screening, among the best pairs, for the prediction, and for
the recorded motion in comparison. Chosen: for speed, with most for the prediction, since it is reported."""

NEARLY_ALL = 0.99
"""Share of the entropy of the hypotheses. Chosen: a motion with more information than this answers the question."""


@dataclass(frozen=True, slots=True)
class NextRecording:
    """The motion to record next, and how well it separates the hypotheses.

    names
        Names of the hypotheses, the most probable first.
    minutes
        Length of the recording.
    maneuvers, limits
        Maneuvers of the motion, and their limits.
    profile
        The motion.
    open_bits
        Entropy of the hypotheses, bits: the most information that a recording can give.
    predicted
        Discrimination by one session of this motion.
    repeated
        Discrimination by one more session of the motion recorded so far; None if that motion was not given.
    """

    names: tuple[str, ...]
    minutes: float
    maneuvers: tuple[Maneuver, ...]
    limits: MotionLimits
    profile: Profile
    open_bits: float
    predicted: Discrimination
    repeated: Discrimination | None

    @property
    def is_worth_it(self) -> bool:
        """Whether the motion gives enough information to be recorded."""
        return self.predicted.information > 0.2 * self.open_bits  # less is not worth the time of the table

    @property
    def is_better_than_repeating(self) -> bool:
        """Whether the motion gives at least the information of one more session of the recorded motion."""
        return self.repeated is None or self.predicted.information >= self.repeated.information


class _Trial(NamedTuple):
    """A motion, the stage of the choice that simulates it, and the number of realizations."""

    planned: PlannedMotion
    stage: int
    realisations: int


@dataclass(frozen=True, slots=True)
class _Question:
    """Rigs of the hypotheses, their common rig, their probabilities, and the seed of the simulations."""

    rigs: tuple[Rig, ...]
    base: Rig
    weights: Floats
    seed: int

    def log_likelihoods(self, trial: _Trial) -> Floats:
        """(R, H, H) held-out log-likelihoods of a trial. Each stage has its own random numbers."""
        stream = int(np.random.SeedSequence([self.seed, trial.stage]).generate_state(1)[0])
        return held_out_log_likelihoods(
            simulated_features(self.rigs, self.base, trial.planned, stream, trial.realisations)
        )

    def worth(self, log_likelihoods: Floats, maneuvers: Sequence[Maneuver]) -> float:
        """Score of a motion, bits: lower bound of its information, minus a penalty if it warms the air.

        The penalty stands for the effort, so a motion that warms the air is chosen only if it gives more information.
        """
        effort = 0.05 * any(maneuver.warms_air for maneuver in maneuvers)
        return information_bound(log_likelihoods, self.weights) - effort

    def is_answered(self, log_likelihoods: Floats) -> bool:
        """Whether a motion gives nearly all information that there is."""
        return information_bound(log_likelihoods, self.weights) > NEARLY_ALL * entropy(self.weights)


_FIRST, _SECOND, _PAIRS, _PREDICTED = range(4)
"""Stages of the choice: screening of all maneuvers, screening of the better half, the best pairs, the prediction."""


@dataclass(frozen=True, slots=True)
class _Simulator:
    """Simulates trials of a question in parallel."""

    local: Workers[_Question]

    @property
    def question(self) -> _Question:
        """The question, which the processes inherit."""
        return self.local.inherited

    def log_likelihoods(self, trials: Sequence[_Trial]) -> list[Floats]:
        """(R, H, H) held-out log-likelihoods of each trial."""
        return list(self.local.map(_Question.log_likelihoods, trials))

    def discriminations(self, trials: Sequence[_Trial]) -> list[Discrimination]:
        """Discrimination by each trial."""
        return [discrimination_of(logs, self.question.weights) for logs in self.log_likelihoods(trials)]


def next_recording_of(
    hypotheses: Sequence[RigHypothesis], minutes: float, seed: int, recorded: PlannedMotion | None = None, jobs: int = 1
) -> NextRecording:
    """Choose the motion whose features separate the hypotheses best.

    hypotheses
        Hypotheses that the recordings so far leave open.
    minutes
        Length of the next recording.
    seed
        Seed of all random numbers; equal seeds give equal choices.
    recorded
        Motion recorded so far, for comparison.
    jobs
        Number of processes that simulate.

    Raises
    ------
    ValueError
        If there are fewer than two hypotheses, or the recording would be too short.
    """
    base = common_rig(hypotheses)
    question = _Question(tuple(hypothesis.rig for hypothesis in hypotheses), base, weights_of(hypotheses), seed)
    # A longer recording gives at least as much information, so at most 4 min are simulated.
    limits, simulated_minutes = limits_of(base.base), min(minutes, 4.0)
    with workers(jobs, question) as local:
        simulator = _Simulator(local)
        chosen = _chosen(simulator, simulated_minutes, limits)
        proposed = PlannedMotion(profile_of(chosen, simulated_minutes, limits), simulated_minutes)
        compared = [] if recorded is None else [_Trial(recorded, _PREDICTED, COMPARED)]
        predicted, *repeated = simulator.discriminations([_Trial(proposed, _PREDICTED, PREDICTED), *compared])
    return NextRecording(
        names=tuple(hypothesis.name for hypothesis in sorted(hypotheses, key=lambda hypothesis: -hypothesis.weight)),
        minutes=minutes,
        maneuvers=chosen,
        limits=limits,
        profile=profile_of(chosen, minutes, limits),
        open_bits=entropy(question.weights),
        predicted=predicted,
        repeated=repeated[0] if repeated else None,
    )


def _chosen(simulator: _Simulator, minutes: float, limits: MotionLimits) -> tuple[Maneuver, ...]:
    """The pair of maneuvers with the highest score."""
    question, screened = simulator.question, _screened(simulator, minutes, limits)

    def worth_alone(maneuver: Maneuver) -> float:
        return question.worth(screened[maneuver], (maneuver,))

    first = max(screened, key=worth_alone)

    def worth_with_first(maneuver: Maneuver) -> float:
        realisations = min(len(screened[first]), len(screened[maneuver]))
        return question.worth(screened[first][:realisations] + screened[maneuver][:realisations], (first, maneuver))

    partners = sorted((maneuver for maneuver in screened if maneuver is not first), key=worth_with_first, reverse=True)
    if question.is_answered(screened[first]):
        return first, partners[0]
    pairs = [(first, partner) for partner in partners[:3]]  # the best three are simulated as whole motions
    planned = [PlannedMotion(profile_of(pair, minutes, limits), minutes) for pair in pairs]
    log_likelihoods = simulator.log_likelihoods([_Trial(motion, _PAIRS, FINAL) for motion in planned])
    worth = [question.worth(logs, pair) for logs, pair in zip(log_likelihoods, pairs, strict=True)]
    return pairs[int(np.argmax(worth))]


def _screened(simulator: _Simulator, minutes: float, limits: MotionLimits) -> dict[Maneuver, Floats]:
    """Log-likelihoods of single maneuvers: all of them if the best answers the question, else the better half."""
    # Half of the motion, as in a pair, but within 1 to 1.5 min.
    question, brief_minutes = simulator.question, float(np.clip(0.5 * minutes, 1.0, 1.5))

    def simulated(maneuvers: Sequence[Maneuver], stage: int) -> dict[Maneuver, Floats]:
        planned = [
            PlannedMotion(profile_of((maneuver,), brief_minutes, limits), brief_minutes) for maneuver in maneuvers
        ]
        trials = [_Trial(motion, stage, SCREENED) for motion in planned]
        return dict(zip(maneuvers, simulator.log_likelihoods(trials), strict=True))

    first_round = simulated(FAMILY, _FIRST)
    ranked = sorted(FAMILY, key=lambda maneuver: question.worth(first_round[maneuver], (maneuver,)), reverse=True)
    if question.is_answered(first_round[ranked[0]]):
        return first_round
    better = ranked[: len(FAMILY) // 2]
    second_round = simulated(better, _SECOND)
    return {maneuver: np.concatenate([first_round[maneuver], second_round[maneuver]]) for maneuver in better}
