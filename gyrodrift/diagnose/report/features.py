"""Where simulator and recordings part, in a report: every feature that stands out, as a table and as charts."""

from collections.abc import Sequence

import numpy as np

from gyrodrift.diagnose.diagnosis import Diagnosis
from gyrodrift.diagnose.features.vector import FEATURES
from gyrodrift.diagnose.inference.verdict import LEFT_OVER, STANDS_OUT, Deviation, Verdict, together
from gyrodrift.diagnose.report.compared import FeatureComparison, compared_of
from gyrodrift.diagnose.report.figures import feature_svgs
from gyrodrift.diagnose.report.text import deviates, marks, percent
from gyrodrift.html.html import figure, headings, panels, paragraph, section, span, table, text


def features(diagnosis: Diagnosis) -> str:
    """The section."""
    compared = compared_of(diagnosis)
    if not compared:
        return section("Where they differ", paragraph(_nowhere(diagnosis)))
    return section(
        "Where they differ", paragraph(_introduction()), _table(diagnosis, compared), _charts(diagnosis, compared)
    )


def _introduction() -> str:
    return (
        f"{len(FEATURES)} features were measured on each recording and on the simulator driven through the same "
        "motion. A feature is one number, such as how the rate error grows with the rate. Listed is every one that "
        f"is off by more than {STANDS_OUT:g} times what chance does over all sessions (a standard deviation, from "
        f"simulations without any gap), or by more than {LEFT_OVER:g} times after the causes are added."
    )


def _nowhere(diagnosis: Diagnosis) -> str:
    z = np.abs(together(diagnosis.drawn.attribution.evidence.z))
    worst = FEATURES[int(np.argmax(z))]
    return (
        f"Nowhere. Of {len(FEATURES)} features measured on each recording and on the simulator driven through the "
        f"same motion, the largest is off by {deviates(float(z.max()))} times what chance does ({text(worst.says)}); "
        f"it takes {STANDS_OUT:g} to stand out."
    )


def _table(diagnosis: Diagnosis, compared: Sequence[FeatureComparison]) -> str:
    has_causes = bool(diagnosis.verdict.causes)
    after = ["left over", "share"] * has_causes
    head = headings(["what it says", "times chance", "share", *after, "signature", "stage", "when"], words=3)
    caption = "Worst first. Share: of the squares of all that stands out, each held at 20 times chance."
    return table(caption, head, [_row(diagnosis.verdict, one) for one in compared], words=3)


def _row(verdict: Verdict, one: FeatureComparison) -> list[str]:
    where, left = (_share(odds, one.feature.name) for odds in (verdict.where, verdict.leftover))
    cells = [text(one.feature.says), deviates(one.z_before), where]
    if verdict.causes:
        after = deviates(one.z_after)
        cells += [span(after, "mark") if left else after, left]
    return [*cells, f"<code>{text(one.feature.name)}</code>", one.feature.stage, one.feature.regime]


def _share(odds: Sequence[Deviation], name: str) -> str:
    """Empty where the feature does not stand out."""
    return next((percent(odd.share) for odd in odds if odd.feature == name), "")


def _charts(diagnosis: Diagnosis, compared: Sequence[FeatureComparison]) -> str:
    has_causes = bool(diagnosis.verdict.causes)
    apart = "; the causes are fitted on the other sessions" if has_causes and len(diagnosis.sessions) > 1 else ""
    words = (
        "A dot is a recording. A bar is what the simulator gives on the same motion, with the range that chance leaves "
        f"to it (two standard deviations){apart}. A dot inside a bar is explained."
    )
    legend = marks(has_causes=has_causes, has_left=False)
    names = [_name(one) for one in compared]
    return figure(f"<b>Real beside simulated.</b> {words}<br/>{legend}", panels(names, feature_svgs(compared)))


def _name(one: FeatureComparison) -> str:
    after = "" if one.after is None else f" → {deviates(one.z_after)}"
    off = f"off {deviates(one.z_before)}{after} times chance"
    where = f"{text(one.feature.stage)}, {text(one.feature.name)}"
    return f"<strong>{text(one.feature.says)}</strong><br/>{span(f'{where}: {off}', 'note')}"
