"""The first table of a tuning's report: mean yaw error of every filter, tuned and at its defaults."""

from math import isfinite, log10

from gyrodrift.html.html import headings, section, span, table, text
from gyrodrift.html.numbers import significant
from gyrodrift.tune.result import Alternative, Tuning

BAR_WIDTH = 128.0
"""Width of a bar's drawing, in its own units."""

COLORS = {"euler": "plain", "start": "quiet"}


def alternatives(tuning: Tuning) -> str:
    """The section; empty for a tuning without alternatives."""
    if not tuning.alternatives:
        return ""
    has_test = any(way.pi.test is not None for way in tuning.alternatives)
    splits = ["training", *["held out"] * has_test]
    head = headings(["", *(f"E {split}, deg" for split in splits), *(f"PI {split}, deg²" for split in splits), "E"], 1)
    rows = [_row(tuning, way, has_test=has_test) for way in tuning.alternatives]
    caption = (
        "Mean yaw error of plain integration, of a start calibration (the mean rate of the first 3 s is subtracted), "
        "and of each filter. Bars show E "
        f"{'on held-out sessions' if has_test else 'on the training sessions'} on a logarithmic scale."
    )
    return section("Filters and defaults", table(caption, head, rows, words=1))


def _row(tuning: Tuning, way: Alternative, *, has_test: bool) -> list[str]:
    is_best = way is min(tuning.alternatives, key=lambda every: every.judged_pi)
    marks = [span("best", "best")] * is_best + [span("in the config", "note")] * (way is tuning.written)
    values = [
        means for mean in (way.e_deg, way.pi) for means in ([mean.train, mean.test] if has_test else [mean.train])
    ]
    cells = ["–" if value is None else significant(value, 3) for value in values]
    return [" ".join([text(way.title), *marks]), *cells, _bar(tuning, way)]


def _judged_e_deg(way: Alternative) -> float:
    return way.e_deg.train if way.e_deg.test is None else way.e_deg.test


def _bar(tuning: Tuning, way: Alternative) -> str:
    """A bar from a third of the least error to this error, on a logarithmic scale."""
    errors_deg = [_judged_e_deg(every) for every in tuning.alternatives]
    known_deg = [e_deg for e_deg in errors_deg if e_deg > 0.0 and isfinite(e_deg)] or [1.0]
    low, high = min(known_deg) / 3.0, max(known_deg)
    e_deg = min(max(_judged_e_deg(way), low), high) if isfinite(_judged_e_deg(way)) else high
    width = BAR_WIDTH * log10(e_deg / low) / log10(high / low)
    color = COLORS.get(way.key, way.filter.color if way.filter else "quiet")
    opacity = 1.0 if way.is_tuned or way.filter is None else 0.5
    return (
        f'<svg class="track" viewBox="0 0 {BAR_WIDTH:g} 16" role="img" aria-label="{significant(e_deg, 3)} deg">'
        f'<rect x="0" y="2" width="{width:.1f}" height="12" rx="2" fill="var(--{color})" fill-opacity="{opacity:g}"/>'
        "</svg>"
    )
