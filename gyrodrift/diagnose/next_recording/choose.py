"""Which motion to record next: the two manoeuvres that together tell the hypotheses apart best.

All manoeuvres are simulated briefly and seldom, the better half of them more often (successive halving). The best of
them is joined by the one that adds most to it. The best pairs are simulated as they would be played, unless one tells
all there is already. What is predicted of the chosen one comes from realisations that had no part in choosing it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from firmware_sim.motion.profile import Profile
from firmware_sim.rig import Rig
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.next_recording.information import (
    Told,
    entropy,
    held_out_log_likelihoods,
    information_bound,
    told_by,
)
from gyrodrift.diagnose.next_recording.manoeuvres import FAMILY, Manoeuvre, MotionLimits, limits_of
from gyrodrift.diagnose.next_recording.profiles import profile_of
from gyrodrift.diagnose.next_recording.simulated_features import (
    PlannedMotion,
    RigHypothesis,
    common_rig,
    simulated_features,
    weights_of,
)
from gyrodrift.parallel import LocalWorkers, workers

SCREENED, FINAL, PREDICTED, COMPARED = 2, 3, 5, 3
"""Realisations: of each manoeuvre, and as many more of the better half; of the best pairs; of the chosen one; of what
it is compared with."""

NEARLY_ALL = 0.99
"""A share of what there is to tell from which on no more is simulated to choose."""


@dataclass(frozen=True, slots=True)
class NextRecording:
    """What to record.

    names
        Of the hypotheses, the most probable first.
    minutes
        Length of the recording.
    manoeuvres, limits
        What it is made of, and within what.
    profile
        The motion.
    open_bits
        What there is to be told, bits.
    predicted
        What one session of it tells.
    again
        What one more session of what was recorded so far tells; None where that was not given.
    """

    names: tuple[str, ...]
    minutes: float
    manoeuvres: tuple[Manoeuvre, ...]
    limits: MotionLimits
    profile: Profile
    open_bits: float
    predicted: Told
    again: Told | None

    @property
    def is_worth_it(self) -> bool:
        """Whether it tells enough to be recorded."""
        return self.predicted.information > 0.2 * self.open_bits  # less is not worth the time of the table

    @property
    def is_better_than_again(self) -> bool:
        """Whether it tells at least what one more session of what was recorded so far does."""
        return self.again is None or self.predicted.information >= self.again.information


class _Played(NamedTuple):
    """A motion that is simulated so many times, in a stage of the choice."""

    planned: PlannedMotion
    stage: int
    realisations: int


@dataclass(frozen=True, slots=True)
class _Question:
    """What is to be told apart, and with what random numbers."""

    rigs: tuple[Rig, ...]
    base: Rig
    weights: Floats
    seed: int

    def log_likelihoods(self, played: _Played) -> Floats:
        """(R, H, H) as held-out realisations have it; each stage has random numbers of its own."""
        stream = int(np.random.SeedSequence([self.seed, played.stage]).generate_state(1)[0])
        return held_out_log_likelihoods(
            simulated_features(self.rigs, self.base, played.planned, stream, played.realisations)
        )

    def worth(self, log_likelihoods: Floats, manoeuvres: Sequence[Manoeuvre]) -> float:
        """By which motions are compared, bits."""
        # Warming the air has to tell more than a motion without.
        effort = 0.05 * any(one.warms_air for one in manoeuvres)
        return information_bound(log_likelihoods, self.weights) - effort

    def is_answered(self, log_likelihoods: Floats) -> bool:
        """Whether there is hardly more to tell."""
        return information_bound(log_likelihoods, self.weights) > NEARLY_ALL * entropy(self.weights)


_FIRST, _MORE, _PAIRS, _PREDICTED = range(4)
"""Stages."""


@dataclass(frozen=True, slots=True)
class _Answers:
    """What motions tell of a question, many at a time."""

    question: _Question
    local: LocalWorkers

    def to(self, every: Sequence[_Played]) -> list[Floats]:
        """Log-likelihoods of each."""
        return list(self.local.map(self.question.log_likelihoods, every))

    def told(self, every: Sequence[_Played]) -> list[Told]:
        """What each tells."""
        return [told_by(found, self.question.weights) for found in self.to(every)]


def next_recording_of(
    hypotheses: Sequence[RigHypothesis], minutes: float, seed: int, recorded: PlannedMotion | None = None, jobs: int = 1
) -> NextRecording:
    """Choose what to record, so that the features tell which hypothesis holds.

    hypotheses
        What the recordings so far leave open.
    minutes
        Length of the next recording.
    seed
        Of all that is random; the same one gives the same choice.
    recorded
        A motion that was recorded so far, to be compared with.
    jobs
        So many processes simulate.

    Raises
    ------
    ValueError
        Where there are fewer than two hypotheses, or the recording would be too short.
    """
    base = common_rig(hypotheses)
    question = _Question(tuple(one.rig for one in hypotheses), base, weights_of(hypotheses), seed)
    limits, shown = limits_of(base.base), min(minutes, 4.0)  # longer recordings tell at least as much
    with workers(jobs) as local:
        answers = _Answers(question, local)
        chosen = _chosen(answers, shown, limits)
        proposed = PlannedMotion(profile_of(chosen, shown, limits), shown)
        compared = [] if recorded is None else [_Played(recorded, _PREDICTED, COMPARED)]
        predicted, *again = answers.told([_Played(proposed, _PREDICTED, PREDICTED), *compared])
    return NextRecording(
        names=tuple(one.name for one in sorted(hypotheses, key=lambda one: -one.weight)),
        minutes=minutes,
        manoeuvres=chosen,
        limits=limits,
        profile=profile_of(chosen, minutes, limits),
        open_bits=entropy(question.weights),
        predicted=predicted,
        again=again[0] if again else None,
    )


def _chosen(answers: _Answers, minutes: float, limits: MotionLimits) -> tuple[Manoeuvre, ...]:
    """The pair that tells most."""
    question, shown = answers.question, _screened(answers, minutes, limits)

    def alone(one: Manoeuvre) -> float:
        return question.worth(shown[one], (one,))

    first = max(shown, key=alone)

    def beside_first(one: Manoeuvre) -> float:
        realisations = min(len(shown[first]), len(shown[one]))
        return question.worth(shown[first][:realisations] + shown[one][:realisations], (first, one))

    others = sorted((one for one in shown if one is not first), key=beside_first, reverse=True)
    if question.is_answered(shown[first]):
        return first, others[0]
    pairs = [(first, other) for other in others[:3]]  # the best three are simulated as they would be played
    planned = [PlannedMotion(profile_of(pair, minutes, limits), minutes) for pair in pairs]
    found = answers.to([_Played(one, _PAIRS, FINAL) for one in planned])
    worth = [question.worth(one, pair) for one, pair in zip(found, pairs, strict=True)]
    return pairs[int(np.argmax(worth))]


def _screened(answers: _Answers, minutes: float, limits: MotionLimits) -> dict[Manoeuvre, Floats]:
    """Log-likelihoods of each manoeuvre by itself; of the better half alone, where none tells all."""
    # As long as in a pair, within 1 to 1.5 min.
    question, brief = answers.question, float(np.clip(0.5 * minutes, 1.0, 1.5))

    def simulated(every: Sequence[Manoeuvre], stage: int) -> dict[Manoeuvre, Floats]:
        planned = [PlannedMotion(profile_of((one,), brief, limits), brief) for one in every]
        return dict(zip(every, answers.to([_Played(one, stage, SCREENED) for one in planned]), strict=True))

    shown = simulated(FAMILY, _FIRST)
    ranked = sorted(FAMILY, key=lambda one: question.worth(shown[one], (one,)), reverse=True)
    if question.is_answered(shown[ranked[0]]):
        return shown
    better = ranked[: len(FAMILY) // 2]
    more = simulated(better, _MORE)
    return {one: np.concatenate([shown[one], more[one]]) for one in better}
