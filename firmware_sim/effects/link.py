"""Effects of clock and link on time stamps and delivery; measured values stay correct."""

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from firmware_sim.effects.effect import Act, Effect, EffectSlot, Floats, Moments, Rng

SHORTEST_STEP_S = 1e-6
"""Smallest step of a device clock, which counts microseconds, s."""


class ClockDrift(Effect):
    """The device clock runs fast (positive) against the host clock. Typical: crystal 20 to 100 ppm, gyro PLL 1 %."""

    name: Literal["clock_drift"] = "clock_drift"
    ppm: Annotated[float, Field(ge=-100000.0, le=100000.0)]
    stage: ClassVar[str] = "clock"
    slot: ClassVar[EffectSlot] = EffectSlot.CLOCK
    typical: ClassVar[dict[str, float]] = {"ppm": 5000.0}
    small: ClassVar[dict[str, float]] = {"ppm": 300.0}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Stretched time."""
        return lambda stamp_s, _: stamp_s * (1.0 + self.ppm * 1e-6)


class TimestampJitter(Effect):
    """Time stamps scatter (normal) about the time of measurement. Typical: 0.1 to 5 ms (stamped by a busy loop)."""

    name: Literal["timestamp_jitter"] = "timestamp_jitter"
    sigma_ms: Annotated[float, Field(ge=0.0, le=1000.0)]
    stage: ClassVar[str] = "clock"
    slot: ClassVar[EffectSlot] = EffectSlot.CLOCK
    typical: ClassVar[dict[str, float]] = {"sigma_ms": 1.0}
    small: ClassVar[dict[str, float]] = {"sigma_ms": 0.2}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Scattered times in order: every stamp is at least 1 µs after the one before."""
        last_s = [-np.inf]

        def act(stamp_s: Floats, _: Moments) -> Floats:
            scattered = np.maximum(stamp_s + self.sigma_ms * 1e-3 * rng.standard_normal(len(stamp_s)), 0.0)
            ladder = SHORTEST_STEP_S * np.arange(len(stamp_s))
            reached = np.maximum.accumulate(np.maximum(scattered - ladder, last_s[0] + SHORTEST_STEP_S))
            ordered: Floats = reached + ladder
            last_s[0] = float(ordered[-1])
            return ordered

        return act


EVEN_TICKS = {"spread_percent": 0.0, "handover_ms": 0.0}
"""Parameters of a poll by a timer that hands a bunch over at once."""

TICKS = 1024
"""Intervals that are drawn together, for speed: blocks of any length get the same ticks."""

LEAST_SPREAD = 1e-6
"""Ticks that scatter less are even: a microsecond on an interval of a second."""


class UsbBatching(Effect):
    """Samples wait for the next tick of an interval and arrive in a bunch. Typical: 1 to 16 ms, 64 on slow hosts.

    spread_percent
        Standard deviation of the intervals, as a share of their mean. Intervals have a gamma distribution: at 0 a timer
        polls; at 100 ticks are independent (a Poisson process), as on a host that reads when it is idle.
    handover_ms
        Time in which a sample is handed over, by a serial line that empties a buffer or by a program that handles each
        sample. Samples of a bunch arrive this far apart, after the bunch before.
    """

    name: Literal["usb_batching"] = "usb_batching"
    interval_ms: Annotated[float, Field(ge=0.01, le=5000.0)]
    spread_percent: Annotated[float, Field(ge=0.0, le=100.0)] = 0.0
    handover_ms: Annotated[float, Field(ge=0.0, le=1000.0)] = 0.0
    stage: ClassVar[str] = "link"
    slot: ClassVar[EffectSlot] = EffectSlot.ARRIVAL
    typical: ClassVar[dict[str, float]] = {"interval_ms": 64.0, **EVEN_TICKS}
    small: ClassVar[dict[str, float]] = {"interval_ms": 16.0, **EVEN_TICKS}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Next tick, and then one after the other."""
        wait = self._next_tick(rng)
        if not self.handover_ms:
            return wait
        hand_over = _one_after_the_other(self.handover_ms * 1e-3)
        return lambda arrival_s, moments: hand_over(wait(arrival_s, moments), moments)

    def _next_tick(self, rng: Rng) -> Act:
        interval_s = self.interval_ms * 1e-3
        if self.spread_percent > 100.0 * LEAST_SPREAD:
            return _scattered_ticks(rng, interval_s, self.spread_percent / 100.0)
        return lambda arrival_s, _: np.ceil(arrival_s / interval_s) * interval_s


def _scattered_ticks(rng: Rng, interval_s: float, spread: float) -> Act:
    """Wait for the next tick of a renewal process; `spread` is the coefficient of variation of its intervals."""
    shape, scale_s = spread**-2.0, interval_s * spread**2.0
    ticks_s = np.zeros(1)

    def act(arrival_s: Floats, _: Moments) -> Floats:
        nonlocal ticks_s
        pieces = [ticks_s]
        while pieces[-1][-1] < arrival_s[-1]:
            pieces.append(pieces[-1][-1] + np.cumsum(rng.gamma(shape, scale_s, TICKS)))
        ticks_s = np.concatenate(pieces)
        waited: Floats = ticks_s[np.searchsorted(ticks_s, arrival_s)]
        ticks_s = ticks_s[np.searchsorted(ticks_s, arrival_s[-1]) :]
        return waited

    return act


def _one_after_the_other(handover_s: float) -> Act:
    """A queue: a sample arrives a handover after the sample before, or as soon as it can."""
    last_s = -np.inf

    def act(arrival_s: Floats, _: Moments) -> Floats:
        nonlocal last_s
        queued_s = []
        for wanted_s in arrival_s.tolist():
            last_s = max(wanted_s, last_s + handover_s)
            queued_s.append(last_s)
        return np.array(queued_s)

    return act


class SampleDrop(Effect):
    """Samples that never arrive; the counter shows it. Typical: 0.01 to 2 %."""

    name: Literal["sample_drop"] = "sample_drop"
    share_percent: Annotated[float, Field(ge=0.0, le=90.0)]
    stage: ClassVar[str] = "link"
    slot: ClassVar[EffectSlot] = EffectSlot.ARRIVAL
    typical: ClassVar[dict[str, float]] = {"share_percent": 1.0}
    small: ClassVar[dict[str, float]] = {"share_percent": 0.1}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Independent from sample to sample."""

        def act(arrival_s: Floats, _: Moments) -> Floats:
            return np.where(rng.random(len(arrival_s)) < self.share_percent / 100.0, np.nan, arrival_s)

        return act
