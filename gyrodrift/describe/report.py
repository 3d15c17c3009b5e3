"""Sessions as a page: for each its yaw error, yaw, bias, and how it was recorded."""

from collections.abc import Sequence
from math import isfinite

from markupsafe import Markup

from gyrodrift.describe.drawing import DescribedSession, Panel
from gyrodrift.describe.listing import duration_text
from gyrodrift.describe.overview import SessionRow, bias_at_rest, row_of
from gyrodrift.describe.recording_panels import recording_panels
from gyrodrift.describe.text import Group
from gyrodrift.describe.yaw import last_error, mean_absolute
from gyrodrift.describe.yaw_panels import error_panel, histogram_panel, yaw_panels
from gyrodrift.report.chart import Chart
from gyrodrift.report.numbers import even, mean
from gyrodrift.report.page import Section, page
from gyrodrift.report.provenance import Provenance, provenance
from gyrodrift.values.constants import SECONDS_PER_HOUR
from gyrodrift.values.noise import (
    FLICKER_WORDS,
    ROOT_SECONDS_PER_ROOT_HOUR,
)

UNKNOWN = "–"

SHARED = {
    "last_error": last_error,
    "mean_absolute": mean_absolute,
    "isfinite": isfinite,
    "per_root_hour": ROOT_SECONDS_PER_ROOT_HOUR,
    "per_hour": SECONDS_PER_HOUR,
}
"""Functions and units of the template of a session."""

DRAWN = 12
"""Only this many sessions have figures; the table has all of them."""

HEAD = [
    "session",
    "min",
    "Hz",
    "missing",
    "bias, deg/s",
    "random walk, °/\u2060√h",
    "bias instability, °/\u2060h",
    "raw error",
    "corrected error",
]


class SessionsPage:
    """A page that is filled session by session."""

    def __init__(self) -> None:
        self._rows: list[SessionRow] = []
        self._chapters: list[Section] = []

    def add(self, described: DescribedSession, groups: Sequence[Group]) -> None:
        """Add the next session; `groups` is its full text."""
        self._rows.append(row_of(described.session.name, described.description, described.yaw))
        if len(self._rows) <= DRAWN:
            self._chapters.append(_chapter(len(self._rows), described, groups))

    def html(self, made: Provenance) -> str:
        """The file."""
        sections = [_head(self._rows, made), _overview(self._rows), *self._chapters, provenance(made)]
        return page(f"{made.set_name}: recorded sessions", sections)


def _head(rows: Sequence[SessionRow], made: Provenance) -> Section:
    errors = [row.errors for row in rows if row.errors is not None]
    values = {
        "made": made,
        "count": len(rows),
        "minutes": sum(row.duration_s for row in rows) / 60.0,
        "with_encoder": len(errors),
        "raw_deg": mean([error.raw_mean_deg for error in errors]),
        "corrected_deg": mean([error.corrected_mean_deg for error in errors]),
    }
    return Section("describe/templates/head.html", values)


def _overview(rows: Sequence[SessionRow]) -> Section | None:
    """Table of all sessions; None for a single session."""
    errors = [row.errors for row in rows]
    columns = (
        [f"{number}. {row.name}" for number, row in enumerate(rows, 1)],
        _column([row.duration_s / 60.0 for row in rows]),
        _column([row.rate_hz for row in rows]),
        [str(row.missing) for row in rows],
        _column([row.bias_dps for row in rows]),
        _column([row.walk_deg_rts for row in rows], factor=ROOT_SECONDS_PER_ROOT_HOUR),
        _column([row.instability_dps for row in rows], factor=SECONDS_PER_HOUR),
        _column([None if error is None else error.raw_mean_deg for error in errors], "°"),
        _column([None if error is None else error.corrected_mean_deg for error in errors], "°"),
    )
    values = {"head": HEAD, "rows": list(zip(*columns, strict=True)), "noise": FLICKER_WORDS, "drawn": DRAWN}
    return Section("describe/templates/overview.html", values, "All sessions") if len(rows) > 1 else None


def _column(values: Sequence[float | None], unit: str = "", factor: float = 1.0) -> list[str]:
    numbers = even([float("nan") if value is None else factor * value for value in values])
    return [UNKNOWN if value is None else f"{number}{unit}" for value, number in zip(values, numbers, strict=True)]


def _chapter(number: int, described: DescribedSession, groups: Sequence[Group]) -> Section:
    curves, histogram = yaw_panels(described), histogram_panel(described)
    values = {
        "odd": [f"{line.name}: {line.value}" for group in groups for line in group.lines if line.is_odd],
        "description": described.description,
        "history": described.yaw,
        "length": duration_text(described.description.duration_s),
        "bias_dps": bias_at_rest(described.description),
        "error": error_panel(described),
        "yaw": [
            *((Markup("<b>{}</b>").format(panel.name), panel.chart) for panel in curves),
            *([_with_legend(histogram)] if histogram else []),
        ],
        "yaw_marks": list(dict.fromkeys(mark for panel in curves for mark in panel.marks)),
        "recording": [_with_legend(panel) for panel in recording_panels(described)],
        "noise": FLICKER_WORDS if described.description.allan else "",
        "groups": groups,
    }
    return Section("describe/templates/session.html", values | SHARED, f"{number}. {described.session.name}")


def _with_legend(panel: Panel) -> tuple[Markup, Chart]:
    """A chart with its name and its legend, an entry a line."""
    entry = Markup('<br/><span class="{}"><span class="{}"></span> {}</span>')
    legend = Markup().join(entry.format(mark.color, mark.shape, mark.name) for mark in panel.marks)
    return Markup("<strong>{}</strong>{}").format(panel.name, legend), panel.chart
