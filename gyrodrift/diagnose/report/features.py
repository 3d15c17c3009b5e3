"""The features in a report: every feature that deviates, as a table and as charts."""

from collections.abc import Sequence
from dataclasses import replace

from gyrodrift.diagnose.features.feature import WHEN
from gyrodrift.diagnose.inference.evidence import FAMILY_WISE_ERROR
from gyrodrift.diagnose.inference.gap import WORST_Z, Deviation
from gyrodrift.diagnose.inference.verdict import Verdict
from gyrodrift.diagnose.predictive_checks.feature_comparison import FeatureComparison
from gyrodrift.diagnose.report.effect_words import deviation_words
from gyrodrift.diagnose.report.figures import feature_svgs
from gyrodrift.diagnose.report.text import NAMES, deviates, marks, number, percent
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.html.html import figure, headings, panels, paragraph, section, span, table, text

MEASURED = (
    "single numbers, such as by how much the rate error grows with the rate. The deviation of a feature is the "
    "difference between the two in units of σ, the standard deviation that it has between two runs of the simulator "
    "alone, with an allowance for differences too small to matter for yaw."
)


def _measured(diagnosis: Diagnosis) -> str:
    return (
        "The simulator was driven through the motion of each recording, and "
        f"{len(diagnosis.features)} features were measured on both: {MEASURED}"
    )


def features(diagnosis: Diagnosis) -> str:
    """The section of the deviating features."""
    compared = _listed(diagnosis)
    if not compared:
        return section("Where recordings and simulator differ", paragraph(_nowhere(diagnosis)))
    return section(
        "Where recordings and simulator differ",
        paragraph(_introduction(diagnosis)),
        _table(diagnosis, compared),
        _charts(diagnosis, compared),
    )


def _listed(diagnosis: Diagnosis) -> list[FeatureComparison]:
    """Features that deviate without or with the causes; those that deviate without them first, in order of size."""
    verdict, by_name = diagnosis.verdict, {comparison.feature.name: comparison for comparison in diagnosis.features}
    names = dict.fromkeys(comparison.feature for comparison in (*verdict.where, *verdict.unexplained))
    remaining = {comparison.feature: comparison.z for comparison in verdict.unexplained}
    return [replace(by_name[name], z_after=remaining.get(name, by_name[name].z_after)) for name in names]


def _introduction(diagnosis: Diagnosis) -> str:
    corrected = ", or by as much from the corrected simulator, in which the named causes act at their fitted sizes"
    return (
        f"{_measured(diagnosis)} Listed is every feature that deviates by more than {number(diagnosis.threshold_z)} σ "
        f"over all sessions{corrected * bool(diagnosis.verdict.acting)}. {_family_wise(diagnosis)}"
    )


def _family_wise(diagnosis: Diagnosis) -> str:
    """The meaning of the threshold, in a sentence."""
    return (
        f"Chance alone takes one of the {len(diagnosis.features)} features beyond {number(diagnosis.threshold_z)} σ in "
        f"{number(100.0 * FAMILY_WISE_ERROR)} % of such sets of sessions."
    )


def _nowhere(diagnosis: Diagnosis) -> str:
    """The text of the section if no feature deviates."""
    worst = max(diagnosis.features, key=lambda comparison: abs(comparison.z_before))
    return (
        f"Nowhere. {_measured(diagnosis)} The largest deviation is {deviates(worst.z_before)} σ "
        f"({text(worst.feature.says)}); only more than {number(diagnosis.threshold_z)} σ counts. "
        f"{_family_wise(diagnosis)}"
    )


def _table(diagnosis: Diagnosis, compared: Sequence[FeatureComparison]) -> str:
    has_causes = bool(diagnosis.verdict.acting)
    after = [f"{NAMES[2]}, σ", "share"] * has_causes
    first = f"{NAMES[1]}, σ" if has_causes else "deviation, σ"
    head = headings(["what deviates", first, "share", *after, "stage, when, name"], words=1)
    caption = (
        "Deviations, the largest first. Share: of the sum of squares of all deviations, each limited to "
        f"{WORST_Z:g} σ. The last column says which stage of the rig the feature speaks of, when, and what "
        "<code>gap.json</code> calls it."
    )
    return table(caption, head, [_row(diagnosis.verdict, comparison) for comparison in compared], words=1)


def _row(verdict: Verdict, comparison: FeatureComparison) -> list[str]:
    where, remaining = (_share(every, comparison.feature.name) for every in (verdict.where, verdict.unexplained))
    cells = [text(_says(comparison)), deviates(comparison.z_before), where]
    if verdict.acting:
        after = deviates(comparison.z_after)
        cells += [span(after, "mark") if remaining else after, remaining]
    return [
        *cells,
        f"{comparison.feature.stage}, {WHEN[comparison.feature.regime]}, <code>{text(comparison.feature.name)}</code>",
    ]


def _says(comparison: FeatureComparison) -> str:
    return deviation_words(comparison.feature.name, comparison.z_before, comparison.feature.says)


def _share(every: Sequence[Deviation], name: str) -> str:
    """Share of a feature in the deviations; empty if it does not deviate."""
    return next((percent(deviation.share) for deviation in every if deviation.feature == name), "")


def _charts(diagnosis: Diagnosis, compared: Sequence[FeatureComparison]) -> str:
    has_causes = bool(diagnosis.verdict.acting)
    apart = has_causes and len(diagnosis.sessions) > 1
    fitted = " The correction of each session is fitted on the other sessions." * apart
    words = (
        "A dot is a recording, a line what the simulator gives for the same motion, and the bar around it ± 2 σ of "
        f"chance. A dot inside a bar is explained.{fitted}"
    )
    legend = marks(has_causes=has_causes, has_left=False)
    names = [_name(comparison, has_causes=has_causes) for comparison in compared]
    return figure(
        f"<b>Each deviating feature, session by session.</b> {words}<br/>{legend}",
        panels(names, feature_svgs(compared, has_causes=has_causes)),
    )


def _name(comparison: FeatureComparison, *, has_causes: bool) -> str:
    corrected = f"; corrected {deviates(comparison.z_after)} σ" if has_causes else ""
    off = f"{text(comparison.feature.name)}: {deviates(comparison.z_before)} σ{corrected}"
    return f"<strong>{text(_says(comparison))}</strong><br/>{span(off, 'note')}"
