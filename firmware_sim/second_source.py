"""Second sources beside the gyro: headings, turn rates, wheels, speed and rest, with flaws of their own.

Each source has its own random generator, so adding one does not change the gyro. A measurement arrives late, and its
time is not sent.
"""

from collections.abc import Iterator
from typing import NamedTuple
from zlib import crc32

import numpy as np

from firmware_sim.channels import random_stream
from firmware_sim.measure import Motion
from firmware_sim.rig import SimulatedAid
from firmware_sim.triaxial import is_still
from firmware_sim.wire.encoder import Frame

FLAW_S = 20.0
"""Length of a stretch in which a source is gone, or slips, s. Chosen: a tunnel, a wet bend."""

SLIP = 0.3
"""Share by which a turn reads too much while it slips. Measured on robots: up to 5.5 deg a meter."""

WRONG_DPS = 50.0
"""Largest wrong turn rate, deg/s. Chosen: a wheel that spins."""

LINE_END = b"\r\n"


class AidValue(NamedTuple):
    """A measurement as it arrives.

    t_s
        Arrival, s after power-on.
    value, speed
        Value in the unit of its kind, and the speed with it, NaN if there is none.
    cells
        Labels and numbers of a line.
    """

    t_s: float
    aid: SimulatedAid
    value: float
    speed: float
    cells: tuple[tuple[str, float], ...]


class AidStream:
    """Measurements of one source of a session, in the order of their arrival."""

    def __init__(self, aid: SimulatedAid, motion: Motion, seed: int, session: int) -> None:
        self._aid, self._motion = aid, motion
        self._rng = random_stream(seed, session, crc32(f"aid {aid.name}".encode()))
        self._next = 0
        self._stretch, self._is_gone, self._slips = -1, False, False
        self._stuck: tuple[float, float] | None = None

    def until(self, t_s: float) -> Iterator[AidValue]:
        """Further measurements that have arrived by a time."""
        aid = self._aid
        while (measured_s := self._next * aid.every_s) + aid.late_s <= t_s:
            self._next += 1
            first, second = self._measured(measured_s)
            if not self._is_gone:
                yield self._sent(measured_s + aid.late_s, first, second)

    def _measured(self, t_s: float) -> tuple[float, float]:
        """Two values of a source: of wheels left and right, else the value and the speed."""
        aid = self._aid
        self._begin_stretch(int(t_s // FLAW_S))
        noise, chance, wrong = self._rng.normal(0.0, aid.sigma, 2), self._rng.random(), self._rng.uniform(-1.0, 1.0)
        if self._stuck is not None:
            return self._stuck
        angle_deg, rate_dps, speed_mps = self._truth(t_s)
        rate_dps *= 1.0 + SLIP * self._slips
        is_wrong, half = chance < aid.wrong_share, 0.5 * np.deg2rad(rate_dps) * aid.track_m
        pairs = {
            "heading": (angle_deg + aid.offset_deg + 180.0 * wrong * is_wrong, speed_mps),
            "turn_rate": (WRONG_DPS * wrong if is_wrong else rate_dps, np.nan),
            "wheels": (speed_mps - half, speed_mps + half * (3.0 if is_wrong else 1.0)),
            "speed": (speed_mps + abs(wrong) * is_wrong, np.nan),
            "standing": (float((speed_mps == 0.0) != is_wrong), np.nan),
        }
        first, second = pairs[aid.name]
        values = self._flawed(first + noise[0]), self._flawed(second + noise[1]) if aid.name == "wheels" else second
        if 0.0 < aid.stuck_s <= t_s:
            self._stuck = values
        return values

    def _truth(self, t_s: float) -> tuple[float, float, float]:
        """Angle, deg, rate, deg/s, and speed, m/s: it drives whenever it does not rest."""
        times = np.array([t_s])
        angle_deg, rate_dps = self._motion.motion_at(times)
        stands = bool(is_still(self._motion, times, rate_dps)[0])
        return float(angle_deg[0]), float(rate_dps[0]), 0.0 if stands else self._aid.speed_mps

    def _begin_stretch(self, stretch: int) -> None:
        """Draw for each stretch whether the source is gone or slips in it."""
        while self._stretch < stretch:
            self._stretch += 1
            self._is_gone, self._slips = (self._rng.random(2) < (self._aid.gone_share, self._aid.slip_share)).tolist()

    def _flawed(self, value: float) -> float:
        """Value with wrong scale and sign, rounded, and 0 below the threshold."""
        aid = self._aid
        if aid.name == "standing":
            return value
        value *= aid.sign * (1.0 + 0.01 * aid.scale_percent)
        if abs(value) < aid.threshold:
            return 0.0
        return round(value / aid.resolution) * aid.resolution if aid.resolution else value

    def _sent(self, t_s: float, first: float, second: float) -> AidValue:
        name = self._aid.name
        if name == "wheels":
            cells = ((f"{name}_left", first), (f"{name}_right", second))
            return AidValue(t_s, self._aid, second - first, 0.5 * (first + second), cells)
        value = first % self._aid.period_deg if name == "heading" else first
        return AidValue(t_s, self._aid, value, second, ((name, value),))


def aid_streams(aids: tuple[SimulatedAid, ...], motion: Motion, seed: int, session: int = 0) -> list[AidStream]:
    """Streams of all sources of a session."""
    return [AidStream(aid, motion, seed, session) for aid in aids]


def until(streams: list[AidStream], t_s: float) -> list[AidValue]:
    """Measurements of all sources that have arrived by a time, in order."""
    return sorted((value for stream in streams for value in stream.until(t_s)), key=lambda value: value.t_s)


def lines_between(frames: Iterator[Frame], streams: list[AidStream]) -> Iterator[Frame]:
    """Lines of labeled text with further lines for second sources, before the next line of the gyro."""
    for frame in frames:
        for value in until(streams, frame.t_s):
            text = ",".join(f"{label}:{number:.6g}" for label, number in value.cells)
            yield Frame(value.t_s, text.encode() + LINE_END, 0, LINE_END)
        yield frame
