"""Sessions in the report of a tuning: figures of yaw error over time, tables of its means."""

from collections.abc import Sequence

from gyrodrift.evaluation.dataset import Split
from gyrodrift.html.html import figure, headings, panels, paragraph, section, span, switches, table, text
from gyrodrift.html.numbers import Numbers, degrees, even, mean
from gyrodrift.tune.report.figures import drift_svgs, error_scales
from gyrodrift.tune.report.numbering import figure_name, table_name
from gyrodrift.tune.result import SessionScore, Tuning

PANELS = 12
"""Most sessions in a figure: chosen, for a page of moderate length."""

LEGEND = switches([("plain", "plain", "key", "plain integration"), ("tuned", "tuned", "key", "tuned filter")])


def over_time(tuning: Tuning) -> str:
    """Section of the figures; empty without curves."""
    published = ((8, "training", Split.TRAIN), (9, "test", Split.TEST))
    drawn = [row for row in published if any(score.curves is not None for score in tuning.scores_on(row[2]))]
    parts = [
        _drift_figure(f"{figure_name(number, known_as)} Yaw error over time, {kind} sessions.", tuning.scores_on(split))
        for number, (known_as, kind, split) in enumerate(drawn, 3)
    ]
    return section("Yaw error over time", *parts) if parts else ""


def _drift_figure(title: str, scores: Sequence[SessionScore]) -> str:
    """Figure of the sessions of a split; of too many sessions the worst, the worst first."""
    shown = [score for score in scores if score.curves is not None]
    if len(scores) > PANELS:
        shown = sorted(shown, key=lambda score: -score.tuned.e_deg)[:PANELS]
    curves = [score.curves for score in shown if score.curves is not None]
    scales = error_scales(curves)
    sentences = [f"{title} {LEGEND}<br/>All panels have the same scales."]
    if scales.zoom_deg:
        sentences += ["Each session has a second panel with an enlarged scale."]
    if len(scores) > len(shown):
        sentences += [
            f"The {len(shown)} of {len(scores)} sessions with the largest E of the tuned filter, the worst first."
        ]
    names = [_panel_name(score) for score in shown]
    return figure(" ".join(sentences), panels(names, drift_svgs(curves, shown[0].split, scales)))


def _panel_name(score: SessionScore) -> str:
    name = text(score.session.name)
    plain, tuned = span(degrees(score.euler.e_deg), "plain"), span(degrees(score.tuned.e_deg), "tuned")
    return f'<b title="{name}">{name}</b>' + span(f"E {plain} → {tuned}", "note")


def by_session(tuning: Tuning) -> str:
    """The section of the tables."""
    train, test = tuning.scores_on(Split.TRAIN), tuning.scores_on(Split.TEST)
    given = [row for row in ((2, "Training", train), (3, "Test", test)) if row[2]]
    parts = [
        _scores_table(f"{table_name(number, known_as)} {kind} sessions.", scores, tuning.filter.reduced_model.title)
        for number, (known_as, kind, scores) in enumerate(given, 3)
    ]
    words = "E is the mean absolute yaw error, deg. NE is E divided by the duration, deg/min."
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
        caption += " A session on which the tuned filter is not better than plain integration is marked."
    return _with_means(caption, _scores_head(reduced_title), [_session_name(score) for score in scores], columns)


def _scores_head(reduced_title: str) -> str:
    plain, tuned, reduced = (
        span(title, color)
        for title, color in (("plain integration", "plain"), ("tuned filter", "tuned"), (reduced_title, "two"))
    )
    return headings(["session", "minutes", f"{plain} E", f"{plain} NE", f"{tuned} E", f"{tuned} NE", f"{reduced} E"])


def _session_name(score: SessionScore) -> str:
    mark = f" {span('▲ worse', 'mark')}" if _is_no_better(score) else ""
    return text(score.session.name) + mark


def _is_no_better(score: SessionScore) -> bool:
    """Whether the tuned filter is not better; a NaN is not better."""
    return not score.tuned.e_deg < score.euler.e_deg


def _with_means(caption: str, head: str, names: Sequence[str], columns: Sequence[Numbers]) -> str:
    """Table of columns with a row of means; the digits suit each column."""
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
    head = headings(["session", "plain integration", "tuned on all", "tuned on the other sessions"])
    caption = (
        f"{table_name(number)} Leave-one-session-out cross-validation. E in degrees of each session with parameters "
        "tuned on all other sessions: the error to expect on a new session."
    )
    return _with_means(caption, head, [text(score.session.name) for score in scores], columns)
