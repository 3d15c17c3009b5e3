"""The head of a report: contradicted facts, the verdict, what it means, its numbers as tiles, what to record next."""

from math import sqrt

from gyrodrift.diagnose.inference.gap import SimToRealGap
from gyrodrift.diagnose.inference.verdict import Kind, NamedCause
from gyrodrift.diagnose.report.beforehand import against, baseline, doubts, headline_of
from gyrodrift.diagnose.report.files import headline
from gyrodrift.diagnose.report.text import (
    FREE_PHASE,
    NAMES,
    fitted,
    fixed,
    has_free_phase,
    in_rig,
    interval,
    number,
    others_of,
    percent,
    size,
)
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.html.html import header, paragraph, text, tile, tiles
from gyrodrift.html.numbers import degrees, significant

WHERE = 3
EXAMPLES = ("scale_factor", "warmup", "rate_random_walk", "latency")
"""Effects that most people ask about, for a verdict that says none."""

NOTHING_NAMED = (
    "No effect that the simulator knows explains this, so none is named and none is switched on. What is known of the "
    "unknown thing is drawn below: on what it depends, how it runs over time, its spectrum."
)


def verdict(diagnosis: Diagnosis) -> str:
    """The head of the page."""
    kind, _, sentence = headline(diagnosis).partition(": ")
    begins_with_a_name = any(sentence.startswith(cause.effect.name) for cause in diagnosis.verdict.causes)
    said = sentence if begins_with_a_name else f"{sentence[:1].upper()}{sentence[1:]}"
    return header(
        f"gyrodrift diagnose · {_sessions(diagnosis)} · verdict: {kind}",
        headline_of(diagnosis, said),
        against(diagnosis),
        paragraph(f"<b>Apart from that:</b> {text(sentence)}.") if diagnosis.contradictions else "",
        baseline(diagnosis),
        *(paragraph(words) for words in _in_words(diagnosis)),
        doubts(diagnosis),
        tiles([*_cause_tiles(diagnosis), _gap_tile(diagnosis), _yaw_tile(diagnosis), _transfer_tile(diagnosis)]),
        paragraph(f"<b>Record next.</b> {text(diagnosis.next_step)}"),
    )


def _sessions(diagnosis: Diagnosis) -> str:
    count = len(diagnosis.sessions)
    minutes = sum(session.minutes for session in diagnosis.sessions)
    return f"{count} session{'s' * (count > 1)}, {significant(minutes, 2)} minutes"


def _in_words(diagnosis: Diagnosis) -> list[str]:
    verdict = diagnosis.verdict
    said = [_where(diagnosis)]
    said += [_cause_words(diagnosis, cause) for cause in verdict.causes]
    if verdict.causes and verdict.unexplained:
        left = "; ".join(text(one.says) for one in verdict.unexplained[:WHERE])
        said += [f"<b>Unexplained:</b> {left}. No effect of the simulator takes this away."]
    if not verdict.causes and verdict.kind is Kind.UNKNOWN:
        said += [NOTHING_NAMED]
    return [*said, *_negligible_words(diagnosis)]


def _where(diagnosis: Diagnosis) -> str:
    where = diagnosis.verdict.where
    if not where:
        return (
            "The simulator was driven through the very motion of each recording, and nothing that was measured differs "
            f"from it by more than chance does{', by itself' * bool(diagnosis.verdict.acting)}."
        )
    said = list(dict.fromkeys(text(one.says) for one in where))
    more = [f"and {len(said) - WHERE} more deviations, below"] if len(said) > WHERE else []
    return f"<b>What differs:</b> {'; '.join([*said[:WHERE], *more])}."


def _cause_words(diagnosis: Diagnosis, cause: NamedCause) -> str:
    doubt = " It is the best there is, and still leaves most of it." if diagnosis.verdict.kind is Kind.UNKNOWN else ""
    tied = f" These sessions cannot tell it from {_names(cause.tied_with)}." if cause.tied_with else ""
    has = in_rig(cause)
    size_words = (
        f"It is in the rig with {has}; the recordings say {fitted(cause)}" if has else f"Fitted: {fitted(cause)}"
    )
    return (
        f"<b>{text(cause.effect.name)}</b>: {text(cause.meaning)}. {size_words}; probability "
        f"{cause.probability:.2f}.{tied}{doubt}"
    )


def _negligible_words(diagnosis: Diagnosis) -> list[str]:
    """What acts and costs nothing, in a sentence."""
    found = diagnosis.verdict.negligible
    if not found:
        return []
    said = [f"<b>{text(one.cause.effect.name)}</b> costs {number(one.yaw_deg, 2)}° of yaw" for one in found]
    return [f"<b>Seen, and negligible:</b> {', '.join(said)}. Real, and too little to be a cause."]


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
        ("interval", interval(first)),
        *[("in the rig", has)] * bool(has),
        *((text(one.name), size(one.value, one.unit)) for one in others_of(cause)),
        *[("phase", FREE_PHASE)] * has_free_phase(cause),
        ("probability", f"{cause.probability:.2f}"),
        ("or else", ", ".join(map(text, cause.tied_with)) or "nothing as good"),
    ]
    return tile(f"Cause: {cause.effect.name}", rows)


def _examples_tile(diagnosis: Diagnosis) -> str:
    """Some of the smallest effects that would have been seen."""
    known = {one.effect: size(one.value, one.unit) for one in diagnosis.detectable if one.value is not None}
    names = [name for name in EXAMPLES if name in known] or list(known)[: len(EXAMPLES)]
    rows = [(text(name), known[name]) for name in names]
    return tile("Would have been seen from", rows) if rows else ""


def _stages_tile(diagnosis: Diagnosis) -> str:
    """Where an unknown thing sits."""
    shares: dict[str, float] = {}
    for one in diagnosis.verdict.where:
        shares[one.stage] = shares.get(one.stage, 0.0) + one.share
    worst_first = sorted(shares.items(), key=lambda share: -share[1])
    return tile("Where it shows, by share", [(text(stage), percent(share)) for stage, share in worst_first])


def _gap_tile(diagnosis: Diagnosis) -> str:
    gap = diagnosis.verdict.gap
    before, floor = ("before", fixed(gap.before, 2)), ("without a gap", fixed(gap.floor, 2))
    rows = [before, floor]
    if diagnosis.verdict.causes:
        rows = [*_closed(gap), before, ("after", fixed(gap.after, 2)), floor]
    judged = "on held-out sessions" if len(diagnosis.sessions) > 1 else "on the session it was fitted on"
    return tile(f"Gap, {judged}", rows)


def _closed(gap: SimToRealGap) -> list[tuple[str, str]]:
    """How far it shrank, with the interval that nine in ten of such sets of sessions would give."""
    rows = [] if gap.shrink is None else [("closed", percent(gap.shrink))]
    if gap.shrink_low is not None and gap.shrink_high is not None:
        rows += [("nine in ten times", f"{percent(gap.shrink_low)} to {percent(gap.shrink_high)}")]
    return rows


def _yaw_tile(diagnosis: Diagnosis) -> str:
    impact, before = diagnosis.yaw_impact, NAMES[1] if diagnosis.verdict.causes else "simulated"
    rows = [(NAMES[0], degrees(impact.e_real_deg)), (before, degrees(impact.e_sim_before_deg))]
    rows += [(NAMES[2], degrees(impact.e_sim_after_deg))] * bool(diagnosis.verdict.causes)
    return tile("Mean yaw error of the same filter", rows)


def _transfer_tile(diagnosis: Diagnosis) -> str:
    impact, before = diagnosis.yaw_impact, NAMES[1] if diagnosis.verdict.causes else "simulated"
    rows = [
        (NAMES[2], degrees(sqrt(impact.pi_real_tuned_on_sim_after))),
        (before, degrees(sqrt(impact.pi_real_tuned_on_sim_before))),
        (NAMES[0], degrees(sqrt(impact.pi_real_tuned_on_real))),
    ]
    return tile("Yaw error of real sessions (RMS), tuned on", rows if diagnosis.verdict.causes else rows[1:])
