"""Checks of a recording before it is compared: length, motion, axis, alignment, sign, unit, and level of the table.

A check passes a recording without a finding, or it remarks on it, corrects it, or refuses it.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from gyrodrift.diagnose.recording.delay import SmoothedRates, best_lag, smoothed_rates
from gyrodrift.diagnose.recording.gravity import gravity_of
from gyrodrift.diagnose.recording.outliers import granularity
from gyrodrift.diagnose.recording.recording import Recording, filled
from gyrodrift.session.checks.rate_unit import LIKE, TOO_LARGE, WORDS, wrong_unit
from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import DataError

LEAST_S = 20.0
"""Least length of a recording, s. Chosen: a rest and a few turns fit into it."""

TOGETHER_S = 60.0
"""Least length of all recordings together, s. Chosen: shorter recordings do not identify effects."""

LAG_S = 0.25
"""Largest delay between encoder and gyro that may come from a sensor, s. Chosen: a recorder that joined two files
wrongly makes larger ones."""

STATE_RADIANS = "state encoder:rad in --columns"
FULL_TURN_RAD = 2.0 * np.pi + 0.1
"""Range of angles that are wrapped and in radians. Derived: 2π, and some noise. A table turns by more degrees."""

TABLE_TILT = 0.02
"""Tangent of a tilt of the table that is remarked on, about 1 deg. Chosen: tables that are leveled by hand are within
it."""


class CheckedRecording(NamedTuple):
    """A recording after the checks, or None if it was refused, and the remarks, a sentence per finding."""

    recording: Recording | None
    remarks: tuple[str, ...]


class Smoothed(NamedTuple):
    """A recording with the smoothed rates of its gyro and encoder."""

    recording: Recording
    rates: SmoothedRates


class Finding(NamedTuple):
    """Remark of a check, and the recording for the next check, corrected if necessary; None if it is refused."""

    remark: str
    smoothed: Smoothed | None


Check = Callable[[Smoothed], Finding | None]


def check_recording(recording: Recording) -> CheckedRecording:
    """Run the checks in their order until a check refuses. Later checks get the corrected recording."""
    rate_dps, encoder_deg = filled(recording.rate_dps), filled(recording.encoder_deg)
    rates = smoothed_rates(rate_dps, encoder_deg, granularity(recording.encoder_deg), recording.period_s)
    smoothed, remarks = Smoothed(recording, rates), []
    for check in (*CHECKS, *MOTION_CHECKS) if recording.has_motion else CHECKS:
        finding = check(smoothed)
        if finding is None:
            continue
        remarks.append(f"{recording.name}: {finding.remark}")
        if finding.smoothed is None:
            return CheckedRecording(None, tuple(remarks))
        smoothed = finding.smoothed
    return CheckedRecording(smoothed.recording, tuple(remarks))


def together_s(recordings: Sequence[Recording]) -> float:
    """Length of all recordings together, s.

    Raises
    ------
    DataError
        If it is below TOGETHER_S.
    """
    seconds = sum(recording.seconds for recording in recordings)
    if seconds >= TOGETHER_S:
        return seconds
    needed = f"at least {TOGETHER_S:.0f} s in all are needed, in recordings of {LEAST_S:.0f} s or more"
    count = f"{len(recordings)} recording" if len(recordings) == 1 else f"{len(recordings)} recordings"
    raise DataError(f"there are {seconds:.1f} s in {count}; {needed}: record {TOGETHER_S - seconds:.1f} s more")


def _length(smoothed: Smoothed) -> Finding | None:
    """Refuse a short recording."""
    seconds = smoothed.recording.seconds
    if seconds >= LEAST_S:
        return None
    return Finding(f"is {seconds:.1f} s long; a recording counts from {LEAST_S:.0f} s on", None)


def _motion(smoothed: Smoothed) -> Finding | None:
    """Refuse a recording in which the gyro moves alone; remark on a recording without motion."""
    if smoothed.recording.has_motion:
        return None
    if np.ptp(smoothed.rates.gyro_dps) > 10.0:  # more than drift and noise at rest
        why = "the encoder does not move while the gyro does: is it connected?"
        return Finding(f"{why} If its angle is in radians, {STATE_RADIANS}", None)
    return Finding("nothing moves in it; it shows effects at rest, of the clock and of the link only", smoothed)


def _alignment(smoothed: Smoothed) -> Finding | None:
    """Refuse rates that are not correlated; shift the encoder if the delay is too large for a sensor."""
    recording, rates = smoothed.recording, smoothed.rates
    lag, _, correlation = best_lag(rates, recording.period_s)
    if abs(correlation) < LIKE:
        why = "gyro and encoder do not turn together: is it another axis, or do they come from different times?"
        angles_deg = np.ptp(filled(recording.encoder_deg))
        hint = f"; if the angle is in radians, {STATE_RADIANS}" if angles_deg < FULL_TURN_RAD else ""
        return Finding(f"{why} (correlation {correlation:.2f}){hint}", None)
    lag_s = abs(lag * recording.period_s)
    if lag_s <= LAG_S:
        return None
    shifted = replace(recording, encoder_deg=_shifted(recording.encoder_deg, lag))
    remark = f"gyro and encoder are {lag_s:.2f} s apart; the encoder was shifted to fit"
    return Finding(remark, Smoothed(shifted, rates._replace(encoder_dps=_shifted(rates.encoder_dps, lag))))


def _sign(smoothed: Smoothed) -> Finding | None:
    """Negate the rate if it has the sign opposite to the encoder's."""
    if not smoothed.rates.gain < 0.0:
        return None
    negated = replace(smoothed.recording, rate_dps=-smoothed.recording.rate_dps)
    remark = "the rate has the sign opposite to the encoder's; it was negated"
    return Finding(remark, Smoothed(negated, smoothed.rates.with_gyro_times(-1.0)))


def _unit(smoothed: Smoothed) -> Finding | None:
    """Convert the rates if their gain is the factor between two units; refuse if the angle may have the wrong one."""
    gain = smoothed.rates.gain
    wrong = wrong_unit(1.0 / gain) if gain else None
    if wrong is None:
        return None
    factor, unit = wrong
    if unit == TOO_LARGE:
        question = f"the gyro turns 57.3 times as far as the reference: if the angle is in radians, {STATE_RADIANS}"
        return Finding(f"{question}; if the rate was in deg/s already, state --rate-unit dps", None)
    across_dps = smoothed.recording.gyro_xy_dps
    scaled = replace(
        smoothed.recording,
        rate_dps=smoothed.recording.rate_dps * factor,
        gyro_xy_dps=None if across_dps is None else across_dps * factor,
    )
    remark = f"the rate {WORDS[unit]}; it was multiplied by {factor:.4g}"
    return Finding(remark, Smoothed(scaled, smoothed.rates.with_gyro_times(factor)))


def _level(smoothed: Smoothed) -> Finding | None:
    """Remark on a table that is not level."""
    recording, rates = smoothed.recording, smoothed.rates
    gravity = gravity_of(recording, filled(recording.encoder_deg), rates.encoder_dps)
    if gravity is None or not gravity.turning > TABLE_TILT:
        return None
    tilt_deg = np.degrees(np.arctan(gravity.turning))
    remark = f"the table is tilted by {tilt_deg:.1f} deg: gravity moves once per turn in the frame of the sensor"
    return Finding(remark, smoothed)


CHECKS: tuple[Check, ...] = (_length, _motion)
"""Checks of every recording."""

MOTION_CHECKS: tuple[Check, ...] = (_alignment, _sign, _unit, _level)
"""Checks of recordings with motion."""


def _shifted(values: Floats, lag: int) -> Floats:
    """(n,) values, delayed by `lag` samples; the value at the end is repeated."""
    return values[np.clip(np.arange(len(values)) - lag, 0, len(values) - 1)]
