"""Measurements of a rig that plays a profile, block by block, so that memory stays bounded.

The motion is known in closed form. The gyro senses it, possibly late, on a grid that is fine enough for effects in
continuous time, and noise is added. Then the rate is sampled, gets gain and bias errors, and is rounded to counts. The
encoder measures the same motion with its own errors. The clock adds time stamps, and the link delivers.

The same rig, profile, seed and session number give the same measurements.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import StrEnum
from math import ceil
from typing import Protocol
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from firmware_sim.effects.catalogue import in_acting_order
from firmware_sim.effects.effect import Act, EffectSlot, Floats, Moments
from firmware_sim.rig import Rig

BLOCK_SAMPLES = 4096
COUNTS_MAX = 32767
FINE_POINTS = 1 << 18

HOST_JITTER = crc32(b"host_jitter_s")
"""Key of the random stream of the host; streams of effects use their names."""


class Motion(Protocol):
    """Motion of the table, and temperature of the sensor: a profile, or a recording that is repeated.

    powered_s
        Time since power-on at the beginning, s.
    """

    @property
    def powered_s(self) -> float:
        """Time since power-on at t = 0, s."""
        ...

    def motion_at(self, t_s: Floats) -> tuple[Floats, Floats]:
        """True angle, degrees, and rate, deg/s, at times since the beginning, in their shape."""
        ...

    def sensor_c_at(self, t_s: Floats) -> Floats:
        """Temperature of the sensor at times since the beginning, °C, in their shape."""
        ...


HALF_A_COUNT = 0.5 + 1e-6
"""Rounding offset, so that exact half counts do not depend on the last bit of a float."""


@dataclass(frozen=True, slots=True)
class Block:
    """Measurements in order; every array has the shape (n,).

    seq
        Counter from 0, not wrapped; lost samples leave gaps.
    t_device_us
        Device clock from 0, µs, not wrapped.
    t_host_s
        Arrival at the host, s after power-on, on the host clock.
    rate_raw, is_clipped
        Rate in counts, and whether it exceeded the range.
    temp_centi_c
        Temperature, hundredths of °C.
    encoder_counts
        Encoder counts, from the phase of the rig; zeros without an encoder.
    still
        Rest as the device reports it: 1 at rest, 0 in motion, −1 not reported.
    """

    seq: NDArray[np.int64]
    t_device_us: NDArray[np.int64]
    t_host_s: Floats
    rate_raw: NDArray[np.int16]
    is_clipped: NDArray[np.bool_]
    temp_centi_c: NDArray[np.int16]
    encoder_counts: NDArray[np.int64]
    still: NDArray[np.int8]

    def rows(self) -> Iterator[tuple[int, int, float, int, bool, int, int, int]]:
        """Measurements as plain numbers, in the order of the arrays."""
        return zip(
            self.seq.tolist(),
            self.t_device_us.tolist(),
            self.t_host_s.tolist(),
            self.rate_raw.tolist(),
            self.is_clipped.tolist(),
            self.temp_centi_c.tolist(),
            self.encoder_counts.tolist(),
            self.still.tolist(),
            strict=True,
        )

    def only(self, kept: NDArray[np.bool_]) -> "Block":
        """Measurements for which `kept` is true."""
        return Block(
            self.seq[kept],
            self.t_device_us[kept],
            self.t_host_s[kept],
            self.rate_raw[kept],
            self.is_clipped[kept],
            self.temp_centi_c[kept],
            self.encoder_counts[kept],
            self.still[kept],
        )


class StillWord(StrEnum):
    """Rest that a device reports: nothing, the truth, or a constant."""

    NONE = "none"
    TRUE = "true"
    ALWAYS = "1"
    NEVER = "0"


def measure(
    rig: Rig,
    motion: Motion,
    seed: int,
    session: int = 0,
    block_samples: int = BLOCK_SAMPLES,
    still: StillWord = StillWord.NONE,
) -> Iterator[Block]:
    """Endless measurements of a rig that plays a motion; `session` is the number of the run with this seed."""
    bench = _Bench(rig, motion, seed, session, still)
    first = 0
    while True:
        yield bench.block(first, block_samples)
        first += block_samples


class _Bench:
    """Acts of the effects of a session, by slot, with their state."""

    def __init__(self, rig: Rig, motion: Motion, seed: int, session: int, still: StillWord) -> None:
        self._base, self._motion, self._still_word = rig.base, motion, still
        self._rate_hz = rig.base.sample_rate_hz
        self._acts: dict[EffectSlot, list[Act]] = {slot: [] for slot in EffectSlot}
        twins: dict[str, int] = {}
        for effect in in_acting_order(rig.effects):
            twins[effect.name] = twins.get(effect.name, 0) + 1
            stream = _random_stream(seed, session, crc32(effect.name.encode()), twins[effect.name])
            self._acts[effect.slot].append(effect.begin(stream, self._rate_hz))
        has_low_pass = bool(self._acts[EffectSlot.LOW_PASS])
        finest_s = min(effect.finest_step_s() for effect in rig.effects) if has_low_pass else float("inf")
        self._fine = max(1, ceil(1.0 / self._rate_hz / finest_s))
        sigma = rig.base.noise_dps_rthz * np.sqrt(self._rate_hz * self._fine)
        self._jitter = _random_stream(seed, session, HOST_JITTER)
        self._last_arrival_s = -np.inf
        noise = _random_stream(seed, session)
        self._acts[EffectSlot.ANALOG].append(lambda rate, _: rate + sigma * noise.standard_normal(rate.shape))

    def _moments(self, t_s: Floats, step_s: float) -> Moments:
        angle_deg, rate_dps = self._motion.motion_at(t_s)
        angle_deg = angle_deg + self._base.encoder_phase_deg
        powered_s = np.maximum(t_s, 0.0) + self._motion.powered_s
        return Moments(t_s, powered_s, angle_deg, rate_dps, self._motion.sensor_c_at(t_s), step_s)

    def _at_host(self, t_s: Floats) -> Floats:
        """Arrival at the host over an ideal link, s."""
        arrival_s = t_s + self._base.host_delay_s
        if not self._base.host_jitter_s:
            return arrival_s
        late_s = self._base.host_jitter_s * self._jitter.standard_exponential(len(t_s))
        ordered_s: Floats = np.maximum.accumulate(np.maximum(arrival_s + late_s, self._last_arrival_s))
        self._last_arrival_s = float(ordered_s[-1])
        return ordered_s

    def _through(self, slot: EffectSlot, values: Floats, moments: Moments) -> Floats:
        for act in self._acts[slot]:
            values = act(values, moments)
        return values

    def block(self, first: int, count: int) -> Block:
        """Measurements `first` to `first + count`."""
        seq = np.arange(first, first + count)
        truth = self._moments(seq / self._rate_hz, 1.0 / self._rate_hz)
        rate_dps = self._rate(first, count, truth)
        counts = np.rint(rate_dps / self._base.dps_per_lsb)
        angle_deg = self._through(EffectSlot.COUNTS, self._through(EffectSlot.ENCODER, truth.angle_deg, truth), truth)
        stamp_s = self._through(EffectSlot.CLOCK, truth.t_s, truth)
        arrival_s = self._through(EffectSlot.ARRIVAL, self._at_host(truth.t_s), truth)
        arrived = ~np.isnan(arrival_s)
        block = Block(
            seq=seq,
            t_device_us=np.rint(stamp_s * 1e6).astype(np.int64),
            t_host_s=arrival_s,
            rate_raw=np.clip(counts, -COUNTS_MAX, COUNTS_MAX).astype(np.int16),
            is_clipped=np.abs(counts) > COUNTS_MAX,
            temp_centi_c=np.rint(truth.temp_c * 100.0).astype(np.int16),
            encoder_counts=np.floor(angle_deg / 360.0 * self._base.encoder_cpr + HALF_A_COUNT).astype(np.int64),
            still=self._still(truth.rate_dps),
        )
        return block if arrived.all() else block.only(arrived)

    def _still(self, rate_dps: Floats) -> NDArray[np.int8]:
        """Reported rest for a true rate."""
        match self._still_word:
            case StillWord.TRUE:
                return np.where(rate_dps == 0.0, 1, 0).astype(np.int8)
            case StillWord.NONE:
                return np.full(len(rate_dps), -1, np.int8)
            case constant:
                return np.full(len(rate_dps), int(constant.value), np.int8)

    def _sensed(self, fine: Moments) -> tuple[Floats, Floats]:
        """Rate with all effects in continuous time, and the sensed motion, at the samples of the fine grid."""
        seen_s = self._through(EffectSlot.LAG, fine.t_s, fine)
        motion_dps = fine.rate_dps if seen_s is fine.t_s else self._motion.motion_at(seen_s)[1]
        moments = replace(fine, rate_dps=motion_dps)
        rate_dps = self._through(EffectSlot.LOW_PASS, self._through(EffectSlot.ANALOG, motion_dps, moments), moments)
        return rate_dps[self._fine - 1 :: self._fine], motion_dps[self._fine - 1 :: self._fine]

    def _fine_moments(self, first: int, count: int) -> Iterator[Moments]:
        """True values on the fine grid, in pieces, so that memory stays bounded."""
        fine_rate_hz = self._rate_hz * self._fine
        piece = max(1, FINE_POINTS // self._fine)
        for start in range(first, first + count, piece):
            end = min(start + piece, first + count)
            points = np.arange((start - 1) * self._fine + 1, (end - 1) * self._fine + 1)
            yield self._moments(points / fine_rate_hz, 1.0 / fine_rate_hz)

    def _rate(self, first: int, count: int, truth: Moments) -> Floats:
        """Rate that the device reads, deg/s."""
        pieces = [truth] if self._fine == 1 else self._fine_moments(first, count)
        parts = [self._sensed(fine) for fine in pieces]
        rate_dps, motion_dps = (np.concatenate(column) for column in zip(*parts, strict=True))
        # Effects of the rate use the sensed rate, not the true one.
        sensed = replace(truth, rate_dps=motion_dps)
        rate_dps = self._through(EffectSlot.RATE, rate_dps, sensed) + self._base.bias_dps
        return self._through(EffectSlot.HOLD, self._through(EffectSlot.OUTPUT, rate_dps, sensed), sensed)


def _random_stream(seed: int, *branch: int) -> np.random.Generator:
    """Independent random generator for a purpose."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=branch))
