"""Two gyros on one body: whether they turn together, and which of them drifts."""

from dataclasses import dataclass, replace
from math import hypot, sqrt

import numpy as np

from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.doctor.finding import DeviceFinding, note, ok, warning
from gyrodrift.facts.still import quiet_windows
from gyrodrift.values.arrays import Floats, Mask

WINDOW_S = 1.0
"""Length over which rates are averaged, s: long against the delay of a link."""

WINDOWS_MIN = 5
"""Smallest number of windows for a mean with its scatter."""

SURE = 4.0
"""Change of the difference, in standard errors, that is a drift: 6 in 10^5 by chance."""

STILL_STDS = 2.0
"""Largest scatter of a still window, relative to that of the quietest tenth."""

SHIFT_MAX_DPS = 1.0
"""Largest change of a bias, deg/s; a cheap gyro warms up by less (MPU-6050: 20 deg/s over 125 °C, so 0.16 per °C)."""

APART = 3.0
"""Ratio of two changes above which the larger one is the drift."""

TURN_MIN_DPS = 5.0
TOGETHER, SCALE = 0.9, 0.1
"""Smallest correlation of turns of one body, and largest difference of two scales. Chosen."""


@dataclass(frozen=True, slots=True)
class RateWindows:
    """Mean rates of two gyros, deg/s, over the same windows, and whether both were still; shape (windows,)."""

    first_dps: Floats
    second_dps: Floats
    is_still: Mask


def compare(first: DeviceEvidence, second: DeviceEvidence) -> list[DeviceFinding]:
    """Findings about two gyros on one body; their times are those of the host."""
    windows = rate_windows(first, second)
    if windows is None:
        says = "The two gyros have no time in common, or no times of this host."
        return [replace(note(says, "Listen to both at once, or record both with one service."), id="body_drift")]
    names = first.source, second.source
    turns = _turns(windows, *names)
    return [*([replace(turns, id="body_turns")] if turns else []), replace(_drift(windows, *names), id="body_drift")]


def rate_windows(first: DeviceEvidence, second: DeviceEvidence) -> RateWindows | None:
    """Common windows of two gyros; None with too few."""
    series_of_first, series_of_second = _series(first), _series(second)
    if series_of_first is None or series_of_second is None:
        return None
    series = (series_of_first, series_of_second)
    begin_s = max(float(times_s[0]) for times_s, _ in series)
    count = int((min(float(times_s[-1]) for times_s, _ in series) - begin_s) / WINDOW_S)
    if count < 2 * WINDOWS_MIN:
        return None
    first_dps, first_stds, is_full = _binned(*series_of_first, begin_s, count)
    second_dps, second_stds, is_second_full = _binned(*series_of_second, begin_s, count)
    whole = is_full & is_second_full
    if int(whole.sum()) < 2 * WINDOWS_MIN:
        return None
    gyros = ((first_dps[whole], first_stds[whole]), (second_dps[whole], second_stds[whole]))
    is_still = np.logical_and(*(quiet_windows(*gyro, STILL_STDS, SHIFT_MAX_DPS) for gyro in gyros))
    return RateWindows(first_dps[whole], second_dps[whole], is_still)


def _series(evidence: DeviceEvidence) -> tuple[Floats, Floats] | None:
    """Times on the clock of the host, s, and rates, deg/s."""
    session = None if evidence.facts is None else evidence.facts.session
    if session is None or session.t_host_s is None or not evidence.is_in_deg_s:
        return None
    is_known = np.isfinite(session.rate_dps) & np.isfinite(session.t_device_s) & np.isfinite(session.t_host_s)
    if int(is_known.sum()) < 2:
        return None
    t_device_s = session.t_device_s[is_known]
    delay_s = np.median(session.t_host_s[is_known] - t_device_s)
    return t_device_s + delay_s, session.rate_dps[is_known]


def _binned(times_s: Floats, rates_dps: Floats, begin_s: float, count: int) -> tuple[Floats, Floats, Mask]:
    """Mean and standard deviation of each window, and whether it has at least half of the usual samples."""
    inside = (times_s >= begin_s) & (times_s < begin_s + count * WINDOW_S)
    index = ((times_s[inside] - begin_s) / WINDOW_S).astype(int)
    counts: Floats = np.bincount(index, minlength=count).astype(float)
    divisors = np.maximum(counts, 1.0)
    means: Floats = np.bincount(index, rates_dps[inside], count) / divisors
    squares: Floats = np.bincount(index, (rates_dps[inside] - means[index]) ** 2, count) / divisors
    is_full: Mask = (counts >= 2.0) & (counts >= 0.5 * float(np.median(counts)))
    return means, np.sqrt(squares), is_full


def _turns(windows: RateWindows, first: str, second: str) -> DeviceFinding | None:
    """Whether they turn together; None without turns."""
    is_turning = np.maximum(np.abs(windows.first_dps), np.abs(windows.second_dps)) > TURN_MIN_DPS
    if int(is_turning.sum()) < WINDOWS_MIN:
        return None
    a = windows.first_dps[is_turning] - _bias(windows.first_dps, windows.is_still)
    b = windows.second_dps[is_turning] - _bias(windows.second_dps, windows.is_still)
    together = float(a @ b) / max(sqrt(float(a @ a) * float(b @ b)), 1e-12)
    scale = float(a @ b) / max(float(a @ a), 1e-12)
    if abs(together) < TOGETHER:
        return warning(
            f"{first} and {second} do not turn together: their rates agree to {together:.2f}.",
            "Are both on one body, with their z axes in parallel?",
            together,
        )
    if scale < 0.0:
        return warning(f"{second} turns the other way than {first}.", f"Turn the sign of {second} with :-.", scale)
    if abs(scale - 1.0) > SCALE:
        return warning(f"{second} reads {scale:.3f} of {first}.", "Calibrate both: gyrodrift calibrate.", scale)
    return ok(f"They turn together; {second} reads {scale:.4f} of {first}.", scale)


def _bias(rates_dps: Floats, is_still: Mask) -> float:
    """Rate at rest, deg/s; 0 without a rest."""
    return float(np.median(rates_dps[is_still])) if is_still.any() else 0.0


def _drift(windows: RateWindows, first: str, second: str) -> DeviceFinding:
    """Finding about the gyro that drifts from the first third to the last third of the time, at rest."""
    third = len(windows.first_dps) // 3
    parts = slice(0, third), slice(-third, None)
    rests = [windows.is_still[part] for part in parts]
    if min(int(rest.sum()) for rest in rests) < WINDOWS_MIN:
        return note(
            f"Nothing tells which of {first} and {second} drifts: they did not rest at the beginning and at the end.",
            "Leave the body still for at least 5 s at both ends.",
        )
    rates = (windows.first_dps, windows.second_dps, windows.first_dps - windows.second_dps)
    ends = [[rates_dps[part][rest] for part, rest in zip(parts, rests, strict=True)] for rates_dps in rates]
    changes = [float(end.mean() - begin.mean()) for begin, end in ends]
    return _verdict(changes, hypot(*map(_standard_error, ends[2])), first, second)


def _standard_error(rates_dps: Floats) -> float:
    """Standard error of a mean, deg/s."""
    return float(rates_dps.std(ddof=1)) / sqrt(len(rates_dps))


def _verdict(changes: list[float], error_dps: float, first: str, second: str) -> DeviceFinding:
    """Finding from the changes of the first rate, the second rate and their difference, deg/s."""
    of_first, of_second, of_both = changes
    if abs(of_both) < SURE * error_dps:
        return ok(
            f"Neither drifts against the other: their difference moved by {of_both:+.4f} ± {error_dps:.4f} deg/s.",
            of_both,
            "deg/s",
        )
    moved = f"{first} moved by {of_first:+.4f} deg/s, {second} by {of_second:+.4f}"
    for name, larger, smaller in ((first, of_first, of_second), (second, of_second, of_first)):
        if abs(larger) > APART * abs(smaller):
            do = "Measure its bias against temperature: gyrodrift calibrate --temperature 20, or use the other gyro."
            return warning(f"{name} drifts: at rest {moved}.", do, larger, "deg/s")
    return warning(
        f"Both drift, or the body turned slowly: at rest {moved}.", "Repeat it on a table.", of_both, "deg/s"
    )
