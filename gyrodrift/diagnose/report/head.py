"""Head of a report: contradicted facts, the verdict in words, its numbers as tiles, and what to record next."""

from math import sqrt

from gyrodrift.diagnose.inference.verdict import Kind, NamedCause
from gyrodrift.diagnose.report.charts import dependence_chart
from gyrodrift.diagnose.report.effect_words import effect_words, says
from gyrodrift.diagnose.report.files import headline
from gyrodrift.diagnose.report.residuals import RATE, dependence_name
from gyrodrift.diagnose.report.text import (
    FREE_PHASE,
    NAMES,
    fitted,
    has_free_phase,
    in_rig,
    interval,
    marks,
    number,
    others_of,
    percent,
    sigmas,
    size,
    size_or_bound,
    stated,
)
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.report.numbers import degrees, significant
from gyrodrift.report.page import Section, Tile

OF_BASELINE = "baseline: "
"""Prefix of remarks on the recordings of a baseline."""

DIGITS = 5
"""Digits of counts per turn."""

FACTS = {
    "encoder_cpr": "an encoder of {}, the recordings show {}",
    "dps_per_lsb": "rates in steps of {}, the recordings show {}",
    "range_dps": "a range of {}, the recordings reach {}",
    "turn_ratio": "an encoder of {}, the gyro agrees with {}",
}
"""Words for each fact: the value of the rig, and the value of the recordings."""

WHERE = 3
"""Largest number of deviations in a sentence."""

EXAMPLES = ("scale_factor", "warmup", "rate_random_walk", "latency")
"""Well-known effects, whose detectable sizes are shown if the verdict is `none`."""


def verdict(diagnosis: Diagnosis, set_name: str = "") -> Section:
    """The head of the page; `set_name` is the name of the set of sessions."""
    result = diagnosis.verdict
    kind, _, sentence = headline(diagnosis).partition(": ")
    minutes = sum(session.minutes for session in diagnosis.sessions)
    values = {
        "kind": kind,
        "minutes": significant(minutes, 2),
        "headline": _titled(_contradiction(diagnosis) or sentence, set_name),
        "sentence": sentence,
        "diagnosis": diagnosis,
        "contradictions": [f"{item.fact}: {item.says}" for item in diagnosis.contradictions],
        "baseline": [
            remark.removeprefix(OF_BASELINE) for remark in diagnosis.remarks if remark.startswith(OF_BASELINE)
        ],
        "is_nowhere": not result.where and result.kind is Kind.NONE,
        "differing": _first([says(item) for item in result.where if item.is_beyond_chance]),
        "causes": [_cause(cause) for cause in result.causes_by_share],
        "remaining": [says(item) for item in result.unexplained if item.is_beyond_chance][:WHERE],
        "is_unknown": not result.causes and result.kind is Kind.UNKNOWN,
        "negligible": [(item.cause.effect.name, number(item.yaw_deg, 2)) for item in result.negligible],
        "probabilities": _probabilities(diagnosis),
        "limits": _limits(diagnosis),
        "rate_panels": _rate_panels(diagnosis),
        "marks": marks(has_causes=bool(result.causes)),
        "tiles": [
            *_cause_tiles(diagnosis),
            _gap_tile(diagnosis),
            _yaw_tile(diagnosis),
            _transfer_tile(diagnosis),
            *_on_device_tiles(diagnosis),
        ],
    }
    return Section("diagnose/report/templates/head.html", values)


def _titled(sentence: str, set_name: str) -> str:
    """The headline after the name of the set; without a name it begins with a capital letter."""
    return f"{set_name}: {sentence}" if set_name else f"{sentence[:1].upper()}{sentence[1:]}"


def _contradiction(diagnosis: Diagnosis) -> str:
    """The first contradiction as a headline, with both numbers; empty if there is none."""
    first = next(iter(diagnosis.contradictions), None)
    if first is None:
        return ""
    shown = "none such" if first.sessions is None else number(first.sessions, DIGITS)
    return f"The rig states {FACTS[first.fact].format(f'{number(first.rig, DIGITS)} {first.unit}', shown)}"


def _first(sentences: list[str]) -> list[str]:
    """The first different sentences, and the number of the others."""
    different = list(dict.fromkeys(sentences))
    rest = len(different) - WHERE
    return [*different[:WHERE], *[f"and {rest} more, listed below"] * (rest > 0)]


def _limits(diagnosis: Diagnosis) -> list[str]:
    linear = diagnosis.linear_model
    remarks = [remark for remark in diagnosis.remarks if not remark.startswith(OF_BASELINE)]
    return [*remarks, *[f"a linear model of the rate error {linear.says}"] * (linear.agrees is False)]


def _probabilities(diagnosis: Diagnosis) -> tuple[str, str] | None:
    """Probabilities of nothing and of something unknown; None if they are not known."""
    none, unknown = diagnosis.verdict.probability_none, diagnosis.verdict.probability_unknown
    return None if none is None or unknown is None else (stated(none), stated(unknown))


def _cause(cause: NamedCause) -> dict[str, object]:
    return {
        "name": cause.effect.name,
        "words": effect_words(cause),
        "in_rig": in_rig(cause),
        "fitted": fitted(cause),
        "probability": stated(cause.probability),
        "tied_with": cause.tied_with,
        "group_probability": stated(cause.group_probability),
    }


def _rate_panels(diagnosis: Diagnosis) -> list[tuple[object, object]]:
    """Rate errors against the rate; none if no session moves."""
    has_causes = bool(diagnosis.verdict.causes)
    return [
        (dependence_name(item, has_causes=has_causes), dependence_chart(item, has_causes=has_causes))
        for item in diagnosis.residuals.dependences
        if item.name == RATE
    ]


def _cause_tiles(diagnosis: Diagnosis) -> list[Tile]:
    if diagnosis.verdict.kind is Kind.NONE:
        return _examples_tiles(diagnosis)
    if not diagnosis.verdict.causes:
        return [_stages_tile(diagnosis)]
    return [_cause_tile(cause) for cause in diagnosis.verdict.causes_by_share]


def _cause_tile(cause: NamedCause) -> Tile:
    first, has = cause.parameters[0], in_rig(cause)
    rows = [
        (first.name, size_or_bound(first)),
        ("possible sizes (95 %)", interval(first)),
        *[("in the rig so far", has)] * bool(has),
        *((parameter.name, size(parameter.value, parameter.unit)) for parameter in others_of(cause)),
        *[("phase", FREE_PHASE)] * has_free_phase(cause),
        ("probability that it acts", stated(cause.probability)),
        ("share of the gap that returns without it", percent(cause.gap_share)),
        ("may be instead", ", ".join(cause.tied_with) or "no other effect"),
    ]
    return Tile(f"Cause: {cause.effect.name}", rows)


def _examples_tiles(diagnosis: Diagnosis) -> list[Tile]:
    """Detectable sizes of some effects."""
    smallest = {item.effect: size(item.value, item.unit) for item in diagnosis.detectable if item.value is not None}
    names = [name for name in EXAMPLES if name in smallest] or list(smallest)[: len(EXAMPLES)]
    rows = [(name, smallest[name]) for name in names]
    return [Tile("Effects would show here from this size on", rows)] if rows else []


def _stages_tile(diagnosis: Diagnosis) -> Tile:
    """Stages of the rig that the deviating features belong to, with their shares, for the verdict `unknown`."""
    shares: dict[str, float] = {}
    for deviation in diagnosis.verdict.where:
        shares[deviation.stage] = shares.get(deviation.stage, 0.0) + deviation.share
    worst_first = sorted(shares.items(), key=lambda share: -share[1])
    heading = "Stage of the rig where it shows, share of the deviations"
    return Tile(heading, [(stage, percent(share)) for stage, share in worst_first])


def _gap_tile(diagnosis: Diagnosis) -> Tile:
    gap, has_causes = diagnosis.verdict.gap, bool(diagnosis.verdict.causes)
    has_interval = gap.shrink_low is not None and gap.shrink_high is not None
    rows = [
        *[("closed by the correction", percent(gap.shrink or 0.0))] * (has_causes and gap.shrink is not None),
        *[("90 % interval", f"{percent(gap.shrink_low or 0.0)} to {percent(gap.shrink_high or 0.0)}")]
        * (has_causes and has_interval),
        (NAMES[1] if has_causes else "simulator against recordings", sigmas(gap.before)),
        *[(NAMES[2], sigmas(gap.after))] * has_causes,
        ("simulator against itself", sigmas(gap.floor)),
    ]
    judged = "held-out sessions" if len(diagnosis.sessions) > 1 else "the session it was fitted on"
    return Tile(f"Sim-to-real gap on {judged}, RMS over {len(diagnosis.features)} features", rows)


def _yaw_tile(diagnosis: Diagnosis) -> Tile:
    impact, has_causes = diagnosis.yaw_impact, bool(diagnosis.verdict.causes)
    rows = [
        (NAMES[0], degrees(impact.e_real_deg)),
        (NAMES[1] if has_causes else "simulator", degrees(impact.e_sim_before_deg)),
        *[(NAMES[2], degrees(impact.e_sim_after_deg))] * has_causes,
    ]
    return Tile("Mean absolute yaw error with one and the same filter", rows)


def _on_device_tiles(diagnosis: Diagnosis) -> list[Tile]:
    """Errors of the filter that the device runs itself; none for a device without one."""
    errors = diagnosis.on_device
    if errors is None:
        return []
    rows = [("filter in the device", degrees(errors.e_device_deg)), ("restlevel", degrees(errors.e_restlevel_deg))]
    if errors.within_2_sigma is not None:
        rows += [("within the 2 σ that the device states", percent(errors.within_2_sigma))]
    return [Tile("Mean absolute heading error on the recordings", rows)]


def _transfer_tile(diagnosis: Diagnosis) -> Tile:
    impact, has_causes = diagnosis.yaw_impact, bool(diagnosis.verdict.causes)
    before = NAMES[1] if has_causes else "simulator"
    rows = [
        *[(f"tuned in the {NAMES[2]}", degrees(sqrt(impact.pi_real_tuned_on_sim_after)))] * has_causes,
        (f"tuned in the {before}", degrees(sqrt(impact.pi_real_tuned_on_sim_before))),
        (f"tuned on the {NAMES[0]}", degrees(sqrt(impact.pi_real_tuned_on_real))),
    ]
    return Tile("RMS yaw error of the real sessions with a filter tuned in simulation", rows)
