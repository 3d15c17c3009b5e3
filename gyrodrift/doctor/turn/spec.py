"""The columns of a verdict as a SPEC to paste, tried on the very lines that came before it is told."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite

import numpy as np

from gyrodrift.columns.ranges import TEMPERATURES_C
from gyrodrift.columns.spec import CLOCK_US, IGNORED, columns_of
from gyrodrift.doctor.turn.motion import TurnWindow, motion_of
from gyrodrift.doctor.turn.scale import HAND, QUARTER_DEG
from gyrodrift.doctor.turn.series import ColumnKey, Series, TimedLine
from gyrodrift.doctor.turn.verdict import TurnedRate, TurnVerdict
from gyrodrift.link.text.decoder import TextDecoder

PACE_WITHIN = 0.1
"""How near a clock is to the time at which its lines come; its units are a factor of a thousand apart."""

GOES_ON, CHANGES = 0.98, 0.5
"""Share of steps in which a clock does not go back, and in which it goes on: one of seconds is too coarse."""

OFTEN = 0.9
"""Of the values of the column that turned: a column that comes more rarely is left out."""


@dataclass(frozen=True, slots=True)
class ReadBack:
    """What the lines say when they are read by a SPEC: how far they turned, and by how many samples."""

    turned_deg: float
    samples: int

    @property
    def is_quarter(self) -> bool:
        """Whether it is a quarter turn to the left, as far as a hand turns one."""
        return 1.0 / (1.0 + HAND) ** 2 < self.turned_deg / QUARTER_DEG < (1.0 + HAND) ** 2


@np.errstate(all="ignore")  # a text may hold numbers of any size
def spec_of(verdict: TurnVerdict, series: Sequence[Series]) -> str:
    """For `--columns`; empty where a SPEC cannot name the column that turned, or nothing turned."""
    turned = verdict.turned
    if turned is None or turned.motion.series.key.repeat:
        return ""
    key = turned.motion.series.key
    sign = "" if turned.turned_deg > 0.0 else ":-"
    unit = turned.scale.option if isinstance(turned, TurnedRate) else turned.unit
    entries = {key: f"{'rate' if isinstance(turned, TurnedRate) else 'yaw'}:{unit}{sign}"}
    least = OFTEN * len(turned.motion.series.values)  # a sample waits for the rarest of its columns
    beside = [each for each in series if _is_beside(each.key, key) and len(each.values) >= least]
    clocks = [(unit, each) for each in beside if (unit := clock_of(each))]
    if clocks:
        order = list(CLOCK_US)
        unit, clock = min(clocks, key=lambda found: (found[1].kind != "clock", order.index(found[0])))
        entries[clock.key] = unit
    for each in beside:
        if each.kind == "temp" and np.all((each.values > TEMPERATURES_C[0]) & (each.values < TEMPERATURES_C[1])):
            entries.setdefault(each.key, "temp")
            break
    if key.label:
        ordered = [each.key for each in series if each.key in entries]
        return ", ".join(f"{each.label}={entries[each]}" for each in ordered)
    width = 1 + max(each.place for each in entries)
    return ", ".join(entries.get(ColumnKey(place=place, width=key.width), IGNORED) for place in range(width))


def _is_beside(key: ColumnKey, turned: ColumnKey) -> bool:
    """Whether one SPEC can name both."""
    if turned.label:
        return bool(key.label) and not key.repeat and key != turned
    return not key.label and key.width == turned.width and key != turned


def clock_of(series: Series) -> str:
    """The unit of a column that is a clock, by the time at which its lines came; empty where it is none."""
    steps, passed_s = np.diff(series.values), float(np.ptp(series.t_s)) if len(series.t_s) else 0.0
    if passed_s <= 0.0 or (steps >= 0.0).mean() < GOES_ON or (steps > 0.0).mean() < CHANGES:
        return ""
    pace = float(steps[steps > 0.0].sum()) / passed_s
    units = {unit: pace * us * 1e-6 for unit, us in CLOCK_US.items()}
    return next((unit for unit, seconds in units.items() if abs(seconds - 1.0) < PACE_WITHIN), "")


@np.errstate(all="ignore")  # likewise
def read_back(lines: Sequence[TimedLine], spec: str, window: TurnWindow) -> ReadBack:
    """Read lines as `serve` would and add up the turn."""
    decoder = TextDecoder(columns_of(spec))
    read = [(line.t_s, each) for line in lines for each in decoder.push(f"{line.text}\n".encode())]
    is_rate = [(t_s, each.rate_dps) for t_s, each in read if isfinite(each.rate_dps)]
    is_angle = [(t_s, each.yaw_deg) for t_s, each in read if isfinite(each.yaw_deg)]
    found = is_rate or is_angle
    if not found:
        return ReadBack(0.0, 0)
    t_s, values = (np.array(column) for column in zip(*found, strict=True))
    key = ColumnKey()
    if is_rate:
        return ReadBack(motion_of(Series(key, "", "", None, t_s, values, is_whole=False), window).integral, len(found))
    angles = np.unwrap(values, period=360.0)
    return ReadBack(motion_of(Series(key, "", "", None, t_s, angles, is_whole=False), window).change, len(found))
