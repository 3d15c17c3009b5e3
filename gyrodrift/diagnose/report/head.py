"""The head of a report: contradicted facts, the verdict in words, its numbers as tiles, and what to record next."""

from math import sqrt

from gyrodrift.diagnose.inference.gap import SimToRealGap
from gyrodrift.diagnose.inference.verdict import Kind, NamedCause, Verdict
from gyrodrift.diagnose.report.beforehand import against, baseline, headline_of, limits
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
    size_or_bound,
    stated,
)
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.html.html import header, paragraph, text, tile, tiles
from gyrodrift.html.numbers import degrees, significant

WHERE = 3
"""Largest number of deviations in a sentence."""

EXAMPLES = ("scale_factor", "warmup", "rate_random_walk", "latency")
"""Well-known effects, whose detectable sizes are shown if the verdict is `none`."""

CARDS = (
    "<b>How to read the cards.</b> A cause: its most probable size, the sizes that the recordings leave possible (95 "
    "%), and the probability that the effect acts. Sim-to-real gap: the difference between the measured features of "
    "recordings and simulator, in standard deviations σ of repeated runs. It cannot shrink below the gap of the "
    "simulator against itself. Yaw error: mean error of one filter on recordings and on simulated sessions. Equal "
    "numbers mean that the simulator predicts the drift. Tuned in simulation: yaw error on the recordings with "
    "parameters tuned in the simulator. Parameters tuned on the recordings are the best to expect."
)

NOTHING_NAMED = (
    "No effect of the simulator explains this, so none is named, and <code>rig.yaml</code> has no new effect. The "
    "figures below show on what the difference depends, how it changes over time, and its spectrum."
)

NO_SINGLE_FEATURE = (
    "No single feature differs by more than chance. The probability of a difference comes from many small differences "
    "together."
)


def verdict(diagnosis: Diagnosis, set_name: str = "") -> str:
    """The head of the page; `set_name` is the name of the set of sessions."""
    kind, _, sentence = headline(diagnosis).partition(": ")
    return header(
        f"gyrodrift diagnose · {_sessions(diagnosis)} · verdict: {kind}",
        _titled(headline_of(diagnosis, sentence), set_name),
        against(diagnosis),
        paragraph(f"<b>Apart from that:</b> {text(sentence)}.") if diagnosis.contradictions else "",
        baseline(diagnosis),
        *(paragraph(words) for words in _in_words(diagnosis)),
        limits(diagnosis),
        rate_figure(diagnosis),
        tiles(
            [
                *_cause_tiles(diagnosis),
                _gap_tile(diagnosis),
                _yaw_tile(diagnosis),
                _transfer_tile(diagnosis),
                *_on_device_tiles(diagnosis),
            ]
        ),
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
    """The verdict as paragraphs: differences, causes, what is unexplained, probabilities."""
    verdict = diagnosis.verdict
    sentences = [_where(diagnosis)]
    sentences += [_cause_words(cause) for cause in verdict.causes_by_share]
    remaining = [says(deviation) for deviation in verdict.unexplained if deviation.is_beyond_chance]
    if verdict.causes and remaining:
        listed = "; ".join(map(text, remaining[:WHERE]))
        sentences += [f"<b>Unexplained:</b> {listed}. No effect of the simulator accounts for this."]
    if not verdict.causes and verdict.kind is Kind.UNKNOWN:
        sentences += [NOTHING_NAMED]
    return [*sentences, *_negligible_words(diagnosis), *_probabilities(verdict)]


def _probabilities(verdict: Verdict) -> list[str]:
    """The probabilities of nothing and of something unknown, in a sentence."""
    if verdict.probability_none is None or verdict.probability_unknown is None:
        return []
    none, unknown = (text(stated(value)) for value in (verdict.probability_none, verdict.probability_unknown))
    return [f"Probability that nothing is missing from the simulator: {none}; that something unknown acts: {unknown}."]


def _where(diagnosis: Diagnosis) -> str:
    where = diagnosis.verdict.where
    if not where and diagnosis.verdict.kind is Kind.NONE:
        return (
            "The simulator was driven through the motion of each recording. "
            f"No feature{', taken alone,' * bool(diagnosis.verdict.acting)} differs by more than chance."
        )
    sentences = list(dict.fromkeys(text(says(deviation)) for deviation in where if deviation.is_beyond_chance))
    if not sentences:
        return NO_SINGLE_FEATURE
    rest = [f"and {len(sentences) - WHERE} more, listed below"] if len(sentences) > WHERE else []
    return f"<b>What differs:</b> {'; '.join([*sentences[:WHERE], *rest])}."


def _cause_words(cause: NamedCause) -> str:
    tied = ""
    if cause.tied_with:
        tied = (
            f" {_names(cause.tied_with)} may act instead: these recordings do not tell them apart. Probability that "
            f"one of them acts: {text(stated(cause.group_probability))}."
        )
    has = in_rig(cause)
    size_words = f"The rig has it with {has}; the recordings show {fitted(cause)}" if has else f"Size: {fitted(cause)}"
    return (
        f"<b>{text(cause.effect.name)}</b>: {text(effect_words(cause))}. {size_words}. Probability that it acts: "
        f"{text(stated(cause.probability))}.{tied}"
    )


def _negligible_words(diagnosis: Diagnosis) -> list[str]:
    """Negligible effects in a sentence."""
    negligible = diagnosis.verdict.negligible
    if not negligible:
        return []
    costs = [f"<b>{text(item.cause.effect.name)}</b> changes yaw by {number(item.yaw_deg, 2)}°" for item in negligible]
    return [f"<b>Real, but negligible:</b> {', '.join(costs)}. This is too little to count as a cause."]


def _names(names: tuple[str, ...]) -> str:
    return " or ".join(f"<b>{text(name)}</b>" for name in names)


def _cause_tiles(diagnosis: Diagnosis) -> list[str]:
    if diagnosis.verdict.kind is Kind.NONE:
        return [_examples_tile(diagnosis)]
    if not diagnosis.verdict.causes:
        return [_stages_tile(diagnosis)]
    return [_cause_tile(cause) for cause in diagnosis.verdict.causes_by_share]


def _cause_tile(cause: NamedCause) -> str:
    first, has = cause.parameters[0], in_rig(cause)
    rows = [
        (text(first.name), size_or_bound(first)),
        ("possible sizes (95 %)", interval(first)),
        *[("in the rig so far", has)] * bool(has),
        *((text(parameter.name), size(parameter.value, parameter.unit)) for parameter in others_of(cause)),
        *[("phase", FREE_PHASE)] * has_free_phase(cause),
        ("probability that it acts", text(stated(cause.probability))),
        ("share of the gap that returns without it", percent(cause.gap_share)),
        ("may be instead", ", ".join(map(text, cause.tied_with)) or "no other effect"),
    ]
    return tile(f"Cause: {cause.effect.name}", rows)


def _examples_tile(diagnosis: Diagnosis) -> str:
    """Detectable sizes of some effects."""
    smallest = {item.effect: size(item.value, item.unit) for item in diagnosis.detectable if item.value is not None}
    names = [name for name in EXAMPLES if name in smallest] or list(smallest)[: len(EXAMPLES)]
    rows = [(text(name), smallest[name]) for name in names]
    return tile("Effects would show here from this size on", rows) if rows else ""


def _stages_tile(diagnosis: Diagnosis) -> str:
    """Stages of the rig that the deviating features belong to, with their shares, for the verdict `unknown`."""
    shares: dict[str, float] = {}
    for deviation in diagnosis.verdict.where:
        shares[deviation.stage] = shares.get(deviation.stage, 0.0) + deviation.share
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
    return tile(f"Sim-to-real gap on {judged}, RMS over {len(diagnosis.features)} features", rows)


def _closed(gap: SimToRealGap) -> list[tuple[str, str]]:
    """Closed share of the gap, with its 90 % interval over sets of such sessions."""
    rows = [] if gap.shrink is None else [("closed by the correction", percent(gap.shrink))]
    if gap.shrink_low is not None and gap.shrink_high is not None:
        rows += [("90 % interval", f"{percent(gap.shrink_low)} to {percent(gap.shrink_high)}")]
    return rows


def _yaw_tile(diagnosis: Diagnosis) -> str:
    impact, before = diagnosis.yaw_impact, NAMES[1] if diagnosis.verdict.causes else "simulator"
    rows = [(NAMES[0], degrees(impact.e_real_deg)), (before, degrees(impact.e_sim_before_deg))]
    rows += [(NAMES[2], degrees(impact.e_sim_after_deg))] * bool(diagnosis.verdict.causes)
    return tile("Mean absolute yaw error with one and the same filter", rows)


def _on_device_tiles(diagnosis: Diagnosis) -> list[str]:
    """Errors of the filter that the device runs itself; none for a device without one."""
    errors = diagnosis.on_device
    if errors is None:
        return []
    rows = [("filter in the device", degrees(errors.e_device_deg)), ("restlevel", degrees(errors.e_restlevel_deg))]
    if errors.within_2_sigma is not None:
        rows += [("within the 2 σ that the device states", percent(errors.within_2_sigma))]
    return [tile("Mean absolute heading error on the recordings", rows)]


def _transfer_tile(diagnosis: Diagnosis) -> str:
    impact, before = diagnosis.yaw_impact, NAMES[1] if diagnosis.verdict.causes else "simulator"
    rows = [
        (f"tuned in the {NAMES[2]}", degrees(sqrt(impact.pi_real_tuned_on_sim_after))),
        (f"tuned in the {before}", degrees(sqrt(impact.pi_real_tuned_on_sim_before))),
        (f"tuned on the {NAMES[0]}", degrees(sqrt(impact.pi_real_tuned_on_real))),
    ]
    heading = "RMS yaw error of the real sessions with a filter tuned in simulation"
    return tile(heading, rows if diagnosis.verdict.causes else rows[1:])
