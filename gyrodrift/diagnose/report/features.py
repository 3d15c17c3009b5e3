"""Where simulator and recordings part, in a report: every feature that deviates, as a table and as charts."""

from collections.abc import Sequence
from dataclasses import replace

from gyrodrift.diagnose.features.vector import FEATURES
from gyrodrift.diagnose.inference.deviations import UNEXPLAINED, Deviation
from gyrodrift.diagnose.inference.family_wise import FAMILY_WISE_ERROR
from gyrodrift.diagnose.inference.verdict import Verdict
from gyrodrift.diagnose.predictive_checks.feature_comparison import FeatureComparison
from gyrodrift.diagnose.report.figures import feature_svgs
from gyrodrift.diagnose.report.text import deviates, marks, number, percent
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.html.html import figure, headings, panels, paragraph, section, span, table, text


def features(diagnosis: Diagnosis) -> str:
    """The section."""
    compared = _listed(diagnosis)
    if not compared:
        return section("Where they differ", paragraph(_nowhere(diagnosis)))
    return section(
        "Where they differ",
        paragraph(_introduction(diagnosis)),
        _table(diagnosis, compared),
        _charts(diagnosis, compared),
    )


def _listed(diagnosis: Diagnosis) -> list[FeatureComparison]:
    """Every feature that deviates before or after, the worst before first."""
    verdict, by_name = diagnosis.verdict, {one.feature.name: one for one in diagnosis.features}
    names = dict.fromkeys(one.feature for one in (*verdict.where, *verdict.unexplained))
    left = {one.feature: one.z for one in verdict.unexplained}
    return [replace(by_name[name], z_after=left.get(name, by_name[name].z_after)) for name in names]


def _introduction(diagnosis: Diagnosis) -> str:
    return (
        f"{len(FEATURES)} features were measured on each recording and on the simulator driven through the same "
        "motion. A feature is one number, such as how the rate error grows with the rate. Listed is every one that "
        f"deviates by more than {number(diagnosis.stands_out)} times what chance does over all sessions (a standard "
        "deviation, from simulations without any gap, with the relevance threshold below which a feature does not "
        f"matter for yaw), or by more than {number(UNEXPLAINED * diagnosis.stands_out)} times after the causes are "
        f"added. {_family_wise(diagnosis)}"
    )


def _family_wise(diagnosis: Diagnosis) -> str:
    """Where the threshold comes from."""
    return (
        f"The {number(diagnosis.stands_out)} belong to this rig, these motions and this number of sessions: in "
        f"{number(100.0 * FAMILY_WISE_ERROR)} % of such sets of sessions without a gap, chance takes even one of all "
        "features further."
    )


def _nowhere(diagnosis: Diagnosis) -> str:
    worst = max(diagnosis.features, key=lambda one: abs(one.z_before))
    return (
        f"Nowhere. Of {len(FEATURES)} features measured on each recording and on the simulator driven through the "
        f"same motion, the largest deviates by {deviates(worst.z_before)} times what chance does "
        f"({text(worst.feature.says)}); {number(diagnosis.stands_out)} count as a deviation. {_family_wise(diagnosis)}"
    )


def _table(diagnosis: Diagnosis, compared: Sequence[FeatureComparison]) -> str:
    has_causes = bool(diagnosis.verdict.acting)
    after = ["unexplained", "share"] * has_causes
    head = headings(["what it says", "times chance", "share", *after, "feature", "stage", "when"], words=3)
    caption = "Worst first. Share: of the squares of all deviations, each held at 20 times chance."
    return table(caption, head, [_row(diagnosis.verdict, one) for one in compared], words=3)


def _row(verdict: Verdict, one: FeatureComparison) -> list[str]:
    where, left = (_share(every, one.feature.name) for every in (verdict.where, verdict.unexplained))
    cells = [text(one.feature.says), deviates(one.z_before), where]
    if verdict.acting:
        after = deviates(one.z_after)
        cells += [span(after, "mark") if left else after, left]
    return [*cells, f"<code>{text(one.feature.name)}</code>", one.feature.stage, one.feature.regime]


def _share(every: Sequence[Deviation], name: str) -> str:
    """Empty where the feature does not deviate."""
    return next((percent(one.share) for one in every if one.feature == name), "")


def _charts(diagnosis: Diagnosis, compared: Sequence[FeatureComparison]) -> str:
    has_causes = bool(diagnosis.verdict.acting)
    apart = "; the causes are fitted on the other sessions" if has_causes and len(diagnosis.sessions) > 1 else ""
    words = (
        "A dot is a recording. A bar is what the simulator gives on the same motion, with the range that chance leaves "
        f"to it (two standard deviations){apart}. A dot inside a bar is explained."
    )
    legend = marks(has_causes=has_causes, has_left=False)
    names = [_name(one, has_causes=has_causes) for one in compared]
    return figure(
        f"<b>Real beside simulated.</b> {words}<br/>{legend}",
        panels(names, feature_svgs(compared, has_causes=has_causes)),
    )


def _name(one: FeatureComparison, *, has_causes: bool) -> str:
    after = f" → {deviates(one.z_after)}" if has_causes else ""
    off = f"off {deviates(one.z_before)}{after} times chance"
    where = f"{text(one.feature.stage)}, {text(one.feature.name)}"
    return f"<strong>{text(one.feature.says)}</strong><br/>{span(f'{where}: {off}', 'note')}"
