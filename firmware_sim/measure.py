"""Measurements of a rig that plays a profile, block by block, so that memory stays bounded.

The motion is known in closed form. The gyro senses it, possibly late, on a grid that is fine enough for effects in
continuous time, and noise is added. Then the rate is sampled, gets gain and bias errors, and is rounded to counts. The
encoder measures the same motion with its own errors. The clock adds time stamps, and the link delivers. A device with
three axes measures all rates and the acceleration in the same way (`triaxial`).

The same rig, profile, seed and session number give the same measurements.
"""

from collections.abc import Iterator
from dataclasses import fields, replace
from enum import StrEnum
from math import ceil, inf
from typing import Protocol
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from firmware_sim.block import ACCEL_MISSING, COUNTS_MAX, Block, Row, TriaxialBlock, accel_in_counts, in_counts, joined
from firmware_sim.channels import Channel, begin_acts, random_stream, through
from firmware_sim.effects.effect import EffectSlot, Floats, Moments
from firmware_sim.rig import Rig
from firmware_sim.triaxial import YAW_AXIS, SixValues, TriaxialSensor, is_still

__all__ = [
    "ACCEL_MISSING",
    "BLOCK_SAMPLES",
    "COUNTS_MAX",
    "HALF_A_COUNT",
    "Block",
    "Motion",
    "Row",
    "StillWord",
    "TriaxialBlock",
    "joined",
    "measure",
]

BLOCK_SAMPLES = 4096
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
        self._acts = begin_acts(rig, seed, session)
        axes = rig.base.three_axes
        finest_s = min(
            (effect.finest_step_s() for effect in (*rig.effects, *(axes.effects if axes else ()))), default=inf
        )
        self._fine = max(1, ceil(1.0 / self._rate_hz / finest_s)) if self._acts[EffectSlot.LOW_PASS] else 1
        self._jitter = random_stream(seed, session, HOST_JITTER)
        self._last_arrival_s = -np.inf
        noise = random_stream(seed, session)
        sizes = (rig.base.noise_dps_rthz, rig.base.bias_dps, self._rate_hz, self._fine)
        self._gyro = Channel(self._acts, noise, *sizes)
        self._sensor = None if axes is None else TriaxialSensor(rig, axes, motion, seed, session, self._fine)

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
        return through(self._acts[slot], values, moments)

    def block(self, first: int, count: int) -> Block:
        """Measurements `first` to `first + count`."""
        seq = np.arange(first, first + count)
        truth = self._moments(seq / self._rate_hz, 1.0 / self._rate_hz)
        rates_dps, accel_mps2 = self._values(first, count, truth)
        counts = np.rint(rates_dps / self._base.dps_per_lsb)
        angle_deg = self._through(EffectSlot.COUNTS, self._through(EffectSlot.ENCODER, truth.angle_deg, truth), truth)
        stamp_s = self._through(EffectSlot.CLOCK, truth.t_s, truth)
        arrival_s = self._through(EffectSlot.ARRIVAL, self._at_host(truth.t_s), truth)
        arrived = ~np.isnan(arrival_s)
        block = Block(
            seq=seq,
            t_device_us=np.rint(stamp_s * 1e6).astype(np.int64),
            t_host_s=arrival_s,
            rate_raw=in_counts(counts[:, -1]),
            is_clipped=np.any(np.abs(counts) > COUNTS_MAX, axis=1),
            temp_centi_c=np.rint(truth.temp_c * 100.0).astype(np.int16),
            encoder_counts=np.floor(angle_deg / 360.0 * self._base.encoder_cpr + HALF_A_COUNT).astype(np.int64),
            still=self._still(truth),
        )
        if self._base.three_axes is not None:
            columns = {column.name: getattr(block, column.name) for column in fields(block)}
            accel = accel_in_counts(accel_mps2, self._base.three_axes.mps2_per_lsb)
            block = TriaxialBlock(
                **columns, gyro_xy_raw=in_counts(counts[:, :YAW_AXIS]), accel_raw=accel[0], accel_clipped=accel[1]
            )
        return block if arrived.all() else block.only(arrived)

    def _still(self, truth: Moments) -> NDArray[np.int8]:
        """Reported rest."""
        match self._still_word:
            case StillWord.TRUE:
                return is_still(self._motion, truth.t_s, truth.rate_dps).astype(np.int8)
            case StillWord.NONE:
                return np.full(len(truth.t_s), -1, np.int8)
            case constant:
                return np.full(len(truth.t_s), int(constant.value), np.int8)

    def _sensed(self, fine: Moments) -> tuple[Floats, Floats]:
        """Rate with all effects in continuous time, and the sensed motion, at the samples of the fine grid."""
        seen_s = self._through(EffectSlot.LAG, fine.t_s, fine)
        motion_dps = fine.rate_dps if seen_s is fine.t_s else self._motion.motion_at(seen_s)[1]
        rate_dps = self._gyro.continuous(motion_dps, replace(fine, rate_dps=motion_dps))
        return rate_dps, motion_dps[self._fine - 1 :: self._fine]

    def _fine_moments(self, first: int, count: int) -> Iterator[Moments]:
        """True values on the fine grid, in pieces, so that memory stays bounded."""
        fine_rate_hz = self._rate_hz * self._fine
        piece = max(1, FINE_POINTS // self._fine)
        for start in range(first, first + count, piece):
            end = min(start + piece, first + count)
            points = np.arange((start - 1) * self._fine + 1, (end - 1) * self._fine + 1)
            yield self._moments(points / fine_rate_hz, 1.0 / fine_rate_hz)

    def _values(self, first: int, count: int, truth: Moments) -> SixValues:
        """Rates that the device reads, deg/s, shape (n, 1 or 3), yaw last, and accelerations, shape (n, 0 or 3)."""
        pieces = [truth] if self._fine == 1 else self._fine_moments(first, count)
        if self._sensor is not None:
            return self._sensor.values(
                ((fine, self._through(EffectSlot.LAG, fine.t_s, fine)) for fine in pieces), truth
            )
        parts = [self._sensed(fine) for fine in pieces]
        rate_dps, motion_dps = (np.concatenate(column) for column in zip(*parts, strict=True))
        # Effects of the rate use the sensed rate, not the true one.
        read_dps = self._gyro.sampled(rate_dps, replace(truth, rate_dps=motion_dps))
        return SixValues(read_dps[:, None], np.zeros((count, 0)))
