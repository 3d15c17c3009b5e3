"""Sessions in a tuning's report: charts of yaw error over time, tables of its means."""

from collections.abc import Sequence

from markupsafe import Markup

from gyrodrift.evaluation.dataset import Split
from gyrodrift.report.chart import Mark
from gyrodrift.report.numbers import Numbers, degrees, even, mean
from gyrodrift.report.page import Section, marked, titled
from gyrodrift.tune.report.charts import drift_chart, error_scales
from gyrodrift.tune.result import SessionScore, Tuning

PANELS = 12
"""Most sessions in a figure: chosen, for a page of moderate length."""

MARKS = (Mark("plain", "plain", "key", "plain integration"), Mark("tuned", "tuned", "key", "tuned filter"))


def over_time(tuning: Tuning) -> Section | None:
    """Section of the charts; None without curves."""
    published = ((8, "training", Split.TRAIN), (9, "test", Split.TEST))
    figures = [
        {"published": number, "kind": kind, **_drawn(tuning.scores_on(split))}
        for number, kind, split in published
        if any(score.curves is not None for score in tuning.scores_on(split))
    ]
    values = {"figures": figures, "marks": MARKS}
    return Section("tune/report/templates/over_time.html", values, "Yaw error over time") if figures else None


def _drawn(scores: Sequence[SessionScore]) -> dict[str, object]:
    """Charts of the sessions of a split; of too many sessions the worst, the worst first."""
    shown = [score for score in scores if score.curves is not None]
    if len(scores) > PANELS:
        shown = sorted(shown, key=lambda score: -score.tuned.e_deg)[:PANELS]
    scales = error_scales([score.curves for score in shown if score.curves is not None])
    panels = [(_panel_name(score), drift_chart(score.curves, scales)) for score in shown if score.curves is not None]
    return {"panels": panels, "has_zoom": bool(scales.zoom_deg), "count": len(scores)}


def _panel_name(score: SessionScore) -> Markup:
    plain, tuned = marked("plain", degrees(score.euler.e_deg)), marked("tuned", degrees(score.tuned.e_deg))
    errors = Markup("E {} → {}").format(plain, tuned)
    return titled(score.session.name, errors)


def by_session(tuning: Tuning) -> Section:
    """The section of the tables."""
    train, test = tuning.scores_on(Split.TRAIN), tuning.scores_on(Split.TEST)
    splits = [row for row in ((2, "Training", train), (3, "Test", test)) if row[2]]
    scores = [score for score in tuning.scores if score.session.name in tuning.cross_validation]
    values = {
        "tables": [
            {"published": number, "kind": kind, "has_worse": any(map(_is_no_better, split)), **_scores_table(split)}
            for number, kind, split in splits
        ],
        "head": _scores_head(tuning.filter.reduced_model.title),
        "cross": _cross_validation_table(tuning, scores) if scores else None,
    }
    return Section("tune/report/templates/by_session.html", values, "Session by session")


def _scores_table(scores: Sequence[SessionScore]) -> dict[str, object]:
    columns = [
        [score.session.minutes for score in scores],
        [score.euler.e_deg for score in scores],
        [score.euler.ne for score in scores],
        [score.tuned.e_deg for score in scores],
        [score.tuned.ne for score in scores],
        [score.reduced.e_deg for score in scores],
    ]
    return _with_means([_session_name(score) for score in scores], columns)


def _scores_head(reduced_title: str) -> list[str]:
    plain, tuned = marked("plain", "plain integration"), marked("tuned", "tuned filter")
    errors = [Markup("{} {}").format(title, kind) for title in (plain, tuned) for kind in ("E", "NE")]
    return ["session", "minutes", *errors, Markup("{} E").format(marked("two", reduced_title))]


def _session_name(score: SessionScore) -> str:
    mark = marked("mark", "▲ worse")
    return Markup("{} {}").format(score.session.name, mark) if _is_no_better(score) else score.session.name


def _is_no_better(score: SessionScore) -> bool:
    """Whether the tuned filter is not better; a NaN is not better."""
    return not score.tuned.e_deg < score.euler.e_deg


def _with_means(names: Sequence[str], columns: Sequence[Numbers]) -> dict[str, object]:
    """Rows of columns, and a row of means; the digits suit each column."""
    cells = [even([*column, mean(column)]) for column in columns]
    *rows, means = (list(row) for row in zip([*names, "mean"], *cells, strict=True))
    return {"rows": rows, "means": means}


def _cross_validation_table(tuning: Tuning, scores: Sequence[SessionScore]) -> dict[str, object]:
    columns = [
        [score.euler.e_deg for score in scores],
        [score.tuned.e_deg for score in scores],
        [tuning.cross_validation[score.session.name].e_deg for score in scores],
    ]
    return _with_means([score.session.name for score in scores], columns)
