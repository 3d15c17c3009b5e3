"""The next step: a motion that shows the open effects, or a sentence if no motion does."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.rig import Rig
from gyrodrift.diagnose.features.feature import WHEN
from gyrodrift.diagnose.inference.detectable import detectable
from gyrodrift.diagnose.inference.explanation import Explanation
from gyrodrift.diagnose.inference.verdict import Kind, NamedCause, Verdict
from gyrodrift.diagnose.next_recording import NextRecording, next_recording_of
from gyrodrift.diagnose.result import Untestable
from gyrodrift.diagnose.simulate.candidates import KINDS
from gyrodrift.diagnose.simulate.twin import Subject

FILE = "next-profile.yaml"
"""Name of the file of the profile, in the folder of `rig.yaml`."""

MINUTES = (1.0, 4.0)
"""Bounds of the length of a proposed recording, minutes, which is otherwise the median length of the recordings so far.
Chosen: from the 60 s that a diagnosis needs, to a few minutes of work."""

MOST_EFFECTS = 2
"""Largest number of effects, beside the first of a tie, that a motion is chosen for. Chosen: each gets enough time."""

SMALL_SHARE = 0.5
"""An effect that no cause names is an open question if its typical size is below this share of its smallest detectable
size. For a limit, where smaller values are larger effects, the ratio is inverted. Chosen: others show in recordings
that are four times longer."""


class Next(NamedTuple):
    """The next step in a sentence, and the text of a profile if a motion is proposed."""

    sentence: str
    profile_yaml: str | None


def what_next(
    verdict: Verdict, explanation: Explanation, subjects: Sequence[Subject], untestable: Sequence[Untestable], rig: Rig
) -> Next:
    """The recording that shows the open effects, or advice in a sentence if none is open."""
    tied = next((cause for cause in verdict.causes if _simulated_ties(cause, explanation)), None)
    if tied is not None:
        instead = _simulated_ties(tied, explanation)[:MOST_EFFECTS]
        names, question = [tied.effect.name, *instead], f"{tied.effect.name} from {_listed(instead, 'and')}"
    else:
        names = [] if verdict.causes else _possible(verdict, explanation, rig)
        question = f"whether there is {_listed(names, 'or')}" if names else ""
    if not names:
        return Next(_more_axes(verdict, explanation) or _without_experiment(verdict, untestable, len(subjects)), None)
    minutes = float(np.clip(np.median([subject.cleaned.recording.seconds / 60.0 for subject in subjects]), *MINUTES))
    recording = next_recording_of(names, round(minutes, 1), subjects[0].rig.base)
    return Next(_sentence(recording, question), recording.profile_yaml)


def _sentence(recording: NextRecording, question: str) -> str:
    return (
        f"Switch the device on and play {FILE} ({recording.minutes:g} min: {recording.says}){recording.warming}: "
        f"such motion tells {question} best."
    )


def _listed(names: Sequence[str], joint: str) -> str:
    *first, last = names
    return f"{', '.join(first)} {joint} {last}" if first else last


def _simulated_ties(cause: NamedCause, explanation: Explanation) -> list[str]:
    """Effects that may act instead of a cause, except those that were not simulated: no motion separates these."""
    return [name for name in cause.tied_with if explanation.where_best(name) is not None]


def _possible(verdict: Verdict, explanation: Explanation, rig: Rig) -> list[str]:
    """Possible effects without a cause, or else those of typical size that these sessions would not have shown."""
    possible = [placed.template.name for placed in explanation.possible()[:MOST_EFFECTS]]
    return _unseen(explanation, rig) if verdict.kind is Kind.NONE and not possible else possible


def _unseen(explanation: Explanation, rig: Rig) -> list[str]:
    """Effects of typical size that these sessions would not have shown, the least detectable first."""
    in_rig = {effect.name for effect in rig.effects}
    ratios: list[tuple[float, str]] = []
    for item in detectable(explanation.scorer, explanation.evidence.effects()):
        typical, kind = CATALOGUE[item.effect].typical, KINDS[item.effect]
        if item.effect in in_rig or kind.is_read_off:
            continue
        least = np.inf if item.value is None else item.value / typical[item.parameter]
        if item.value is not None and kind.less_is_more:
            least = 1.0 / least
        if least > 1.0 / SMALL_SHARE:
            ratios.append((least, item.effect))
    return [name for _, name in sorted(ratios, key=lambda pair: -pair[0])[:MOST_EFFECTS]]


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
