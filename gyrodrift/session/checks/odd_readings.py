"""Findings about readings that are no measurement, or are at the end of the range, in the words of a stream."""

from collections.abc import Iterator

from gyrodrift.facts.readings import JudgedReadings
from gyrodrift.session.checks.finding import SessionFinding

MOST_NAMED = 3
"""Number of hangs that are named one by one."""


def reading_findings(readings: JudgedReadings) -> Iterator[SessionFinding]:
    """Warnings about the judged readings of a session; none for usual ones."""
    if readings.impossible:
        first = readings.fields_of("impossible_reading")[0]
        says = f"{_samples(readings.impossible)} such as {first['rate_dps']:.4g} deg/s cannot be: {first['hint']}"
        yield SessionFinding("impossible", says)
    if readings.clipped:
        first = readings.fields_of("clipped")[0]
        yield SessionFinding(
            "clipped", f"{_samples(readings.clipped)} read ±{first['limit_dps']:.5g} deg/s", first["hint"]
        )
    hangs = list(zip(readings.fields_of("rate_hangs"), readings.fields_of("rate_moves"), strict=True))
    for hang, end in hangs[:MOST_NAMED]:
        since = f"for {end['seconds']:.3g} s from {end['since_s']:.6g} s on"
        says = f"the rate was exactly {hang['rate_dps'] + 0.0:.5g} deg/s {since}"
        yield SessionFinding("stuck", says, hang["hint"])
    if len(hangs) > MOST_NAMED:
        yield SessionFinding("stuck", f"the rate was constant {len(hangs)} times, for {readings.hung_s:.3g} s in total")


def _samples(count: int) -> str:
    return "1 sample" if count == 1 else f"{count} samples"
