"""Features in a report: every feature that deviates, as a table and as charts."""

from collections.abc import Sequence
from dataclasses import replace

from markupsafe import Markup

from gyrodrift.diagnose.features.feature import WHEN
from gyrodrift.diagnose.inference.evidence import FAMILY_WISE_ERROR
from gyrodrift.diagnose.inference.gap import WORST_Z, Deviation
from gyrodrift.diagnose.inference.verdict import Verdict
from gyrodrift.diagnose.predictive_checks.feature_comparison import FeatureComparison
from gyrodrift.diagnose.report.charts import feature_chart
from gyrodrift.diagnose.report.effect_words import deviation_words
from gyrodrift.diagnose.report.text import NAMES, deviates, marks, number, percent
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.report.page import Section, code, marked


def features(diagnosis: Diagnosis) -> Section:
    """The section of the deviating features."""
    has_causes, compared = bool(diagnosis.verdict.acting), _listed(diagnosis)
    worst = max(diagnosis.features, key=lambda comparison: abs(comparison.z_before))
    first = f"{NAMES[1]}, σ" if has_causes else "deviation, σ"
    values = {
        "has_causes": has_causes,
        "is_fitted_apart": has_causes and len(diagnosis.sessions) > 1,
        "count": len(diagnosis.features),
        "threshold": number(diagnosis.threshold_z),
        "chance": number(100.0 * FAMILY_WISE_ERROR),
        "limit": f"{WORST_Z:g}",
        "worst": (deviates(worst.z_before), worst.feature.says),
        "head": ["what deviates", first, "share", *[f"{NAMES[2]}, σ", "share"] * has_causes, "stage, when, name"],
        "rows": [_row(diagnosis.verdict, comparison) for comparison in compared],
        "marks": marks(has_causes=has_causes, has_residual=False),
        "panels": [
            (_name(comparison, has_causes=has_causes), feature_chart(comparison, has_causes=has_causes))
            for comparison in compared
        ],
    }
    return Section("diagnose/report/templates/features.html", values, "Where recordings and simulator differ")


def largest_deviation(diagnosis: Diagnosis) -> list[tuple[object, object]]:
    """The chart of the feature that deviates most; none if no feature deviates."""
    has_causes = bool(diagnosis.verdict.acting)
    return [
        (_name(comparison, has_causes=has_causes), feature_chart(comparison, has_causes=has_causes))
        for comparison in _listed(diagnosis)[:1]
    ]


def _listed(diagnosis: Diagnosis) -> list[FeatureComparison]:
    """Features that deviate without or with the causes; those that deviate without them first, in order of size."""
    verdict, by_name = diagnosis.verdict, {comparison.feature.name: comparison for comparison in diagnosis.features}
    names = dict.fromkeys(comparison.feature for comparison in (*verdict.where, *verdict.unexplained))
    remaining = {comparison.feature: comparison.z for comparison in verdict.unexplained}
    return [replace(by_name[name], z_after=remaining.get(name, by_name[name].z_after)) for name in names]


def _row(verdict: Verdict, comparison: FeatureComparison) -> list[str]:
    feature = comparison.feature
    where, remaining = (_share(every, feature.name) for every in (verdict.where, verdict.unexplained))
    after = deviates(comparison.z_after)
    return [
        _says(comparison),
        deviates(comparison.z_before),
        where,
        *([marked("mark", after) if remaining else after, remaining] if verdict.acting else []),
        Markup("{}, {}, {}").format(feature.stage, WHEN[feature.regime], code(feature.name)),
    ]


def _says(comparison: FeatureComparison) -> str:
    return deviation_words(comparison.feature.name, comparison.z_before, comparison.feature.says)


def _share(every: Sequence[Deviation], name: str) -> str:
    """Share of a feature in the deviations; empty if it does not deviate."""
    return next((percent(deviation.share) for deviation in every if deviation.feature == name), "")


def _name(comparison: FeatureComparison, *, has_causes: bool) -> Markup:
    corrected = f"; corrected {deviates(comparison.z_after)} σ" if has_causes else ""
    note = f"{comparison.feature.name}: {deviates(comparison.z_before)} σ{corrected}"
    return Markup("<strong>{}</strong><br/>{}").format(_says(comparison), marked("note", note))
