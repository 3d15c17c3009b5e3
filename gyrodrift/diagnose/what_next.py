"""The next step: a motion that separates open hypotheses, or a sentence if no motion does."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import Effect
from firmware_sim.rig import Rig, with_replaced
from gyrodrift.diagnose.features.feature import WHEN
from gyrodrift.diagnose.inference.detectable import detectable
from gyrodrift.diagnose.inference.explanation import Explanation
from gyrodrift.diagnose.inference.scorer import Placed
from gyrodrift.diagnose.inference.verdict import Kind, NamedCause, Verdict
from gyrodrift.diagnose.next_recording.choose import NextRecording, next_recording_of
from gyrodrift.diagnose.next_recording.information import Discrimination
from gyrodrift.diagnose.next_recording.profiles import STILL_S, profile_yaml, warmer_c
from gyrodrift.diagnose.next_recording.simulated_features import NOTHING, PlannedMotion, RigHypothesis
from gyrodrift.diagnose.result import Untestable
from gyrodrift.diagnose.simulate.candidates import KINDS
from gyrodrift.diagnose.simulate.twin import Subject

MOST = 0.99
"""Largest probability that is stated. Chosen: it comes from a few simulations."""


def sentence(recording: NextRecording, file: str) -> str:
    """The sentence for `next`; `file` is where the profile is written."""
    what, probability = _question(recording.names), _stated(recording.predicted)
    if recording.repeated is not None and not recording.is_better_than_repeating:
        return (
            f"Record {recording.minutes:g} min more of the same: it tells {what} with probability "
            f"{_stated(recording.repeated)}; {file} would with {probability}."
        )
    again = "" if recording.repeated is None else f"; more of the same would with {_stated(recording.repeated)}"
    if not recording.is_worth_it:
        return (
            f"No motion of {recording.minutes:g} min tells {what}: the best, {file}, does so with probability "
            f"{probability}. Record longer and more often."
        )
    words = " and ".join(maneuver.says(recording.limits) for maneuver in recording.maneuvers)
    return (
        f"Switch the device on and play {file} ({recording.minutes:g} min: {words}){_warming(recording)}: "
        f"it tells {what} with probability {probability}{again}."
    )


def _stated(predicted: Discrimination) -> str:
    return f"{min(predicted.probability, MOST):.2f}"


def _question(names: Sequence[str]) -> str:
    """The question in words, such as `bandwidth from latency` or `whether there is deadband`."""
    causes = [name for name in names if name != NOTHING]
    if len(causes) < len(names):
        return f"whether there is {_listed(causes, 'or')}"
    return f"{causes[0]} from {_listed(causes[1:], 'and')}"


def _listed(names: Sequence[str], joint: str) -> str:
    *first, last = names
    return f"{', '.join(first)} {joint} {last}" if first else last


def _warming(recording: NextRecording) -> str:
    """Words on when to warm the air, because a table does not do that; empty if no maneuver warms it."""
    seconds = (60.0 * recording.minutes - STILL_S) / len(recording.maneuvers)
    starts_s = [STILL_S + number * seconds for number, maneuver in enumerate(recording.maneuvers) if maneuver.warms_air]
    if not starts_s:
        return ""
    times = " and ".join(f"from {start_s:.0f} to {start_s + 0.5 * seconds:.0f} s" for start_s in starts_s)
    return f", and warm the air by {warmer_c(seconds):.0f} °C {times} and let it cool"


FILE = "next-profile.yaml"
"""Name of the file of the profile, in the folder of `rig.yaml`."""

SEED = 0
"""Seed of the simulations. Chosen: equal recordings get equal advice."""

MINUTES = (1.0, 4.0)
"""Bounds of the length of a proposed recording, minutes, which is otherwise the median length of the recordings so far.
Chosen: from the 60 s that a diagnosis needs, to a few minutes of work."""

MOST_HYPOTHESES = 3
"""Largest number of hypotheses that a motion is chosen for. Chosen: speed."""

UNSEEN = 0.1
"""Probability assumed for an effect of typical size that these sessions would not have shown. Chosen, not measured."""

SMALL_SHARE = 0.5
"""An effect that no cause names is an open question if its typical size is below this share of its smallest detectable
size. For a limit, where smaller values are larger effects, the ratio is inverted. Chosen: others show in recordings
that are four times longer."""


class Next(NamedTuple):
    """The next step in a sentence, and the text of a profile if a motion is proposed."""

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
    """The recording that separates the open hypotheses, or advice in a sentence if fewer than two are open.

    jobs
        Number of processes that simulate motions.
    """
    hypotheses = _open(verdict, explanation, subjects, rig)
    if len(hypotheses) < 2:
        return Next(_more_axes(verdict, explanation) or _without_experiment(verdict, untestable, len(subjects)), None)
    minutes = round(
        float(np.clip(np.median([subject.cleaned.recording.seconds / 60.0 for subject in subjects]), *MINUTES)), 1
    )
    recorded = PlannedMotion(subjects[0].posterior.mean, min(minutes, subjects[0].cleaned.recording.seconds / 60.0))
    recording = next_recording_of(hypotheses, minutes, SEED, recorded, jobs)
    return Next(sentence(recording, FILE), profile_yaml(recording.profile))


def _open(
    verdict: Verdict, explanation: Explanation, subjects: Sequence[Subject], rig: Rig
) -> tuple[RigHypothesis, ...]:
    """Open hypotheses: tied causes, or possible effects that are not named, or effects that would not have shown."""
    base = subjects[0].rig.base
    calibrated = rig.model_copy(update={"base": base})
    tied = next((cause for cause in verdict.causes if _simulated_ties(cause, explanation)), None)
    if tied is not None:
        placed = _simulated_ties(tied, explanation)[: MOST_HYPOTHESES - 1]
        alternatives = [item.response.candidate.make(item.size) for item in placed]
        other_causes = [cause.effect for cause in verdict.causes if cause is not tied]
        return tuple(
            RigHypothesis(effect.name, with_replaced(calibrated, (*other_causes, effect)), 1.0)
            for effect in (tied.effect, *alternatives)
        )
    if verdict.causes:
        return ()
    shown = explanation.possible()[: MOST_HYPOTHESES - 1]
    possible = [placed.response.candidate.make(placed.size) for placed in shown]
    share = 1.0 / (1.0 + len(possible))
    if verdict.kind is Kind.NONE and not possible:
        possible, share = _unseen(explanation, rig), UNSEEN
    nothing = RigHypothesis(NOTHING, calibrated, 1.0 - share * len(possible))
    return (nothing, *(RigHypothesis(effect.name, with_replaced(calibrated, (effect,)), share) for effect in possible))


def _simulated_ties(cause: NamedCause, explanation: Explanation) -> list[Placed]:
    """Effects that may act instead of a cause, except those that were not simulated: no motion separates these."""
    return [item for name in cause.tied_with if (item := explanation.where_best(name)) is not None]


def _unseen(explanation: Explanation, rig: Rig) -> list[Effect]:
    """Effects of typical size that these sessions would not have shown, the least detectable first."""
    in_rig = {effect.name for effect in rig.effects}
    ratios: list[tuple[float, Effect]] = []
    for item in detectable(explanation.scorer, explanation.evidence.effects()):
        typical, kind = CATALOGUE[item.effect].typical, KINDS[item.effect]
        if item.effect in in_rig or kind.is_read_off:
            continue
        least = np.inf if item.value is None else item.value / typical[item.parameter]
        if item.value is not None and kind.less_is_more:
            least = 1.0 / least
        if least > 1.0 / SMALL_SHARE:
            effect = CATALOGUE[item.effect].model_validate({"name": item.effect, **typical})
            ratios.append((least, effect))
    ratios.sort(key=lambda pair: -pair[0])
    return [effect for _, effect in ratios[: MOST_HYPOTHESES - 1]]


def _more_axes(verdict: Verdict, explanation: Explanation) -> str:
    """The sentence for a cause that a single axis cannot separate from an effect; empty if there is no such cause."""
    for cause in verdict.causes:
        instead = [name for name in cause.tied_with if explanation.where_best(name) is None]
        if instead:
            return (
                f"Record with three axes, the rates about x, y and z and the acceleration: they tell "
                f"{cause.effect.name} from {_listed(instead, 'and')}."
            )
    return ""


def _without_experiment(verdict: Verdict, untestable: Sequence[Untestable], sessions: int) -> str:
    """Advice if no hypotheses are open."""
    if sessions < 3:  # with two sessions, held-out sizes are fitted on a single session
        return "Record more sessions: from three on, each session can check a fit to the others."
    # An untested effect that acts like a tested effect is open only if they tie.
    lacking = next((item for item in untestable if KINDS[item.effect].acts_like is None), None)
    if lacking is not None and lacking.is_of_baseline:
        return f"Let the baseline state more: it has {lacking.why}, so {lacking.effect} was not tested."
    if lacking is not None:
        return f"Record with a device that sends more: {lacking.why} here, so {lacking.effect} was not tested."
    return _for_open_part(verdict) or "Nothing: no ambiguity remains. Record again after a change."


def _for_open_part(verdict: Verdict) -> str:
    """The sentence for a part of the difference that no cause explains; empty if there is none."""
    worst = next((feature for feature in verdict.unexplained if feature.is_beyond_chance), None)
    if worst is not None:
        where = f"{worst.says}, {WHEN[worst.regime]}"
        return f"Record more motion that shows the unexplained part ({where}), at several speeds and temperatures."
    if verdict.kind in (Kind.PARTLY, Kind.UNKNOWN):
        return "Record longer sessions at several speeds and temperatures: part of the difference is unexplained."
    if verdict.may_have_unknown:
        return (
            "Record longer sessions at several speeds and temperatures: something unknown may act, with probability "
            f"{verdict.probability_unknown:.2f}."
        )
    if not verdict.gap.is_closed:
        return "Record longer sessions at several speeds and temperatures: the gap is not closed."
    bounded = [cause.effect.name for cause in verdict.causes if cause.parameters[0].is_bound]
    return f"Check {' and '.join(bounded)} by hand: the tried sizes end before the likely size." if bounded else ""
