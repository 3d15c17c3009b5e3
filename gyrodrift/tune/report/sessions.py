"""The sessions in the report of a tuning: Figures 8 and 9, yaw error over time; Tables 2 and 3, its mean."""

from collections.abc import Sequence

from gyrodrift.evaluation.dataset import Split
from gyrodrift.html.html import figure, headings, legend, panels, paragraph, section, span, table, text
from gyrodrift.html.numbers import Numbers, degrees, even, mean
from gyrodrift.tune.report.figures import drift_svgs, heights
from gyrodrift.tune.result import SessionScore, Tuning

PANELS = 12
"""Sessions in a figure; with more of them the page would be long and say no more."""

LEGEND = legend([("plain", "key", "plain integration"), ("tuned", "key", "tuned filter")])


def over_time(tuning: Tuning) -> str:
    """The section of the figures; nothing where there are no curves."""
    numbered = ((8, "training", Split.TRAIN), (9, "test", Split.TEST))
    parts = [
        _drift_figure(f"<b>Figure {number}.</b> Yaw error over time, {kind} sessions.", tuning.scores_on(split))
        for number, kind, split in numbered
        if any(score.curves is not None for score in tuning.scores_on(split))
    ]
    return section("Yaw error over time", *parts) if parts else ""


def _drift_figure(title: str, scores: Sequence[SessionScore]) -> str:
    """Of too many sessions the worst ones, the worst first."""
    shown = [score for score in scores if score.curves is not None]
    if len(scores) > PANELS:
        shown = sorted(shown, key=lambda score: -score.tuned.e_deg)[:PANELS]
    curves = [score.curves for score in shown if score.curves is not None]
    scales = heights(curves)
    said = [f"{title} {LEGEND}<br/>All panels have the same scales of degrees."]
    if scales.zoom_deg:
        said += ["Each is drawn twice: whole, and below enlarged so that the tuned filter's error can be read."]
    if len(scores) > len(shown):
        said += [f"Of {len(scores)} sessions the {len(shown)} with the largest E of the tuned filter, the worst first."]
    names = [_panel_name(score) for score in shown]
    return figure(" ".join(said), panels(names, drift_svgs(curves, shown[0].split, scales)))


def _panel_name(score: SessionScore) -> str:
    name = text(score.session.name)
    plain, tuned = span(degrees(score.euler.e_deg), "plain"), span(degrees(score.tuned.e_deg), "tuned")
    return f'<b title="{name}">{name}</b>' + span(f"E {plain} → {tuned}", "note")


def by_session(tuning: Tuning) -> str:
    """The section of the tables."""
    train, test = tuning.scores_on(Split.TRAIN), tuning.scores_on(Split.TEST)
    parts = [
        _scores_table(f"<b>Table {number}.</b> {kind} sessions.", scores, tuning.filter.reduced_model.title)
        for number, kind, scores in ((2, "Training", train), (3, "Test", test))
        if scores
    ]
    words = (
        "E is the mean absolute yaw error in degrees, NE is E divided by the session's minutes, in degrees a minute."
    )
    return section("Session by session", paragraph(words), *parts, _cross_validation_table(tuning))


def _scores_table(caption: str, scores: Sequence[SessionScore], reduced_title: str) -> str:
    columns = [
        [score.session.minutes for score in scores],
        [score.euler.e_deg for score in scores],
        [score.euler.ne for score in scores],
        [score.tuned.e_deg for score in scores],
        [score.tuned.ne for score in scores],
        [score.reduced.e_deg for score in scores],
    ]
    if any(map(_is_no_better, scores)):
        caption += " Where the tuned filter is no better than plain integration, the name is marked."
    return _with_means(caption, _scores_head(reduced_title), [_session_name(score) for score in scores], columns)


def _scores_head(reduced_title: str) -> str:
    group = (
        '<tr><th></th><th></th><th colspan="2" class="number plain">plain integration</th>'
        f'<th colspan="2" class="number tuned">tuned filter</th><th class="number two">{reduced_title}</th></tr>\n'
    )
    return group + headings(["session", "minutes", "E", "NE", "E", "NE", "E"])


def _session_name(score: SessionScore) -> str:
    mark = f" {span('▲ worse', 'mark')}" if _is_no_better(score) else ""
    return text(score.session.name) + mark


def _is_no_better(score: SessionScore) -> bool:
    """No number is no gain either."""
    return not score.tuned.e_deg < score.euler.e_deg


def _with_means(caption: str, head: str, names: Sequence[str], columns: Sequence[Numbers]) -> str:
    """A table of these columns, each with digits of its own, and with a row of their means."""
    cells = [even([*column, mean(column)]) for column in columns]
    *rows, means = (list(row) for row in zip([*names, "mean"], *cells, strict=True))
    return table(caption, head, rows, means)


def _cross_validation_table(tuning: Tuning) -> str:
    scores = [score for score in tuning.scores if score.session.name in tuning.cross_validation]
    if not scores:
        return ""
    columns = [
        [score.euler.e_deg for score in scores],
        [score.tuned.e_deg for score in scores],
        [tuning.cross_validation[score.session.name].e_deg for score in scores],
    ]
    head = headings(["session", "plain integration", "tuned on all", "tuned on the others"])
    caption = (
        "<b>Leave-one-session-out cross-validation.</b> E in degrees of each session under parameters tuned on all "
        "others: what to expect of a new session."
    )
    return _with_means(caption, head, [text(score.session.name) for score in scores], columns)
