"""Tables of a comparison: means of all methods with a forest plot, then errors by folder and by session."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, floor, inf, isfinite, log10

import numpy as np
from markupsafe import Markup

from gyrodrift.compare.comparison import ComparedSession, Comparison, Entry, ParamsFrom
from gyrodrift.compare.report.files import best_of, cells, e_cell, shared, uncertainty_cells
from gyrodrift.evaluation.score import Score
from gyrodrift.report.numbers import factor_label, log_share, significant
from gyrodrift.report.page import Section, bold, macro, marked

TEMPLATE = "compare/report/templates/forest.html"

DOTS = 60
"""Most dots in a strip; more sessions are thinned at even steps from the best to the worst: chosen."""

MARGIN_PERCENT = 3.0
FEW_DECADES = 1.3
"""Length of an axis in decades below which it has marks at 1, 2 and 5: chosen."""

MARKS = 6


@dataclass(frozen=True, slots=True)
class ForestAxis:
    """A logarithmic axis of errors, deg."""

    low_deg: float
    high_deg: float

    def percent(self, error_deg: float) -> float:
        """Position of an error in percent of the width; an error outside of the axis is drawn at its end."""
        return MARGIN_PERCENT + (100.0 - 2.0 * MARGIN_PERCENT) * log_share(error_deg, self.low_deg, self.high_deg)

    @property
    def marks_deg(self) -> list[float]:
        """Errors at the marks, deg."""
        times = (1.0, 2.0, 5.0) if log10(self.high_deg / self.low_deg) < FEW_DECADES else (1.0,)
        powers = range(floor(log10(self.low_deg)), ceil(log10(self.high_deg)) + 1)
        inside = [time * 10.0**power for power in powers for time in times]
        kept = [mark for mark in inside if self.low_deg <= mark <= self.high_deg]
        return kept[:: ceil(len(kept) / MARKS) or 1]


def forest_axis(errors_deg: Sequence[float]) -> ForestAxis:
    """Axis for all positive and finite errors."""
    finite_deg = [error_deg for error_deg in errors_deg if 0.0 < error_deg < np.inf]
    low, high = min(finite_deg, default=0.1), max(finite_deg, default=1.0)
    if high < 1.5 * low:
        low, high = low / 2.0, high * 2.0
    return ForestAxis(low / 1.15, high * 1.15)


def strip(axis: ForestAxis, names: Sequence[str], errors_deg: Sequence[float], mean_deg: float, color: str) -> Markup:
    """Strip of a row: a dot for each session, a line from the smallest to the largest error, a bar at the mean."""
    ranked = sorted(zip(errors_deg, names, strict=True))
    rows = np.unique(np.linspace(0, len(ranked) - 1, DOTS).astype(int)).tolist()
    return macro(TEMPLATE, "strip")(axis, color, [ranked[row] for row in rows], mean_deg)


def scale(axis: ForestAxis) -> Markup:
    """The axis, for the last row of the table."""
    return macro(TEMPLATE, "scale")(axis, [(mark_deg, factor_label(mark_deg)) for mark_deg in axis.marks_deg])


def ranking(comparison: Comparison) -> Section:
    """Bars of the mean E, then the table of means, the best first, with a forest plot."""
    has_sigma = any(comparison.mean_uncertainties)
    units = ["E, deg", "NE, deg/min", "PI, deg²", "largest, deg", *["within 2σ", "CRPS, deg"] * has_sigma]
    scores = [score for session in comparison.sessions for score in session.scores]
    axis = forest_axis([score.e_deg for score in [*scores, *comparison.means]])
    names = [session_name(comparison, session) for session in comparison.sessions]
    rows, best = [], best_of(comparison)
    for row in comparison.ranked:
        entry, mean = comparison.entries[row], comparison.means[row]
        errors_deg = [session.scores[row].e_deg for session in comparison.sessions]
        drawn = strip(axis, names, errors_deg, mean.e_deg, entry.method.color)
        stated = uncertainty_cells(comparison.mean_uncertainties[row]) if has_sigma else []
        rows.append([_name(comparison, row, is_best=row == best), *cells(mean), *stated, drawn])
    rows += [[method.title, *["–"] * len(units), ""] for method in comparison.missing]
    values = {
        "bars": _mean_bars(comparison),
        "has_tuned": any(entry.is_tuned for entry in comparison.entries),
        "has_sigma": has_sigma,
        "has_offline": any(entry.method.is_offline for entry in comparison.entries),
        "count": len(comparison.sessions),
        "head": ["method", *units, "E of each session (dots) and its mean (bar), deg"],
        "rows": rows,
        "foot": ["", *[""] * len(units), scale(axis)],
    }
    return Section("compare/report/templates/ranking.html", values, "Yaw error by method")


def _mean_bars(comparison: Comparison) -> list[tuple[Entry, float, str]]:
    """Each entry with its mean E, as a share of a logarithmic scale and in words."""
    e_deg = [comparison.means[row].e_deg for row in comparison.ranked]
    known_deg = [value for value in e_deg if 0.0 < value < inf] or [1.0]
    low, high = 10.0 ** floor(log10(min(known_deg) / 1.5)), max(known_deg)
    entries = [comparison.entries[row] for row in comparison.ranked]
    return [
        (entry, log_share(value, low, high), f"{significant(value, 3)}°")
        for entry, value in zip(entries, e_deg, strict=True)
    ]


def _name(comparison: Comparison, row: int, *, is_best: bool) -> Markup:
    """Name of a row with its marks."""
    entry = comparison.entries[row]
    mark = shared(comparison, entry)
    marks = [marked("best", "best")] * is_best + [marked("mark", f"▲ {mark}")] * bool(mark)
    return Markup(" ").join([entry.title, *marks])


def by_folder(comparison: Comparison) -> Section | None:
    """Tables with a row of means for each folder; None for one folder."""
    rows = list(comparison.folders.items())
    values = {"caption": "Mean E in degrees, by folder", "tables": _by_method(comparison, "folder", rows)}
    return Section("compare/report/templates/by_method.html", values, "By folder") if len(rows) > 1 else None


def by_session(comparison: Comparison) -> Section:
    """Tables with a row for each session."""
    rows = [(session_name(comparison, session), session.scores) for session in comparison.sessions]
    values = {"caption": "E in degrees", "tables": _by_method(comparison, "session", rows, comparison.means)}
    return Section("compare/report/templates/by_method.html", values, "Session by session")


def session_name(comparison: Comparison, session: ComparedSession) -> str:
    """Name of a session, with its folder if there are several."""
    return f"{session.folder}/{session.session.name}" if len(comparison.folders) > 1 else session.session.name


def _by_method(
    comparison: Comparison, what: str, rows: Sequence[tuple[str, Sequence[Score]]], means: Sequence[Score] = ()
) -> list[dict[str, object]]:
    """Tables with a column for each entry, the best first: one without tuning, one with tuning."""
    return [
        {
            "kind": kind,
            "head": [what, *(comparison.entries[row].method.title for row in shown)],
            "rows": [[name, *_errors([scores[row] for row in shown])] for name, scores in rows],
            "means": ["mean", *(e_cell(means[row]) for row in shown)] if means else [],
        }
        for kind, shown in groups(comparison)
    ]


def _errors(scores: Sequence[Score]) -> list[str]:
    """Cells of E, the smallest in bold."""
    lowest_deg = min(score.e_deg for score in scores)
    return [
        bold(e_cell(score)) if isfinite(lowest_deg) and score.e_deg == lowest_deg else e_cell(score) for score in scores
    ]


def groups(comparison: Comparison) -> list[tuple[str, list[int]]]:
    """Rows of the entries without and with tuning, the best first."""
    given = [row for row in comparison.ranked if not comparison.entries[row].is_tuned]
    tuned = [row for row in comparison.ranked if comparison.entries[row].is_tuned]
    has_config = any(entry.source is ParamsFrom.CONFIG for entry in comparison.entries)
    kind = "with the config's parameters or their defaults" if has_config else "with their defaults"
    return [(kind, given), *[("tuned", tuned)] * bool(tuned)]
