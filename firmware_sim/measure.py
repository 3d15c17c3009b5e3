"""The whole bench: profile → gyro and encoder → measurements, block by block, so that memory stays bounded.

A measurement comes about as in a real rig. The motion is known in closed form. The gyro sees it (late, perhaps), on
a grid fine enough for what acts in continuous time; noise joins it there; then it is sampled, bent, biased, and
rounded to counts. The encoder sees the same motion with errors of its own. The clock stamps, the link delivers.

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
from firmware_sim.effects.effect import Act, Floats, Moments, Place
from firmware_sim.rig import Rig

BLOCK_SAMPLES = 4096
COUNTS_MOST = 32767
FINE_POINTS = 1 << 18

HOST_JITTER = crc32(b"host_jitter_s")
"""Tells the random stream of the host from those of effects, which go by their names."""


class Motion(Protocol):
    """What the table does and how warm the sensor gets: a profile, or a recording that is driven through again.

    powered_s
        How long the device has been on when it begins, s.
    """

    @property
    def powered_s(self) -> float:
        """Time since power-on at t = 0, s."""
        ...

    def at(self, t_s: Floats) -> tuple[Floats, Floats]:
        """True angle in degrees and rate in deg/s at times since the beginning, of their shape."""
        ...

    def sensor_c_at(self, t_s: Floats) -> Floats:
        """Temperature of the sensor at times since the beginning, °C, of their shape."""
        ...


HALF_A_COUNT = 0.5 + 1e-6
"""A table that stands or turns in exact half counts is read one way, and not as the last bit of a float falls."""


@dataclass(frozen=True, slots=True)
class Block:
    """Measurements in the order they were taken; every array has the shape (n,).

    seq
        Counter from 0, not wrapped; samples that the link lost leave holes.
    t_device_us
        Device clock from 0, µs, not wrapped.
    t_host_s
        When the host has the sample, s after power-on by the host's clock.
    rate_raw, is_clipped
        Rate in counts, and whether it left the range.
    temp_centi_c
        Temperature, hundredths of °C.
    encoder_counts
        Encoder from the rig's phase; zeros where the rig has none.
    still
        What the device says of its rest beside the rate: 1 stands still, 0 moves, −1 says nothing.
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
        """One measurement after the other, as plain numbers in the order of the arrays."""
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
        """The measurements where `kept` is true."""
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
    """What a device says beside the rate of whether it stands still: nothing, what is so, or always the same."""

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
    """Measurements of a rig that plays a profile, without end; `session` numbers the runs of one seed."""
    bench = _Bench(rig, motion, seed, session, still)
    first = 0
    while True:
        yield bench.block(first, block_samples)
        first += block_samples


class _Bench:
    """The acts of one session's effects, by place, and what they need from block to block."""

    def __init__(self, rig: Rig, motion: Motion, seed: int, session: int, still: StillWord) -> None:
        self._base, self._motion, self._still_word = rig.base, motion, still
        self._rate_hz = rig.base.sample_rate_hz
        self._acts: dict[Place, list[Act]] = {place: [] for place in Place}
        twins: dict[str, int] = {}
        for effect in in_acting_order(rig.effects):
            twins[effect.name] = twins.get(effect.name, 0) + 1
            stream = _random_stream(seed, session, crc32(effect.name.encode()), twins[effect.name])
            self._acts[effect.place].append(effect.begin(stream, self._rate_hz))
        has_low_pass = bool(self._acts[Place.LOW_PASS])
        finest_s = min(effect.finest_step_s() for effect in rig.effects) if has_low_pass else float("inf")
        self._fine = max(1, ceil(1.0 / self._rate_hz / finest_s))
        sigma = rig.base.noise_dps_rthz * np.sqrt(self._rate_hz * self._fine)
        self._jitter = _random_stream(seed, session, HOST_JITTER)
        self._last_arrival_s = -np.inf
        noise = _random_stream(seed, session)
        self._acts[Place.ANALOGUE].append(lambda rate, _: rate + sigma * noise.standard_normal(rate.shape))

    def _moments(self, t_s: Floats, step_s: float) -> Moments:
        angle_deg, rate_dps = self._motion.at(t_s)
        angle_deg = angle_deg + self._base.encoder_phase_deg
        powered_s = np.maximum(t_s, 0.0) + self._motion.powered_s
        return Moments(t_s, powered_s, angle_deg, rate_dps, self._motion.sensor_c_at(t_s), step_s)

    def _at_host(self, t_s: Floats) -> Floats:
        """When the host would have each sample if the link were ideal, s."""
        arrival_s = t_s + self._base.host_delay_s
        if not self._base.host_jitter_s:
            return arrival_s
        late_s = self._base.host_jitter_s * self._jitter.standard_exponential(len(t_s))
        ordered_s: Floats = np.maximum.accumulate(np.maximum(arrival_s + late_s, self._last_arrival_s))
        self._last_arrival_s = float(ordered_s[-1])
        return ordered_s

    def _through(self, place: Place, values: Floats, moments: Moments) -> Floats:
        for act in self._acts[place]:
            values = act(values, moments)
        return values

    def block(self, first: int, count: int) -> Block:
        """Measurements number `first` to `first + count`."""
        seq = np.arange(first, first + count)
        truth = self._moments(seq / self._rate_hz, 1.0 / self._rate_hz)
        rate_dps = self._rate(first, count, truth)
        counts = np.rint(rate_dps / self._base.dps_per_lsb)
        angle_deg = self._through(Place.COUNTS, self._through(Place.ENCODER, truth.angle_deg, truth), truth)
        stamp_s = self._through(Place.CLOCK, truth.t_s, truth)
        arrival_s = self._through(Place.ARRIVAL, self._at_host(truth.t_s), truth)
        arrived = ~np.isnan(arrival_s)
        block = Block(
            seq=seq,
            t_device_us=np.rint(stamp_s * 1e6).astype(np.int64),
            t_host_s=arrival_s,
            rate_raw=np.clip(counts, -COUNTS_MOST, COUNTS_MOST).astype(np.int16),
            is_clipped=np.abs(counts) > COUNTS_MOST,
            temp_centi_c=np.rint(truth.temp_c * 100.0).astype(np.int16),
            encoder_counts=np.floor(angle_deg / 360.0 * self._base.encoder_cpr + HALF_A_COUNT).astype(np.int64),
            still=self._still(truth.rate_dps),
        )
        return block if arrived.all() else block.only(arrived)

    def _still(self, rate_dps: Floats) -> NDArray[np.int8]:
        """What it says of its rest, whose true rate is this."""
        match self._still_word:
            case StillWord.TRUE:
                return np.where(rate_dps == 0.0, 1, 0).astype(np.int8)
            case StillWord.NONE:
                return np.full(len(rate_dps), -1, np.int8)
            case said:
                return np.full(len(rate_dps), int(said.value), np.int8)

    def _seen(self, fine: Moments) -> tuple[Floats, Floats]:
        """Rate with all that acts in continuous time, and the motion in it: of the fine grid, each last point."""
        seen_s = self._through(Place.LAG, fine.t_s, fine)
        motion_dps = fine.rate_dps if seen_s is fine.t_s else self._motion.at(seen_s)[1]
        moments = replace(fine, rate_dps=motion_dps)
        rate_dps = self._through(Place.LOW_PASS, self._through(Place.ANALOGUE, motion_dps, moments), moments)
        return rate_dps[self._fine - 1 :: self._fine], motion_dps[self._fine - 1 :: self._fine]

    def _fine_moments(self, first: int, count: int) -> Iterator[Moments]:
        """The truth on the fine grid of some samples, in pieces, so that memory stays bounded."""
        fine_rate_hz = self._rate_hz * self._fine
        piece = max(1, FINE_POINTS // self._fine)
        for start in range(first, first + count, piece):
            end = min(start + piece, first + count)
            points = np.arange((start - 1) * self._fine + 1, (end - 1) * self._fine + 1)
            yield self._moments(points / fine_rate_hz, 1.0 / fine_rate_hz)

    def _rate(self, first: int, count: int, truth: Moments) -> Floats:
        """What the device reads out, deg/s."""
        pieces = [truth] if self._fine == 1 else self._fine_moments(first, count)
        parts = [self._seen(fine) for fine in pieces]
        rate_dps, motion_dps = (np.concatenate(column) for column in zip(*parts, strict=True))
        # What depends on the rate depends on the one that is seen, not on the one that is.
        seen = replace(truth, rate_dps=motion_dps)
        rate_dps = self._through(Place.RATE, rate_dps, seen) + self._base.bias_dps
        return self._through(Place.HOLD, self._through(Place.OUTPUT, rate_dps, seen), seen)


def _random_stream(seed: int, *branch: int) -> np.random.Generator:
    """A generator for one purpose, independent of those for all others."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=branch))
