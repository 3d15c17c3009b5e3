"""What to do next: a motion that tells apart what is open, or a sentence where no motion would."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import Effect
from firmware_sim.rig import Rig, with_replaced
from gyrodrift.diagnose.inference.detectable import detectable
from gyrodrift.diagnose.inference.explanation import Explanation
from gyrodrift.diagnose.inference.verdict import Kind, Verdict
from gyrodrift.diagnose.next_recording.choose import next_recording_of
from gyrodrift.diagnose.next_recording.profiles import profile_yaml
from gyrodrift.diagnose.next_recording.rig_hypothesis import NOTHING, RigHypothesis
from gyrodrift.diagnose.next_recording.sentence import sentence
from gyrodrift.diagnose.next_recording.simulated_features import PlannedMotion
from gyrodrift.diagnose.regime_words import WHEN
from gyrodrift.diagnose.result import Untestable
from gyrodrift.diagnose.simulate.candidates import KINDS
from gyrodrift.diagnose.simulate.twin import Subject

FILE = "next-profile.yaml"
"""Beside `rig.yaml`."""

SEED = 0
MINUTES = (1.0, 4.0)
"""A proposed recording is as long as those so far, within these bounds."""

MOST_HYPOTHESES = 3
DOUBT = 0.1
"""Probability that is given to an effect of typical size that these sessions would not have shown."""

SMALL_SHARE = 0.5
"""Of its typical size, below which an effect that would have been seen is no open question."""

ENOUGH_SESSIONS = 3
"""With two, sizes are fitted on one alone."""


class Next(NamedTuple):
    """A sentence, and the file of a profile where a motion is proposed."""

    sentence: str
    profile_yaml: str | None


def what_next(
    verdict: Verdict,
    explanation: Explanation,
    subjects: Sequence[Subject],
    untestable: Sequence[Untestable],
    rig: Rig,
    jobs: int,
) -> Next:
    """The experiment that decides, chosen by so many processes, or else what there is to say."""
    open_ones = _open(verdict, explanation, subjects, rig)
    if len(open_ones) < 2:
        return Next(_without_experiment(verdict, untestable, len(subjects)), None)
    minutes = round(float(np.clip(np.median([one.seen.recording.seconds / 60.0 for one in subjects]), *MINUTES)), 1)
    recorded = PlannedMotion(subjects[0].posterior.mean, min(minutes, subjects[0].seen.recording.seconds / 60.0))
    found = next_recording_of(open_ones, minutes, SEED, recorded, jobs)
    return Next(sentence(found, FILE), profile_yaml(found.profile))


def _open(
    verdict: Verdict, explanation: Explanation, subjects: Sequence[Subject], rig: Rig
) -> tuple[RigHypothesis, ...]:
    """What the sessions leave open: causes that are tied or show too weakly, or effects that could not have shown."""
    base = subjects[0].rig.base
    calibrated = rig.model_copy(update={"base": base})
    tied = next((cause for cause in verdict.causes if cause.tied_with), None)
    if tied is not None:
        placed = [explanation.where_best(name) for name in tied.tied_with[: MOST_HYPOTHESES - 1]]
        rivals = [one.response.candidate.make(one.size) for one in placed if one is not None]
        others = [cause.effect for cause in verdict.causes if cause is not tied]
        return tuple(
            RigHypothesis(effect.name, with_replaced(calibrated, (*others, effect)), 1.0)
            for effect in (tied.effect, *rivals)
        )
    if verdict.causes:
        return ()
    shown = explanation.possible()[: MOST_HYPOTHESES - 1]
    possible = [placed.response.candidate.make(placed.size) for placed in shown]
    doubt = 1.0 / (1.0 + len(possible))
    if verdict.kind is Kind.NONE and not possible:
        possible, doubt = _unseen(explanation, rig), DOUBT
    nothing = RigHypothesis(NOTHING, calibrated, 1.0 - doubt * len(possible))
    return (nothing, *(RigHypothesis(one.name, with_replaced(calibrated, (one,)), doubt) for one in possible))


def _unseen(explanation: Explanation, rig: Rig) -> list[Effect]:
    """Effects that would have gone unseen at their typical size, the worst seen first."""
    in_rig = {effect.name for effect in rig.effects}
    ratios: list[tuple[float, Effect]] = []
    for one in detectable(explanation.scorer, explanation.evidence.effects()):
        typical, kind = CATALOGUE[one.effect].typical, KINDS[one.effect]
        if one.effect in in_rig or kind.is_read_off:
            continue
        least = np.inf if one.value is None else one.value / typical[one.parameter]
        if one.value is not None and kind.less_is_more:
            least = 1.0 / least
        if least > 1.0 / SMALL_SHARE:
            effect = CATALOGUE[one.effect].model_validate({"name": one.effect, **typical})
            ratios.append((least, effect))
    ratios.sort(key=lambda pair: -pair[0])
    return [effect for _, effect in ratios[: MOST_HYPOTHESES - 1]]


def _without_experiment(verdict: Verdict, untestable: Sequence[Untestable], sessions: int) -> str:
    if sessions < ENOUGH_SESSIONS:
        return "Record more sessions: with three and more the fit can be checked on what it has not seen."
    if untestable:
        lacking = untestable[0]
        return (
            f"Record with a device that sends more: {lacking.why} in these sessions, so that {lacking.effect} cannot "
            "be tested."
        )
    if verdict.unexplained:
        worst = verdict.unexplained[0]
        return (
            f"Record more in which the unexplained shows ({worst.says}, {WHEN[worst.regime]}), at several speeds and "
            "temperatures."
        )
    return "Nothing: no ambiguity remains. Record again after a change."
