"""Sessions as a page: for each its yaw error, yaw, bias, and how it was recorded."""

from collections.abc import Sequence
from math import isfinite

from gyrodrift.describe.drawing import DescribedSession, Panel
from gyrodrift.describe.figures import full_width_svg, panel_svgs
from gyrodrift.describe.listing import duration_text
from gyrodrift.describe.overview import SessionRow, bias_at_rest, row_of
from gyrodrift.describe.recording_panels import recording_panels
from gyrodrift.describe.text import Group
from gyrodrift.describe.yaw import YawHistory, last_error, mean_absolute
from gyrodrift.describe.yaw_panels import error_panel, histogram_panel, yaw_panels
from gyrodrift.html.html import (
    columns,
    facts,
    figure,
    folded,
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
from gyrodrift.values.constants import SECONDS_PER_HOUR
from gyrodrift.values.noise import (
    FLICKER_WORDS,
    ROOT_SECONDS_PER_ROOT_HOUR,
)

UNKNOWN = "–"

DRAWN = 12
"""Only this many sessions have figures; the table has all of them."""

ERROR_WORDS = "<b>Yaw error.</b> Yaw minus the encoder. The scale is linear within a degree and logarithmic beyond it."
YAW_WORDS = "<b>Yaw and bias.</b> The bias is the drift that the filter subtracts from the rate."
RECORDING_WORDS = (
    "<b>The recording.</b> A change that looks flat is negligible for yaw. Times that never change have no panel."
)
NOISE_WORDS = f"Bias instability is {FLICKER_WORDS}."


class SessionsPage:
    """A page that is filled session by session."""

    def __init__(self) -> None:
        self._rows: list[SessionRow] = []
        self._chapters: list[str] = []

    def add(self, described: DescribedSession, groups: Sequence[Group]) -> None:
        """Add the next session; `groups` is its full text."""
        self._rows.append(row_of(described.session.name, described.description, described.yaw))
        if len(self._rows) <= DRAWN:
            self._chapters.append(_chapter(len(self._rows), described, groups))

    def html(self, made: Provenance) -> str:
        """The file."""
        filter_words = f"Corrected: {text(made.config)}." if made.config else ""
        head = header(
            f"gyrodrift info · {_size_words(self._rows)}",
            f"{made.set_name}: {_headline(self._rows)}",
            paragraph(f"{_reference_words(self._rows)} {filter_words}"),
        )
        overview = ""
        if len(self._rows) > 1:
            overview = section("All sessions", _overview(self._rows), _not_drawn(self._rows))
        parts = [head, overview, *self._chapters, provenance(made)]
        return page(f"{made.set_name}: recorded sessions", [part for part in parts if part])


def _not_drawn(rows: Sequence[SessionRow]) -> str:
    without = len(rows) - DRAWN
    return paragraph(f"The first {DRAWN} have figures below, the other {without} have none.") if without > 0 else ""


def _chapter(number: int, described: DescribedSession, groups: Sequence[Group]) -> str:
    odd = [f"{line.name}: {line.value}" for group in groups for line in group.lines if line.is_odd]
    return section(
        f"{number}. {described.session.name}",
        warnings("Worth a second look", odd),
        tiles([_yaw_tile(described.yaw), _samples_tile(described), _rest_tile(described)]),
        _error_figure(described, f"error-{number}"),
        _yaw_figure(described, f"yaw-{number}"),
        _recording_figure(described, f"recording-{number}"),
        folded("Details", columns([_group(group) for group in groups])),
    )


def _size_words(rows: Sequence[SessionRow]) -> str:
    minutes = sum(row.duration_s for row in rows) / 60.0
    return f"{len(rows)} session{'s' * (len(rows) > 1)}, {significant(minutes, 3)} minutes"


def _headline(rows: Sequence[SessionRow]) -> str:
    errors = [row.errors for row in rows if row.errors is not None]
    if not errors:
        return "recorded without an encoder"
    raw_deg, corrected_deg = (
        mean([error.raw_mean_deg for error in errors]),
        mean([error.corrected_mean_deg for error in errors]),
    )
    return f"mean yaw error {degrees(raw_deg)} raw, {degrees(corrected_deg)} corrected"


def _reference_words(rows: Sequence[SessionRow]) -> str:
    with_encoder = sum(row.errors is not None for row in rows)
    if not with_encoder:
        return "Without an encoder the yaw error is unknown. The page shows raw and corrected yaw."
    part = "" if with_encoder == len(rows) else f" {with_encoder} of {len(rows)} sessions have an encoder."
    return f"The yaw error is the mean absolute difference to the angle of the encoder.{part}"


def _overview(rows: Sequence[SessionRow]) -> str:
    head = [
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
    errors = [row.errors for row in rows]
    cells = (
        _column([row.duration_s / 60.0 for row in rows]),
        _column([row.rate_hz for row in rows]),
        [str(row.missing) for row in rows],
        _column([row.bias_dps for row in rows]),
        _column([row.walk_deg_rts for row in rows], factor=ROOT_SECONDS_PER_ROOT_HOUR),
        _column([row.instability_dps for row in rows], factor=SECONDS_PER_HOUR),
        _column([None if error is None else error.raw_mean_deg for error in errors], "°"),
        _column([None if error is None else error.corrected_mean_deg for error in errors], "°"),
    )
    caption = (
        "Missing: samples. Bias: mean rate at rest, by the encoder. Random walk and bias instability: noise over the "
        f"longest rest of at least 30 s. {NOISE_WORDS} Errors: mean absolute yaw error."
    )
    names = [f"{number}. {text(row.name)}" for number, row in enumerate(rows, 1)]
    return table(caption, headings(head), [list(row_cells) for row_cells in zip(names, *cells, strict=True)])


def _column(values: Sequence[float | None], unit: str = "", factor: float = 1.0) -> list[str]:
    numbers = even([float("nan") if value is None else factor * value for value in values])
    return [UNKNOWN if value is None else f"{number}{unit}" for value, number in zip(values, numbers, strict=True)]


def _yaw_tile(yaw: YawHistory | None) -> str:
    if yaw is None:
        return tile("Yaw", [("fewer than two usable samples", UNKNOWN)])
    corrected = f"corrected by {text(yaw.filter_name)}"
    if yaw.has_reference:
        return tile(
            "Mean absolute yaw error",
            [
                (corrected, degrees(mean_absolute(yaw.corrected_error_deg))),
                ("raw", degrees(mean_absolute(yaw.raw_error_deg))),
                ("corrected, error at the end", _signed(last_error(yaw.corrected_error_deg))),
                ("raw, error at the end", _signed(last_error(yaw.raw_error_deg))),
            ],
        )
    sigma_deg = float(yaw.sigma_deg[-1])
    stated = [("σ that the filter states", degrees(sigma_deg))] * isfinite(sigma_deg)
    ends = [(corrected, _signed(float(yaw.corrected_deg[-1]))), *stated, ("raw", _signed(float(yaw.raw_deg[-1])))]
    return tile("Yaw at the end, without an encoder", ends)


def _signed(angle_deg: float) -> str:
    return degrees(angle_deg).replace("-", "−")


def _samples_tile(described: DescribedSession) -> str:
    description = described.description
    rate = UNKNOWN if description.rate_hz is None else f"{significant(description.rate_hz, 4)} Hz"
    counts = [("samples", f"{description.samples:,}"), ("missing", f"{description.gaps.missing:,}")]
    return tile("Recording", [("length", duration_text(description.duration_s)), ("sample rate", rate), *counts])


def _rest_tile(described: DescribedSession) -> str:
    """Bias and noise at rest, as far as they are known."""
    description = described.description
    bias_dps, allan = bias_at_rest(description), description.allan
    lengths_s = sum(rest.end_s - rest.start_s for rest in description.stretches)
    walk = None if allan is None else allan.angle_random_walk_deg_rts
    instability_dps = None if allan is None else allan.bias_instability_dps
    rows = [("time at rest", f"{significant(lengths_s, 3)} s")]
    if bias_dps is not None:
        rows.insert(0, ("bias", f"{significant(bias_dps, 3)} deg/s".replace("-", "−")))
    if walk is not None:
        rows.append(("angle random walk", f"{significant(ROOT_SECONDS_PER_ROOT_HOUR * walk, 3)} °/√h"))
    if instability_dps is not None:
        rows.append(("bias instability", f"{significant(SECONDS_PER_HOUR * instability_dps, 3)} °/h"))
    return tile(f"At rest, by the {description.still_by.value}", rows)


def _error_figure(described: DescribedSession, name: str) -> str:
    panel = error_panel(described)
    if panel is None:
        return ""
    return figure(f"{ERROR_WORDS}<br/>{switches(panel.marks)}", full_width_svg(panel, name), "full")


def _yaw_figure(described: DescribedSession, name: str) -> str:
    """Yaw and bias under one legend whose entries switch the curves, and the histogram with its own legend."""
    curves = yaw_panels(described)
    if not curves:
        return ""
    histogram = histogram_panel(described)
    marks = list(dict.fromkeys(mark for panel in curves for mark in panel.marks))
    captions = [f"<b>{text(panel.name)}</b>" for panel in curves]
    captions += [_with_legend(histogram)] if histogram else []
    svgs = panel_svgs([*curves, *([histogram] if histogram else [])], name)
    return figure(f"{YAW_WORDS}<br/>{switches(marks)}", panels(captions, svgs))


def _recording_figure(described: DescribedSession, name: str) -> str:
    drawn = list(recording_panels(described))
    if not drawn:
        return ""
    noise = f" {NOISE_WORDS}" * (described.description.allan is not None)
    return figure(
        f"{RECORDING_WORDS}{noise}", panels([_with_legend(panel) for panel in drawn], panel_svgs(drawn, name))
    )


def _with_legend(panel: Panel) -> str:
    return "<br/>".join([f"<strong>{text(panel.name)}</strong>", *(legend([mark[1:]]) for mark in panel.marks)])


def _group(group: Group) -> str:
    rows = [(text(line.name), text(line.value)) for line in group.lines]
    return f"<h3>{text(group.heading.capitalize())}</h3>\n{facts(rows)}"
