"""Causes in a report: probability and evidence of every effect, and the effects that were not tried."""

from markupsafe import Markup

from gyrodrift.diagnose.inference.ranking import Ranked
from gyrodrift.diagnose.report.text import fixed, number, percent, size, stated
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.report.page import Section, bar, bold, marked


def causes(diagnosis: Diagnosis) -> Section:
    """The section of the causes."""
    has_causes, linear = bool(diagnosis.verdict.acting), diagnosis.linear_model
    in_order = sorted(diagnosis.ranking, key=lambda ranked: (-round(ranked.probability, 2), -ranked.gain))
    joined = [Markup("beside<br/>the causes")] * has_causes
    remarks = {
        **{
            f"May act instead of {cause.effect.name}": ", ".join(cause.tied_with) or "no other"
            for cause in diagnosis.verdict.causes
        },
        "Not tried": "; ".join(f"{item.effect}: {item.why}" for item in diagnosis.untestable) or "none",
        "Left out by --withhold": ", ".join(diagnosis.withheld) or "none",
    }
    values = {
        "has_causes": has_causes,
        "head": ["effect", "", "probability", Markup("evidence<br/>alone"), *joined, "best size", "group"],
        "rows": [_row(diagnosis, ranked) for ranked in in_order],
        "linear": linear,
        "linear_size": f"{size(linear.value, linear.unit)} ({number(linear.low)} to {number(linear.high)})",
        "remarks": remarks.items(),
    }
    heading = "Which effect explains it" if diagnosis.verdict.where else "What each effect would explain"
    return Section("diagnose/report/templates/causes.html", values, heading)


def _row(diagnosis: Diagnosis, ranked: Ranked) -> list[str]:
    mark, probability = _mark(diagnosis, ranked.name), ranked.probability
    name = bold(ranked.name) + marked("note", f" {mark}") if mark else ranked.name
    beside = "" if ranked.gain_with_causes is None else fixed(ranked.gain_with_causes, 1)
    return [
        marked("word", name),
        marked("word", bar(probability, percent(probability))),
        stated(probability),
        fixed(ranked.gain, 1),
        *[beside] * bool(diagnosis.verdict.acting),
        size(ranked.value, ranked.unit),
        ranked.group if ranked.group != ranked.name else "",
    ]


def _mark(diagnosis: Diagnosis, name: str) -> str:
    verdict = diagnosis.verdict
    if name in {cause.effect.name for cause in verdict.causes}:
        return "named"
    if name in {tied for cause in verdict.causes for tied in cause.tied_with}:
        return "tied"
    return "negligible" if name in {item.cause.effect.name for item in verdict.negligible} else ""
