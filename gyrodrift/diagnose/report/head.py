"""Head of a report: contradicted facts, the verdict in words, its numbers as tiles, and what to record next."""

from gyrodrift.diagnose.inference.detectable import Detectable
from gyrodrift.diagnose.inference.verdict import Kind
from gyrodrift.diagnose.predictive_checks.rate_errors import RATE
from gyrodrift.diagnose.report import text
from gyrodrift.diagnose.report.charts import dependence_chart
from gyrodrift.diagnose.report.effect_words import effect_words, says
from gyrodrift.diagnose.report.features import largest_deviation
from gyrodrift.diagnose.report.files import headline
from gyrodrift.diagnose.report.residuals import dependence_name
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.report.page import Section

OF_BASELINE = "baseline: "
"""Prefix of remarks on the recordings of a baseline."""

DIGITS = 5
"""Digits of counts per turn. Chosen: counts of usual encoders are exact."""

FACTS = {
    "encoder_cpr": "an encoder of {}, the recordings show {}",
    "dps_per_lsb": "rates in steps of {}, the recordings show {}",
    "range_dps": "a range of {}, the recordings reach {}",
    "turn_ratio": "an encoder of {}, the gyro agrees with {}",
}
"""Words for each fact: the value of the rig, and the value of the recordings."""

WHERE = 3
"""Largest number of deviations in a sentence. Chosen: more make a sentence hard to read."""

PICTURES = {
    **dict.fromkeys(("latency", "bandwidth"), "acceleration"),
    **dict.fromkeys(("g_sensitivity", "encoder_eccentricity"), "angle within the turn"),
    **dict.fromkeys(("temp_bias", "temp_scale"), "temperature"),
    "warmup": "time since the session began",
    "backlash": "direction it came from, at rest",
    **dict.fromkeys(
        ("scale_factor", "scale_asymmetry", "nonlinearity", "misalignment", "vibration_rectification"), RATE
    ),
    **dict.fromkeys(("deadband", "saturation", "clock_drift"), RATE),
}
"""Quantity against which the rate error shows an effect. Without one the largest deviation is shown."""

READINGS = {
    "acceleration": "A slope is a delay, in seconds.",
    RATE: "A slope is a scale error, a level is a bias, a bend is a nonlinearity.",
    "time since the session began": "A curve that falls and levels off is a warm-up.",
    "angle within the turn": "A wave of one period is an effect that comes once per turn.",
    "temperature": "A slope is a bias that follows the temperature.",
}
"""Sentences on the shapes in a picture."""

EXAMPLES = ("scale_factor", "warmup", "rate_random_walk", "latency")
"""Well-known effects, whose detectable sizes are shown if the verdict is `none`."""


def verdict(diagnosis: Diagnosis, set_name: str = "") -> Section:
    """The head of the page; `set_name` is the name of the set of sessions."""
    result = diagnosis.verdict
    kind, _, sentence = headline(diagnosis).partition(": ")
    values = {
        "words": text,
        "effect_words": effect_words,
        "diagnosis": diagnosis,
        "verdict": result,
        "is_none": result.kind is Kind.NONE,
        "is_unknown": not result.causes and result.kind is Kind.UNKNOWN,
        "has_causes": bool(result.causes),
        "kind": kind,
        "minutes": sum(session.minutes for session in diagnosis.sessions),
        "headline": _titled(_contradiction(diagnosis) or sentence, set_name),
        "sentence": sentence,
        "baseline": [
            remark.removeprefix(OF_BASELINE) for remark in diagnosis.remarks if remark.startswith(OF_BASELINE)
        ],
        "differing": _first([says(item) for item in result.where if item.is_beyond_chance]),
        "remaining": [says(item) for item in result.unexplained if item.is_beyond_chance][:WHERE],
        "limits": _limits(diagnosis),
        "pictures": _pictures(diagnosis),
        "reading": _reading(diagnosis),
        "examples": _examples(diagnosis),
        "stages": _stages(diagnosis),
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
    shown = "none such" if first.sessions is None else text.number(first.sessions, DIGITS)
    return f"The rig states {FACTS[first.fact].format(f'{text.number(first.rig, DIGITS)} {first.unit}', shown)}"


def _first(sentences: list[str]) -> list[str]:
    """The first different sentences, and the number of the others."""
    different = list(dict.fromkeys(sentences))
    rest = len(different) - WHERE
    return [*different[:WHERE], *[f"and {rest} more, listed below"] * (rest > 0)]


def _limits(diagnosis: Diagnosis) -> list[str]:
    remarks = [remark for remark in diagnosis.remarks if not remark.startswith(OF_BASELINE)]
    halves = diagnosis.halves
    return [*remarks, *([f"the verdict is {halves.says}"] if halves is not None and not halves.is_same else [])]


def _pictures(diagnosis: Diagnosis) -> list[tuple[object, object]]:
    """A chart for each named cause, the largest share first; the largest deviation where no quantity shows a cause."""
    by_name = {item.name: item for item in diagnosis.rate_errors.dependences}
    causes = diagnosis.verdict.causes_by_share
    names = dict.fromkeys(PICTURES.get(cause.effect.name, "") for cause in causes)
    panels: list[tuple[object, object]] = [
        (dependence_name(by_name[name], has_causes=True), dependence_chart(by_name[name], has_causes=True))
        for name in names
        if name in by_name
    ]
    return panels or largest_deviation(diagnosis)


def _reading(diagnosis: Diagnosis) -> str:
    """Sentences on the shapes in the pictures."""
    names = dict.fromkeys(PICTURES.get(cause.effect.name, "") for cause in diagnosis.verdict.causes_by_share)
    return " ".join(READINGS[name] for name in names if name in READINGS)


def _examples(diagnosis: Diagnosis) -> list[Detectable]:
    """Detectable sizes of some effects."""
    smallest = {item.effect: item for item in diagnosis.detectable if item.value is not None}
    names = [name for name in EXAMPLES if name in smallest] or list(smallest)[: len(EXAMPLES)]
    return [smallest[name] for name in names]


def _stages(diagnosis: Diagnosis) -> list[tuple[str, float]]:
    """Stages of the rig that the deviating features belong to, with their shares, the largest first."""
    shares: dict[str, float] = {}
    for deviation in diagnosis.verdict.where:
        shares[deviation.stage] = shares.get(deviation.stage, 0.0) + deviation.share
    return sorted(shares.items(), key=lambda share: -share[1])
