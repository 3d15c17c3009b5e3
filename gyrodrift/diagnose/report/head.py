"""The head of a report: contradicted facts, the verdict, what it means, its numbers as tiles, what to record next."""

from math import sqrt

from gyrodrift.diagnose.features.vector import FEATURES
from gyrodrift.diagnose.inference.gap import SimToRealGap
from gyrodrift.diagnose.inference.verdict import Kind, NamedCause
from gyrodrift.diagnose.report.beforehand import against, baseline, doubts, headline_of
from gyrodrift.diagnose.report.effect_words import effect_words, says
from gyrodrift.diagnose.report.files import headline
from gyrodrift.diagnose.report.residuals import rate_figure
from gyrodrift.diagnose.report.text import (
    FREE_PHASE,
    NAMES,
    fitted,
    has_free_phase,
    in_rig,
    interval,
    number,
    others_of,
    percent,
    sigmas,
    size,
)
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.html.html import header, paragraph, text, tile, tiles
from gyrodrift.html.numbers import degrees, significant

WHERE = 3
EXAMPLES = ("scale_factor", "warmup", "rate_random_walk", "latency")
"""Effects that most people ask about, for a verdict that says none."""

CARDS = (
    "<b>How to read the cards.</b> A cause: the size that fits best, the sizes that fit nearly as well, and the "
    "probability that the effect acts. Sim-to-real gap: how far the measured features of recordings and simulator are "
    "apart, in standard deviations σ of repeated runs; the gap cannot shrink below that of the simulator against "
    "itself. Yaw error: mean error of one and the same filter on recordings and on simulated sessions; equal numbers "
    "mean a simulator that predicts the drift. Tuned in simulation: yaw error on the recordings with parameters tuned "
    "in the simulator; the number tuned on the recordings is the best to expect."
)

NOTHING_NAMED = (
    "No effect that the simulator knows explains this, so none is named, and <code>rig.yaml</code> switches none on. "
    "The figures below show what is known of it: on what it depends, how it runs over time, and its spectrum."
)


def verdict(diagnosis: Diagnosis, set_name: str = "") -> str:
    """The head of the page, which names the set of sessions."""
    kind, _, sentence = headline(diagnosis).partition(": ")
    return header(
        f"gyrodrift diagnose · {_sessions(diagnosis)} · verdict: {kind}",
        _titled(headline_of(diagnosis, sentence), set_name),
        against(diagnosis),
        paragraph(f"<b>Apart from that:</b> {text(sentence)}.") if diagnosis.contradictions else "",
        baseline(diagnosis),
        *(paragraph(words) for words in _in_words(diagnosis)),
        doubts(diagnosis),
        rate_figure(diagnosis),
        tiles([*_cause_tiles(diagnosis), _gap_tile(diagnosis), _yaw_tile(diagnosis), _transfer_tile(diagnosis)]),
        paragraph(CARDS, "note"),
        paragraph(f"<b>What to record next.</b> {text(diagnosis.next_step)}"),
    )


def _titled(sentence: str, set_name: str) -> str:
    """The headline after the name of the set; without a name it begins with a capital letter."""
    if set_name:
        return f"{set_name}: {sentence}"
    return f"{sentence[:1].upper()}{sentence[1:]}"


def _sessions(diagnosis: Diagnosis) -> str:
    count = len(diagnosis.sessions)
    minutes = sum(session.minutes for session in diagnosis.sessions)
    return f"{count} session{'s' * (count > 1)}, {significant(minutes, 2)} minutes"


def _in_words(diagnosis: Diagnosis) -> list[str]:
    verdict = diagnosis.verdict
    said = [_where(diagnosis)]
    said += [_cause_words(diagnosis, cause) for cause in verdict.causes]
    if verdict.causes and verdict.unexplained:
        left = "; ".join(text(says(one)) for one in verdict.unexplained[:WHERE])
        said += [f"<b>Unexplained:</b> {left}. No effect of the simulator accounts for this."]
    if not verdict.causes and verdict.kind is Kind.UNKNOWN:
        said += [NOTHING_NAMED]
    return [*said, *_negligible_words(diagnosis)]


def _where(diagnosis: Diagnosis) -> str:
    where = diagnosis.verdict.where
    if not where:
        return (
            "The simulator was driven through the motion of each recording. "
            f"Nothing that was measured{', taken by itself,' * bool(diagnosis.verdict.acting)} differs from it by more "
            "than chance."
        )
    said = list(dict.fromkeys(text(says(one)) for one in where))
    more = [f"and {len(said) - WHERE} more, listed below"] if len(said) > WHERE else []
    return f"<b>What differs:</b> {'; '.join([*said[:WHERE], *more])}."


def _cause_words(diagnosis: Diagnosis, cause: NamedCause) -> str:
    is_best = diagnosis.verdict.kind is Kind.UNKNOWN
    doubt = " It is the best explanation found, and leaves most of the difference." if is_best else ""
    tied = ""
    if cause.tied_with:
        tied = (
            f" {_names(cause.tied_with)} would explain these recordings as well. Probability that one of them or of "
            f"their group acts: {cause.group_probability:.2f}."
        )
    has = in_rig(cause)
    size_words = f"The rig has it with {has}; the recordings show {fitted(cause)}" if has else f"Size: {fitted(cause)}"
    return (
        f"<b>{text(cause.effect.name)}</b>: {text(effect_words(cause))}. {size_words}. Probability that it acts: "
        f"{cause.probability:.2f}.{tied}{doubt}"
    )


def _negligible_words(diagnosis: Diagnosis) -> list[str]:
    """What acts and costs nothing, in a sentence."""
    found = diagnosis.verdict.negligible
    if not found:
        return []
    said = [f"<b>{text(one.cause.effect.name)}</b> costs {number(one.yaw_deg, 2)}° of yaw" for one in found]
    return [f"<b>Real, but negligible:</b> {', '.join(said)}. That is too little to count as a cause."]


def _names(names: tuple[str, ...]) -> str:
    return " or ".join(f"<b>{text(name)}</b>" for name in names)


def _cause_tiles(diagnosis: Diagnosis) -> list[str]:
    if diagnosis.verdict.kind is Kind.NONE:
        return [_examples_tile(diagnosis)]
    if not diagnosis.verdict.causes:
        return [_stages_tile(diagnosis)]
    return [_cause_tile(cause) for cause in diagnosis.verdict.causes]


def _cause_tile(cause: NamedCause) -> str:
    first, has = cause.parameters[0], in_rig(cause)
    rows = [
        (text(first.name), size(first.value, first.unit)),
        ("fits nearly as well", interval(first)),
        *[("in the rig so far", has)] * bool(has),
        *((text(one.name), size(one.value, one.unit)) for one in others_of(cause)),
        *[("phase", FREE_PHASE)] * has_free_phase(cause),
        ("probability that it acts", f"{cause.probability:.2f}"),
        ("could as well be", ", ".join(map(text, cause.tied_with)) or "no other effect"),
    ]
    return tile(f"Cause: {cause.effect.name}", rows)


def _examples_tile(diagnosis: Diagnosis) -> str:
    """Some of the smallest effects that would have been seen."""
    known = {one.effect: size(one.value, one.unit) for one in diagnosis.detectable if one.value is not None}
    names = [name for name in EXAMPLES if name in known] or list(known)[: len(EXAMPLES)]
    rows = [(text(name), known[name]) for name in names]
    return tile("Effects would show here from this size on", rows) if rows else ""


def _stages_tile(diagnosis: Diagnosis) -> str:
    """Where an unknown thing sits."""
    shares: dict[str, float] = {}
    for one in diagnosis.verdict.where:
        shares[one.stage] = shares.get(one.stage, 0.0) + one.share
    worst_first = sorted(shares.items(), key=lambda share: -share[1])
    rows = [(text(stage), percent(share)) for stage, share in worst_first]
    return tile("Stage of the rig where it shows, share of the deviations", rows)


def _gap_tile(diagnosis: Diagnosis) -> str:
    gap = diagnosis.verdict.gap
    floor = ("simulator against itself", sigmas(gap.floor))
    before = (NAMES[1] if diagnosis.verdict.causes else "simulator against recordings", sigmas(gap.before))
    rows = [before, floor]
    if diagnosis.verdict.causes:
        rows = [*_closed(gap), before, (NAMES[2], sigmas(gap.after)), floor]
    judged = "held-out sessions" if len(diagnosis.sessions) > 1 else "the session it was fitted on"
    return tile(f"Sim-to-real gap on {judged}, RMS over {len(FEATURES)} features", rows)


def _closed(gap: SimToRealGap) -> list[tuple[str, str]]:
    """How far it shrank, with the interval that nine in ten of such sets of sessions would give."""
    rows = [] if gap.shrink is None else [("closed by the correction", percent(gap.shrink))]
    if gap.shrink_low is not None and gap.shrink_high is not None:
        rows += [("90 % interval", f"{percent(gap.shrink_low)} to {percent(gap.shrink_high)}")]
    return rows


def _yaw_tile(diagnosis: Diagnosis) -> str:
    impact, before = diagnosis.yaw_impact, NAMES[1] if diagnosis.verdict.causes else "simulator"
    rows = [(NAMES[0], degrees(impact.e_real_deg)), (before, degrees(impact.e_sim_before_deg))]
    rows += [(NAMES[2], degrees(impact.e_sim_after_deg))] * bool(diagnosis.verdict.causes)
    return tile("Mean absolute yaw error with one and the same filter", rows)


def _transfer_tile(diagnosis: Diagnosis) -> str:
    impact, before = diagnosis.yaw_impact, NAMES[1] if diagnosis.verdict.causes else "simulator"
    rows = [
        (f"tuned in the {NAMES[2]}", degrees(sqrt(impact.pi_real_tuned_on_sim_after))),
        (f"tuned in the {before}", degrees(sqrt(impact.pi_real_tuned_on_sim_before))),
        (f"tuned on the {NAMES[0]}", degrees(sqrt(impact.pi_real_tuned_on_real))),
    ]
    heading = "RMS yaw error of the real sessions with a filter tuned in simulation"
    return tile(heading, rows if diagnosis.verdict.causes else rows[1:])
