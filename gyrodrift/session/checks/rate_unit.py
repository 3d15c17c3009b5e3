"""Unit, sign and axis of a recording's rates: by its encoder where it has one that turns, else by their size."""

from collections.abc import Iterator
from math import log, nan

import numpy as np

from gyrodrift.columns.rate_unit import (
    COUNTS,
    DEGREES,
    MILLIDEGREES,
    MOST_ODDS,
    NOISE_DPS,
    PER_DPS,
    RADIANS,
    SENSITIVITIES,
    SURE_ODDS,
    TURN_DPS,
    WINDOW,
    RateUnit,
    RateUnitOdds,
)
from gyrodrift.columns.spec import RATE_DPS
from gyrodrift.sample import Sample
from gyrodrift.session.checks.finding import SessionFinding
from gyrodrift.session.checks.reference import MOST_READ, BesideEncoder, beside_encoder
from gyrodrift.session.session import Session

WORDS = {
    RADIANS: "is in radians per second, not degrees",
    DEGREES: "is multiplied by 57.3 as if it had been radians",
    MILLIDEGREES: "is in millidegrees per second, not degrees",
    COUNTS: "is in counts, not degrees per second",
}

NEAR = 1.35
"""A factor within this one of a wrong unit is that unit: a scale error of a third is no unit."""

FAR = 2.0
"""No scale of a gyro is wrong by so much; a range that is half of what it is taken for is."""

NAMED = 1e-6
"""A scale is a unit with a name where its logarithm is that one but for rounding."""

SAME_SCALE = 1.06
"""Sensitivities of data sheets are further apart than this."""

LIKE, UNLIKE = 0.8, 0.5
"""Rates and encoder of one axis correlate at least by the first; below the second they are of two."""

UNLIKE_DEG = 180.0
"""An encoder that goes so far tells that for sure."""

LAG_S = 0.5
"""More than this between encoder and rates is a recorder that joined them wrongly."""

MOST_WINDOWS = 300
"""Windows of a recording that are looked at, spread over all of it."""

LIKELY_ODDS = 1.0
"""From here on another unit fits better, which is worth a warning; 95 recordings in deg/s have odds of 0.4 at most."""


def wrong_unit(factor: float) -> tuple[float, str] | None:
    """Of a factor by which rates are too small: the one of the unit that it is, and what that means; None for none."""
    found = ((1.0 / per, WORDS[unit]) for unit, per in PER_DPS.items() if 1.0 / NEAR < factor * per < NEAR)
    return next(found, None)


def rate_findings(session: Session, *, is_stated: bool, is_still: bool = False) -> list[SessionFinding]:
    """What is wrong with the rates of a session in deg/s, its calibration applied.

    is_stated
        Whether a person stated unit or sign: then nothing of it is an error.
    is_still
        Whether the device did not move, whatever its encoder says.
    """
    beside = None if is_still else beside_encoder(session)
    found = list(_by_size(session)) if beside is None else list(_by_encoder(session, beside))
    return [SessionFinding(each.id, each.says, each.do, is_error=each.is_error and not is_stated) for each in found]


def _by_encoder(session: Session, beside: BesideEncoder) -> Iterator[SessionFinding]:
    size, likeness = abs(beside.factor), beside.likeness
    paths = f"the encoder turned by {beside.encoder_deg:.4g} deg in all, the rate by {beside.rate_deg:.4g} deg"
    if abs(likeness) < LIKE:
        says = f"the rate does not follow the encoder (correlation {likeness:.2f}): {paths}"
        do = "take the column of the encoder's axis (--columns), or an encoder of the same times"
        is_sure = abs(likeness) < UNLIKE and beside.encoder_deg > UNLIKE_DEG
        yield SessionFinding("rate_axis", says, do, is_error=is_sure)
        return
    if beside.factor < 0.0:
        says = f"the rate has the sign opposite to the encoder's: {paths}"
        yield SessionFinding("rate_sign", says, "say --flip", is_error=True)
    if abs(beside.lag_s) > LAG_S:
        says = f"encoder and rate are {abs(beside.lag_s):.2g} s apart"
        yield SessionFinding("rate_axis", says, "join them by one clock")
    wrong = wrong_unit(size)
    if wrong is None and 1.0 / NEAR < size < NEAR:
        return
    is_sure = wrong is not None or not 1.0 / FAR < size < FAR
    what = wrong[1] if wrong else f"is {max(size, 1.0 / size):.4g} times too {'small' if size > 1.0 else 'large'}"
    factor = wrong[0] if wrong and not _is_counts(session, size) else 1.0 / (_sensitivity(size) or 1.0 / size)
    option = _option(session, factor)
    yield SessionFinding("rate_unit", f"the rate {what}: {paths}", f"say --rate-unit {option}", is_error=is_sure)


def _is_counts(session: Session, factor: float) -> bool:
    """Whether whole numbers are counts of a known sensitivity rather than a unit that is near it."""
    rates = session.rate_dps[np.isfinite(session.rate_dps)] / session.rate_scale
    return bool(np.all(rates == np.rint(rates))) and _sensitivity(factor) is not None


def _sensitivity(factor: float) -> float | None:
    near = min(SENSITIVITIES, key=lambda per: abs(log(per * factor)))
    return near if abs(log(near * factor)) < log(SAME_SCALE) else None


def _by_size(session: Session) -> Iterator[SessionFinding]:
    """By noise at rest, turns and whole numbers."""
    best = _best(session)
    if best is None or best.odds < LIKELY_ODDS:
        return
    seen = f"at rest it scatters by {best.noise:.2g} deg/s, where usual gyros do by {NOISE_DPS:g}"
    if best.turn:
        seen += f", and turns reach {best.turn:.3g} deg/s, where {TURN_DPS:g} are usual"
    what = WORDS[best.unit]
    says = f"the rate {what}, at odds of {min(best.odds, MOST_ODDS):.0f} to 1: {seen}"
    mended = _option(session, 1.0 / best.per_dps)
    option = f"say --rate-unit {mended}, or --rate-unit {_name(session.rate_scale)} if it is right as it is"
    yield SessionFinding("rate_unit", says, option, is_error=best.odds >= SURE_ODDS)


def _best(session: Session) -> RateUnit | None:
    odds, samples = RateUnitOdds(), len(session.rate_dps)
    starts = np.arange(0, samples - WINDOW + 1, WINDOW)
    if len(starts) > MOST_WINDOWS:
        starts = starts[np.unique(np.linspace(0, len(starts) - 1, MOST_WINDOWS).astype(np.int64))]
    for start in starts.tolist():
        odds.take(_samples(session, start))
    return odds.best()


def _samples(session: Session, start: int) -> list[Sample]:
    rows = slice(start, start + WINDOW)
    times_s = session.t_device_s[rows].tolist()
    rates_dps = np.where(np.abs(session.rate_dps[rows]) <= MOST_READ, session.rate_dps[rows], nan).tolist()
    return [Sample(-1, t_s, nan, rate_dps) for t_s, rate_dps in zip(times_s, rates_dps, strict=True)]


def _option(session: Session, factor: float) -> str:
    """What `--rate-unit` has to say of a file whose rates are to be multiplied once more."""
    return _name(factor * session.rate_scale)


def _name(scale: float) -> str:
    """A unit of so many deg/s, as a SPEC calls it."""
    named = next((unit for unit, dps in RATE_DPS.items() if abs(log(scale / dps)) < NAMED), None)
    return named or f"lsb/{1.0 / scale:.4g}"
