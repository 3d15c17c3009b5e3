"""Sessions as a page: one HTML file that shows of each its yaw, raw and corrected, and how it was recorded."""

from collections.abc import Sequence
from math import isfinite

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.describe.figures import panel_svgs
from gyrodrift.describe.overview import SessionRow, bias_at_rest, row_of
from gyrodrift.describe.panels import Panel, Seen, recording_panels, yaw_panels
from gyrodrift.describe.text import Group
from gyrodrift.describe.yaw import YawHistory, mean_absolute
from gyrodrift.html.html import (
    columns,
    facts,
    figure,
    header,
    headings,
    legend,
    page,
    panels,
    paragraph,
    section,
    switches,
    table,
    text,
    tile,
    tiles,
    warnings,
)
from gyrodrift.html.numbers import degrees, even, mean, significant
from gyrodrift.html.provenance import Provenance, provenance

UNKNOWN = "–"

DRAWN = 12
"""Sessions of which figures are drawn; of more the others stand in the table alone."""

YAW_WORDS = (
    "<b>Yaw, raw and corrected.</b> Errors within a degree are drawn to scale, larger ones by factors of ten. The bias "
    "is what the filter took out of the rate."
)
RECORDING_WORDS = (
    "<b>The recording.</b> No scale is narrower than what matters for yaw, so that what looks flat is negligible."
)


class SessionsPage:
    """A page that is filled session by session."""

    def __init__(self) -> None:
        self._rows: list[SessionRow] = []
        self._chapters: list[str] = []

    def add(self, seen: Seen, groups: Sequence[Group]) -> None:
        """The next session, with what is told of it in words."""
        self._rows.append(row_of(seen.session.name, seen.description, seen.yaw))
        if len(self._rows) <= DRAWN:
            self._chapters.append(_chapter(len(self._rows), seen, groups))

    def html(self, made: Provenance) -> str:
        """The file."""
        filter_words = f"Corrected: {text(made.config)}." if made.config else ""
        head = header(
            f"gyrodrift info · {_counted(self._rows)}",
            f"{made.set_name}: {_headline(self._rows)}",
            paragraph(f"{_reference_words(self._rows)} {filter_words}"),
        )
        overview = section("All sessions", _overview(self._rows), _left_out(self._rows)) if len(self._rows) > 1 else ""
        parts = [head, overview, *self._chapters, provenance(made)]
        return page(f"{made.set_name}: recorded sessions", [part for part in parts if part])


def _left_out(rows: Sequence[SessionRow]) -> str:
    """Where not all sessions are drawn."""
    more = len(rows) - DRAWN
    return paragraph(f"The first {DRAWN} are drawn below, the other {more} are not.") if more > 0 else ""


def _chapter(number: int, seen: Seen, groups: Sequence[Group]) -> str:
    """The chapter of a session."""
    odd = [f"{line.name}: {line.value}" for group in groups for line in group.lines if line.is_odd]
    return section(
        f"{number}. {seen.session.name}",
        warnings("Worth a second look", odd),
        tiles([_yaw_tile(seen.yaw), _samples_tile(seen), _rest_tile(seen)]),
        _figure(YAW_WORDS, yaw_panels(seen), f"yaw-{number}", can_switch=True),
        _figure(RECORDING_WORDS, list(recording_panels(seen)), f"recording-{number}", can_switch=False),
        columns([_group(one) for one in groups]),
    )


def _counted(rows: Sequence[SessionRow]) -> str:
    minutes = sum(one.minutes for one in rows)
    return f"{len(rows)} session{'s' * (len(rows) > 1)}, {significant(minutes, 3)} minutes"


def _headline(rows: Sequence[SessionRow]) -> str:
    raw = [one.raw_error_deg for one in rows if one.raw_error_deg is not None]
    corrected = [one.corrected_error_deg for one in rows if one.corrected_error_deg is not None]
    if not raw:
        return "recorded without an encoder"
    return f"mean yaw error {degrees(mean(raw))} raw, {degrees(mean(corrected))} corrected"


def _reference_words(rows: Sequence[SessionRow]) -> str:
    known = sum(one.raw_error_deg is not None for one in rows)
    if not known:
        return "Without an encoder nothing says what yaw should be: raw and corrected yaw are shown beside each other."
    of_all = "" if known == len(rows) else f" It is known of {known} of {len(rows)} sessions: those with an encoder."
    return f"The yaw error is the mean absolute difference to the angle of the encoder.{of_all}"


def _overview(rows: Sequence[SessionRow]) -> str:
    head = ["session", "min", "Hz", "missing", "bias, deg/s", "random walk, deg/√s", "raw error", "corrected error"]
    columns = (
        _column([one.minutes for one in rows]),
        _column([one.rate_hz for one in rows]),
        [str(one.missing) for one in rows],
        _column([one.bias_dps for one in rows]),
        _column([one.walk_deg_rts for one in rows]),
        _column([one.raw_error_deg for one in rows], "°"),
        _column([one.corrected_error_deg for one in rows], "°"),
    )
    caption = (
        "Missing: samples. Bias: mean rate at rest, by the encoder. Random walk: of the angle, by white noise, over "
        "the longest still stretch of at least 30 s. Errors: mean absolute yaw error."
    )
    named = [f"{number}. {text(one.name)}" for number, one in enumerate(rows, 1)]
    return table(caption, headings(head), [list(cells) for cells in zip(named, *columns, strict=True)])


def _column(values: Sequence[float | None], unit: str = "") -> list[str]:
    known = even([float("nan") if value is None else value for value in values])
    return [UNKNOWN if value is None else f"{told}{unit}" for value, told in zip(values, known, strict=True)]


def _yaw_tile(yaw: YawHistory | None) -> str:
    if yaw is None:
        return tile("Yaw", [("not one usable pair of samples", UNKNOWN)])
    corrected = f"corrected by {text(yaw.filter_name)}"
    if yaw.has_reference:
        return tile(
            "Mean absolute yaw error",
            [
                (corrected, degrees(mean_absolute(yaw.corrected_error_deg))),
                ("raw", degrees(mean_absolute(yaw.raw_error_deg))),
                ("corrected, error at the end", _signed(_last(yaw.corrected_error_deg))),
                ("raw, error at the end", _signed(_last(yaw.raw_error_deg))),
            ],
        )
    sigma_deg = float(yaw.sigma_deg[-1])
    stated = [("σ that the filter states", degrees(sigma_deg))] * isfinite(sigma_deg)
    ends = [(corrected, _signed(float(yaw.corrected_deg[-1]))), *stated, ("raw", _signed(float(yaw.raw_deg[-1])))]
    return tile("Yaw at the end, without an encoder", ends)


def _last(error_deg: Floats) -> float:
    """The last that is known."""
    return float(error_deg[np.isfinite(error_deg)][-1])


def _signed(angle_deg: float) -> str:
    """With a true minus."""
    return degrees(angle_deg).replace("-", "−")


def _samples_tile(seen: Seen) -> str:
    one = seen.description
    minutes = one.duration_s / 60.0
    length = f"{significant(minutes, 3)} min" if minutes >= 1.0 else f"{significant(one.duration_s, 3)} s"
    rate = UNKNOWN if one.rate_hz is None else f"{significant(one.rate_hz, 4)} Hz"
    counts = [("samples", str(one.samples)), ("missing", str(one.gaps.missing))]
    return tile("Recording", [("length", length), ("sample rate", rate), *counts])


def _rest_tile(seen: Seen) -> str:
    one = seen.description
    bias_dps, allan = bias_at_rest(one), one.allan
    lengths_s = sum(stretch.end_s - stretch.start_s for stretch in one.stretches)
    walk = None if allan is None else allan.angle_random_walk_deg_rts
    floor_dps = None if allan is None else allan.bias_instability_dps
    rows = [
        ("bias", UNKNOWN if bias_dps is None else f"{significant(bias_dps, 3)} deg/s".replace("-", "−")),
        ("angle random walk", UNKNOWN if walk is None else f"{significant(walk, 3)} deg/√s"),
        ("bias instability", UNKNOWN if floor_dps is None else f"{significant(floor_dps, 3)} deg/s"),
        ("time at rest", f"{significant(lengths_s, 3)} s"),
    ]
    return tile(f"At rest, by the {one.still_by.value}", rows)


def _figure(words: str, drawn: Sequence[Panel], name: str, *, can_switch: bool) -> str:
    """Panels under one legend, whose names switch the curves; or each with a legend of its own."""
    if not drawn:
        return ""
    svgs = panel_svgs(drawn, name)
    if can_switch:
        marks = list(dict.fromkeys(mark for panel in drawn for mark in panel.marks))
        return figure(f"{words}<br/>{switches(marks)}", panels([f"<b>{text(one.name)}</b>" for one in drawn], svgs))
    return figure(words, panels([_named(one) for one in drawn], svgs))


def _named(panel: Panel) -> str:
    """A panel's name, and below it what each of its marks is."""
    return "<br/>".join([f"<strong>{text(panel.name)}</strong>", *(legend([mark[1:]]) for mark in panel.marks)])


def _group(group: Group) -> str:
    rows = [(text(line.name), text(line.value)) for line in group.lines]
    return f"<h3>{text(group.heading.capitalize())}</h3>\n{facts(rows)}"
