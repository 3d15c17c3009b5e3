"""Many sessions as text: a line per session, and a summary."""

from collections.abc import Iterator, Sequence
from statistics import median

from gyrodrift.describe.overview import SessionRow
from gyrodrift.report.numbers import degrees, mean, significant
from gyrodrift.values.constants import SECONDS_PER_HOUR, SECONDS_PER_MINUTE
from gyrodrift.values.noise import ROOT_SECONDS_PER_ROOT_HOUR, hourly_rate_text, random_walk_text

NO_VALUE = "–"


def listing(rows: Sequence[SessionRow]) -> Iterator[str]:
    """Lines of the table, with a ! before each session that deserves a second look, and of its summary."""
    cells = [_headings(rows), *[_cells(row, rows) for row in rows]]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    for row_cells, mark in zip(cells, [" ", *["!" if row.odd else " " for row in rows]], strict=True):
        padded = (f"{cell:{width}}" for cell, width in zip(row_cells, widths, strict=True))
        yield f"{mark} {'  '.join(padded)}".rstrip()
    yield ""
    summary = list(_summary(rows))
    width = max(len(name) for name, _ in summary)
    yield from (f"  {name:{width}}  {words}" for name, words in summary)


def _has_errors(rows: Sequence[SessionRow]) -> bool:
    return any(row.errors for row in rows)


def _headings(rows: Sequence[SessionRow]) -> list[str]:
    errors = ["end error raw", "corrected"] if _has_errors(rows) else []
    return ["session", "duration", "rate", "gaps", "rests", "noise °/√h", "°/h", *errors, "second look at"]


def _cells(row: SessionRow, rows: Sequence[SessionRow]) -> list[str]:
    errors = [NO_VALUE, NO_VALUE]
    if row.errors is not None:
        errors = [_signed(row.errors.raw_end_deg), _signed(row.errors.corrected_end_deg)]
    return [
        row.name,
        duration_text(row.duration_s),
        NO_VALUE if row.rate_hz is None else f"{significant(row.rate_hz, 4)} Hz",
        _gaps(row.gaps, row.missing),
        f"{row.rests}: {significant(row.rest_s, 3)} s" if row.rests else "none",
        _walk(row),
        _scaled(row.instability_dps, SECONDS_PER_HOUR),
        *(errors if _has_errors(rows) else []),
        ", ".join(row.odd),
    ]


def duration_text(seconds: float) -> str:
    """A duration in s, min or h, with three digits."""
    if seconds < 2.0 * SECONDS_PER_MINUTE:
        return f"{significant(seconds, 3)} s"
    if seconds < 2.0 * SECONDS_PER_HOUR:
        return f"{significant(seconds / SECONDS_PER_MINUTE, 3)} min"
    return f"{significant(seconds / SECONDS_PER_HOUR, 3)} h"


def _gaps(gaps: int, missing: int) -> str:
    return f"{gaps}: {missing} missing" if gaps or missing else "none"


def _walk(row: SessionRow) -> str:
    """Angle random walk, approximate if only short rests show it."""
    if row.walk_deg_rts is None and row.white_deg_rts is not None:
        return f"≈{_scaled(row.white_deg_rts, ROOT_SECONDS_PER_ROOT_HOUR)}"
    return _scaled(row.walk_deg_rts, ROOT_SECONDS_PER_ROOT_HOUR)


def _scaled(value: float | None, factor: float) -> str:
    return NO_VALUE if value is None else significant(factor * value, 3)


def _signed(angle_deg: float) -> str:
    return f"{'+' if angle_deg > 0.0 else ''}{degrees(angle_deg)}"


def _summary(rows: Sequence[SessionRow]) -> Iterator[tuple[str, str]]:
    """Name and text of each line."""
    samples = sum(row.samples for row in rows)
    yield _count(len(rows), "session"), f"{duration_text(sum(row.duration_s for row in rows))}, {samples:,} samples"
    yield "gaps", _gap_words(rows)
    yield from _noise(rows)
    yield from _end_errors(rows)
    if any(row.odd for row in rows):
        yield "!", "deserves a second look; --verbose shows the full text of each session"


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'s' * (number != 1)}"


def _gap_words(rows: Sequence[SessionRow]) -> str:
    with_gaps = [row for row in rows if row.gaps or row.missing]
    if not with_gaps:
        return "none"
    missing = _count(sum(row.missing for row in rows), "sample")
    return f"{sum(row.gaps for row in rows)} in {_count(len(with_gaps), 'session')}, {missing} missing"


def _noise(rows: Sequence[SessionRow]) -> Iterator[tuple[str, str]]:
    walks = [row.walk_deg_rts for row in rows if row.walk_deg_rts is not None]
    instabilities_dps = [row.instability_dps for row in rows if row.instability_dps is not None]
    if walks:
        yield "angle random walk", f"{random_walk_text(median(walks))}, {_median_words(len(walks), len(rows))}"
    if instabilities_dps:
        words = _median_words(len(instabilities_dps), len(rows))
        yield "bias instability", f"{hourly_rate_text(median(instabilities_dps))}, {words}"
    if any(row.walk_deg_rts is None and row.white_deg_rts is not None for row in rows):
        yield "≈", "scatter at rest, taken for white noise: no rest of 30 s shows more"


def _median_words(count: int, total: int) -> str:
    """Number of sessions behind a median."""
    return f"median of {_count(count, 'session')}{' that show it' * (1 < count < total)}"


def _end_errors(rows: Sequence[SessionRow]) -> Iterator[tuple[str, str]]:
    errors = [row.errors for row in rows if row.errors is not None]
    if not errors:
        yield "end error", "unknown: no session has an encoder"
        return
    raw_deg = mean([abs(error.raw_end_deg) for error in errors])
    corrected_deg = mean([abs(error.corrected_end_deg) for error in errors])
    words = f"raw {degrees(raw_deg)}, {errors[0].filter_name} {degrees(corrected_deg)}"
    yield "end error", f"{words}: mean absolute value of {_count(len(errors), 'session')} with an encoder"
