"""Causes in a report: probability and evidence of every effect, and the effects that were not tried."""

from gyrodrift.diagnose.report import text
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.report.page import Section


def causes(diagnosis: Diagnosis) -> Section:
    """The section of the causes."""
    verdict = diagnosis.verdict
    marks = {
        **{item.cause.effect.name: "negligible" for item in verdict.negligible},
        **{name: "tied" for cause in verdict.causes for name in cause.tied_with},
        **{cause.effect.name: "named" for cause in verdict.causes},
    }
    ranking = sorted(diagnosis.ranking, key=lambda ranked: (-round(ranked.probability, 2), -ranked.gain))
    values = {"diagnosis": diagnosis, "words": text, "ranking": ranking, "marks": marks}
    heading = "Which effect explains it" if verdict.where else "What each effect would explain"
    return Section("diagnose/report/templates/causes.html", values, heading)
