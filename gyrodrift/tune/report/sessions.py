"""The sessions in the report of a tuning: Figures 8 and 9, yaw error over time; Tables 2 and 3, its mean."""

from collections.abc import Sequence

from gyrodrift.evaluation.dataset import Split
from gyrodrift.html.html import figure, headings, legend, panels, paragraph, section, span, table, text
from gyrodrift.html.numbers import Numbers, degrees, even, mean
from gyrodrift.tune.report.figures import drift_svgs, heights
from gyrodrift.tune.result import Curve, SessionScore, Tuning

PANELS = 12
"""Sessions in a figure; with more of them the page would be long and say no more."""

LEGEND = legend([("plain", "key", "plain integration"), ("tuned", "key", "tuned filter")])


def scores_of(tuning: Tuning, split: Split) -> list[SessionScore]:
    """The sessions of a split."""
    return [score for score in tuning.scores if score.split is split]


def over_time(tuning: Tuning) -> str:
    """The section of the figures; nothing where there are no curves."""
    numbered = ((8, "training", _shown(tuning, Split.TRAIN)), (9, "test", _shown(tuning, Split.TEST)))
    parts = [
        _drift_figure(tuning, f"<b>Figure {number}.</b> Yaw error over time, {kind} sessions.", curves)
        for number, kind, curves in numbered
        if curves
    ]
    return section("Yaw error over time", *parts) if parts else ""


def _shown(tuning: Tuning, split: Split) -> list[Curve]:
    """The curves of a split; of too many the worst ones, the worst first."""
    curves = [curve for curve in tuning.curves if curve.split is split]
    if len(curves) <= PANELS:
        return curves
    e_deg = {score.name: score.e_tuned_deg for score in scores_of(tuning, split)}
    return sorted(curves, key=lambda curve: -e_deg.get(curve.name, 0.0))[:PANELS]


def _drift_figure(tuning: Tuning, title: str, curves: Sequence[Curve]) -> str:
    split = curves[0].split
    scales = heights(curves)
    said = [f"{title} {LEGEND}<br/>All panels have the same scales of degrees."]
    if scales.zoom_deg:
        said += ["Each is drawn twice: whole, and below enlarged so that the tuned filter's error can be read."]
    total = sum(curve.split is split for curve in tuning.curves)
    if total > len(curves):
        said += [f"Of {total} sessions the {len(curves)} with the largest E of the tuned filter, the worst first."]
    scores = {score.name: score for score in scores_of(tuning, split)}
    names = [_curve_name(curve, scores.get(curve.name)) for curve in curves]
    return figure(" ".join(said), panels(names, drift_svgs(curves, scales)))


def _curve_name(curve: Curve, score: SessionScore | None) -> str:
    name = f'<b title="{text(curve.name)}">{text(curve.name)}</b>'
    if score is None:
        return name
    plain, tuned = span(degrees(score.e_euler_deg), "plain"), span(degrees(score.e_tuned_deg), "tuned")
    return name + span(f"E {plain} → {tuned}", "note")


def by_session(tuning: Tuning) -> str:
    """The section of the tables."""
    train, test = scores_of(tuning, Split.TRAIN), scores_of(tuning, Split.TEST)
    parts = [
        _scores_table(f"<b>Table {number}.</b> {kind} sessions.", scores, tuning.tunable.few_title)
        for number, kind, scores in ((2, "Training", train), (3, "Test", test))
        if scores
    ]
    words = (
        "E is the mean absolute yaw error in degrees, NE is E divided by the session's minutes, in degrees a minute."
    )
    return section("Session by session", paragraph(words), *parts, _left_out_table(tuning))


def _scores_table(caption: str, scores: Sequence[SessionScore], few_title: str) -> str:
    columns = [
        [score.minutes for score in scores],
        [score.e_euler_deg for score in scores],
        [score.ne_euler for score in scores],
        [score.e_tuned_deg for score in scores],
        [score.ne_tuned for score in scores],
        [score.e_few_deg for score in scores],
    ]
    if any(map(_is_no_better, scores)):
        caption += " Where the tuned filter is no better than plain integration, the name is marked."
    return _with_means(caption, _scores_head(few_title), [_session_name(score) for score in scores], columns)


def _scores_head(few_title: str) -> str:
    group = (
        '<tr><th></th><th></th><th colspan="2" class="number plain">plain integration</th>'
        f'<th colspan="2" class="number tuned">tuned filter</th><th class="number two">{few_title}</th></tr>\n'
    )
    return group + headings(["session", "minutes", "E", "NE", "E", "NE", "E"])


def _session_name(score: SessionScore) -> str:
    mark = f" {span('▲ worse', 'mark')}" if _is_no_better(score) else ""
    return text(score.name) + mark


def _is_no_better(score: SessionScore) -> bool:
    """No number is no gain either."""
    return not score.e_tuned_deg < score.e_euler_deg


def _with_means(caption: str, head: str, names: Sequence[str], columns: Sequence[Numbers]) -> str:
    """A table of these columns, each with digits of its own, and with a row of their means."""
    cells = [even([*column, mean(column)]) for column in columns]
    *rows, means = (list(row) for row in zip([*names, "mean"], *cells, strict=True))
    return table(caption, head, rows, means)


def _left_out_table(tuning: Tuning) -> str:
    scores = [score for score in tuning.scores if score.name in tuning.left_out]
    if not scores:
        return ""
    columns = [
        [score.e_euler_deg for score in scores],
        [score.e_tuned_deg for score in scores],
        [tuning.left_out[score.name] for score in scores],
    ]
    head = headings(["session", "plain integration", "tuned on all", "tuned on the others"])
    caption = (
        "<b>Left out in turn.</b> E in degrees of each session under parameters tuned on all others: what to expect "
        "of a new session."
    )
    return _with_means(caption, head, [text(score.name) for score in scores], columns)
