"""Unit, sign and axis of the rates of a recording: by an encoder that turns, or else by the size of the rates."""

from collections.abc import Iterator
from math import log, nan

import numpy as np

from gyrodrift.columns.rate_unit import (
    COUNTS,
    DEGREES,
    MILLIDEGREES,
    ODDS_MAX,
    PER_DPS,
    RADIANS,
    SURE_ODDS,
    RateUnit,
    RateUnitOdds,
    compared,
)
from gyrodrift.columns.shape import RateShape
from gyrodrift.columns.sizes import SENSITIVITIES, WINDOW
from gyrodrift.columns.spec import RATE_DPS
from gyrodrift.facts.reference import MOST_READ, EncoderComparison
from gyrodrift.facts.session_facts import SessionFacts
from gyrodrift.session.checks.finding import SessionFinding
from gyrodrift.session.session import TABLE, Session
from gyrodrift.session.tables.wire import FORM
from gyrodrift.values.sample import Sample

WORDS = {
    **{unit: f"is in {unit}, not degrees per second" for unit in PER_DPS},
    RADIANS: "is in radians per second, not degrees",
    DEGREES: "is multiplied by 57.3 as if it had been radians",
    MILLIDEGREES: "is in millidegrees per second, not degrees",
    COUNTS: "is in counts, not degrees per second",
}

TOO_LARGE = DEGREES
"""Unit of rates that are 57.3 times too large."""

NEAR = 1.35
"""A factor this close to a wrong unit counts as this unit; a scale error of a third does not."""

FAR = 2.0
"""No scale error of a gyro is this large, but a wrongly assumed range is."""

NAMED = 1e-6
"""Largest difference of logarithms between a scale and a named unit."""

SAME_SCALE = 1.06
"""Sensitivities in data sheets differ by more than this factor."""

LIKE, UNLIKE = 0.8, 0.5
"""Correlation of rate and encoder: above the first they are of the same axis, below the second they are not."""

UNLIKE_DEG = 180.0
"""An encoder that turns this far makes the axis certain."""

LAG_S = 0.5
"""A larger delay between encoder and rate means that they were joined wrongly, s."""

MOST_WINDOWS = 300
"""Windows to examine, spread over the recording."""

LIKELY_ODDS = 2.5
"""Odds of all other units together that deserve a warning; 96 recordings in deg/s have 2.1 at most (measured)."""


def wrong_unit(factor: float) -> tuple[float, str] | None:
    """Exact factor and unit, a key of WORDS, that explain a wrong factor of the rates; None if none does."""
    matches = ((1.0 / per, unit) for unit, per in PER_DPS.items() if 1.0 / NEAR < factor * per < NEAR)
    return next(matches, None)


def rate_findings(facts: SessionFacts, *, is_stated: bool, is_still: bool = False) -> list[SessionFinding]:
    """Findings about the rates of a session in deg/s, with its calibration applied.

    is_stated
        Whether the user states unit or sign: then no finding is an error.
    is_still
        Whether the device did not move, regardless of its encoder.
    """
    session, comparison = facts.session, None if is_still else facts.reference
    findings = list(_by_size(session)) if comparison is None else list(_by_encoder(session, comparison))
    findings += _by_shape(session)
    return [
        SessionFinding(finding.id, finding.says, finding.do, is_error=finding.is_error and not is_stated)
        for finding in findings
    ]


def _by_encoder(session: Session, comparison: EncoderComparison) -> Iterator[SessionFinding]:
    size, correlation = abs(comparison.factor), comparison.correlation
    angles = f"the encoder turned by {comparison.encoder_deg:.4g} deg in all, the rate by {comparison.rate_deg:.4g} deg"
    if abs(correlation) < LIKE:
        says = f"the rate does not follow the encoder (correlation {correlation:.2f}): {angles}"
        do = "use the rate about the axis of the encoder (--columns), or an encoder with the same times"
        is_sure = abs(correlation) < UNLIKE and comparison.encoder_deg > UNLIKE_DEG
        yield SessionFinding("rate_axis", says, do, is_error=is_sure)
        return
    if comparison.factor < 0.0:
        says = f"the rate has the sign opposite to the encoder's: {angles}"
        yield SessionFinding("rate_sign", says, "use --flip", is_error=True)
    if abs(comparison.lag_s) > LAG_S:
        says = f"encoder and rate are {abs(comparison.lag_s):.2g} s apart"
        yield SessionFinding("rate_axis", says, "join them by one clock")
    wrong = wrong_unit(size)
    if wrong is None and 1.0 / NEAR < size < NEAR:
        return
    is_sure = wrong is not None or not 1.0 / FAR < size < FAR
    statement = (
        WORDS[wrong[1]] if wrong else f"is {max(size, 1.0 / size):.4g} times too {'small' if size > 1.0 else 'large'}"
    )
    factor = wrong[0] if wrong and not _is_counts(session, size) else 1.0 / (_sensitivity(size) or 1.0 / size)
    option = _option(session, factor)
    yield SessionFinding("rate_unit", f"the rate {statement}: {angles}", f"use --rate-unit {option}", is_error=is_sure)


def _is_counts(session: Session, factor: float) -> bool:
    """Whether the rates are integer counts of a known sensitivity, not a unit near it."""
    rates = session.rate_dps[np.isfinite(session.rate_dps)] / session.rate_scale
    return bool(np.all(rates == np.rint(rates))) and _sensitivity(factor) is not None


def _sensitivity(factor: float) -> float | None:
    near = min(SENSITIVITIES, key=lambda per: abs(log(per * factor)))
    return near if abs(log(near * factor)) < log(SAME_SCALE) else None


def _by_size(session: Session) -> Iterator[SessionFinding]:
    """Finding by noise at rest, by turns and by integer values."""
    likely = _likely(session)
    if sum(unit.odds for unit in likely) < LIKELY_ODDS:
        return
    best = likely[0]
    says = f"the rate {WORDS[best.unit]}, at odds of {min(best.odds, ODDS_MAX):.0f} to 1: {best.evidence}"
    says += f"; likely are {compared(likely)}" if len(likely) > 1 else ""
    options = " or ".join(f"--rate-unit {unit.entry}" for unit in likely)
    do = f"use {options}, or --rate-unit {_name(session.rate_scale)} if it is right as it is"
    yield SessionFinding("rate_unit", says, do, is_error=best.odds >= SURE_ODDS)


def _likely(session: Session) -> list[RateUnit]:
    odds, samples = RateUnitOdds(session.rate_scale), len(session.rate_dps)
    starts = np.arange(0, samples - WINDOW + 1, WINDOW)
    if len(starts) > MOST_WINDOWS:
        starts = starts[np.unique(np.linspace(0, len(starts) - 1, MOST_WINDOWS).astype(np.int64))]
    for start in starts.tolist():
        odds.take(_samples(session, start))
    return odds.likely()


def _by_shape(session: Session) -> Iterator[SessionFinding]:
    """Finding about a column that is no rate, in lines that nothing but their shape says to hold a rate."""
    if session.metadata.get(TABLE, {}).get("form") != FORM:
        return
    shape = RateShape()
    shape.take(recorded_samples(session))
    if shape.unreturned:
        do = "name the columns with --columns" + (f", such as '{shape.spec}' if it is the yaw" if shape.spec else "")
        yield SessionFinding("rate_unit", shape.unreturned, do, is_error=True)


def recorded_samples(session: Session) -> list[Sample]:
    """Samples of a session as a link gives them, without their counter and arrival."""
    columns = (session.filled(name).tolist() for name in ("t_device_s", "rate_dps", "encoder_deg", "temp_c"))
    rows = zip(*columns, session.inertials(), strict=True)
    return [
        Sample(-1, t_s, nan, rate_dps, encoder_deg, temp_c, inertial=inertial)
        for t_s, rate_dps, encoder_deg, temp_c, inertial in rows
    ]


def _samples(session: Session, start: int) -> list[Sample]:
    rows = slice(start, start + WINDOW)
    times_s = session.t_device_s[rows].tolist()
    rates_dps = np.where(np.abs(session.rate_dps[rows]) <= MOST_READ, session.rate_dps[rows], nan).tolist()
    return [Sample(-1, t_s, nan, rate_dps) for t_s, rate_dps in zip(times_s, rates_dps, strict=True)]


def _option(session: Session, factor: float) -> str:
    """Value of `--rate-unit` for a file whose rates need another factor."""
    return _name(factor * session.rate_scale)


def _name(scale: float) -> str:
    """Unit of a scale in deg/s, as in a SPEC."""
    named = next((unit for unit, dps in RATE_DPS.items() if abs(log(scale / dps)) < NAMED), None)
    return named or f"lsb/{1.0 / scale:.4g}"
