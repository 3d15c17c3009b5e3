"""The sessions in the report of a tuning: from Figure 3 on yaw error over time, from Table 3 on its mean."""

from collections.abc import Sequence

from gyrodrift.evaluation.dataset import Split
from gyrodrift.html.html import figure, headings, panels, paragraph, section, span, switches, table, text
from gyrodrift.html.numbers import Numbers, degrees, even, mean
from gyrodrift.tune.report.figures import drift_svgs, heights
from gyrodrift.tune.report.numbering import figure_name, table_name
from gyrodrift.tune.result import SessionScore, Tuning

PANELS = 12
"""Sessions in a figure; with more of them the page would be long and say no more."""

LEGEND = switches([("plain", "plain", "key", "plain integration"), ("tuned", "tuned", "key", "tuned filter")])


def over_time(tuning: Tuning) -> str:
    """The section of the figures; nothing where there are no curves."""
    published = ((8, "training", Split.TRAIN), (9, "test", Split.TEST))
    drawn = [each for each in published if any(score.curves is not None for score in tuning.scores_on(each[2]))]
    parts = [
        _drift_figure(f"{figure_name(number, known_as)} Yaw error over time, {kind} sessions.", tuning.scores_on(split))
        for number, (known_as, kind, split) in enumerate(drawn, 3)
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
    given = [each for each in ((2, "Training", train), (3, "Test", test)) if each[2]]
    parts = [
        _scores_table(f"{table_name(number, known_as)} {kind} sessions.", scores, tuning.filter.reduced_model.title)
        for number, (known_as, kind, scores) in enumerate(given, 3)
    ]
    words = (
        "E is the mean absolute yaw error in degrees, NE is E divided by the session's minutes, in degrees a minute."
    )
    return section("Session by session", paragraph(words), *parts, _cross_validation_table(tuning, 3 + len(parts)))


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
    plain, tuned, reduced = (
        span(title, colour)
        for title, colour in (("plain integration", "plain"), ("tuned filter", "tuned"), (reduced_title, "two"))
    )
    return headings(["session", "minutes", f"{plain} E", f"{plain} NE", f"{tuned} E", f"{tuned} NE", f"{reduced} E"])


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


def _cross_validation_table(tuning: Tuning, number: int) -> str:
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
        f"{table_name(number)} Leave-one-session-out cross-validation. E in degrees of each session under parameters "
        "tuned on all others: what to expect of a new session."
    )
    return _with_means(caption, head, [text(score.session.name) for score in scores], columns)
