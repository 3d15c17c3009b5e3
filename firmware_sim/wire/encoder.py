"""Encoder of a protocol: a record that turns measurements into frames."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import repeat
from math import isfinite, nan
from typing import NamedTuple

from firmware_sim.constants import STANDARD_GRAVITY_MPS2
from firmware_sim.measure import COUNTS_MAX, Block, TriaxialBlock
from firmware_sim.rig import Base


class Frame(NamedTuple):
    """Bytes that are sent together; `t_s` is their arrival at the host, s since power-on.

    rows
        Number of measurements; 0 for HELLO.
    end_mark
        Bytes that end a frame; empty if the protocol has none.
    """

    t_s: float
    content: bytes
    rows: int
    end_mark: bytes = b""


Vector = tuple[float, float, float]


class Axes(NamedTuple):
    """Rates, deg/s, and specific forces, m/s², about x, y and z; z is up on a level table."""

    gyro_dps: Vector
    accel_mps2: Vector


def level(rate_dps: float) -> Axes:
    """Axes of a device on a level table."""
    return Axes((0.0, 0.0, rate_dps), (0.0, 0.0, STANDARD_GRAVITY_MPS2))


def axes_of(block: Block, base: Base) -> Iterator[Axes | None]:
    """Axes of each measurement of a block, None for a device with one axis; a missing acceleration is NaN."""
    if not isinstance(block, TriaxialBlock) or base.three_axes is None:
        yield from repeat(None, len(block.seq))
        return
    mps2_per_lsb = base.three_axes.mps2_per_lsb
    for gyro_raw, accel_raw, _ in block.axes_rows():
        x, y, z = (count * base.dps_per_lsb for count in gyro_raw)
        along_x, along_y, along_z = [count * mps2_per_lsb for count in accel_raw] if accel_raw else (nan, nan, nan)
        yield Axes((x, y, z), (along_x, along_y, along_z))


class Measurement(NamedTuple):
    """Sample of a recording in physical units.

    due_s
        Time of sending, s after the first sample; it never goes back.
    t_us, seq
        Device clock, µs, and counter, both not wrapped.
    rate_dps
        Yaw rate, deg/s; it may be infinite or NaN.
    encoder_deg, temp_c
        Reference angle, degrees, and temperature, °C; None or NaN if missing.
    still
        Reported rest: 1 at rest, 0 in motion; None or NaN if missing.
    gyro_dps, accel_mps2
        Rates, deg/s, and accelerations, m/s², about x, y and z; None for a device with one axis. Single values may be
        NaN.
    """

    due_s: float
    t_us: int
    seq: int
    rate_dps: float
    encoder_deg: float | None
    temp_c: float | None
    still: float | None = None
    gyro_dps: Vector | None = None
    accel_mps2: Vector | None = None

    @property
    def axes(self) -> Axes | None:
        """All axes; None without three rates. A missing acceleration is NaN."""
        return None if self.gyro_dps is None else Axes(self.gyro_dps, self.accel_mps2 or (nan, nan, nan))

    @property
    def is_finite(self) -> bool:
        """Whether all rates are finite."""
        return all(map(isfinite, self.gyro_dps or (self.rate_dps,)))


INT32_MAX = 2**31 - 1
FLOAT32_MAX = 3.4028234e38


def in_16_bits(value: float) -> int:
    """Nearest value of a signed 16-bit register with a symmetric range."""
    return round(max(-COUNTS_MAX, min(COUNTS_MAX, value)))


def in_32_bits(value: float) -> int:
    """Nearest value of a signed 32-bit register with a symmetric range."""
    return round(max(-INT32_MAX, min(INT32_MAX, value)))


def in_float32(value: float) -> float:
    """Nearest 32-bit float."""
    return max(-FLOAT32_MAX, min(FLOAT32_MAX, value))


def no_hello(_base: Base) -> bytes:
    """Empty greeting."""
    return b""


@dataclass(frozen=True, slots=True)
class WireEncoder:
    """Protocol of a device.

    name
        Name for `--protocol`.
    frames
        Function from the endless blocks of a rig, and its base, to frames.
    recorded
        Function from the samples of a recording to frames, for `gyrodrift replay`. Protocols with counts use
        `dps_per_lsb` and `encoder_cpr` of the base; others keep every digit.
    hello
        Function from the base of the rig to the greeting of a new reader.
    """

    name: str
    frames: Callable[[Iterable[Block], Base], Iterator[Frame]]
    recorded: Callable[[Iterable[Measurement], Base], Iterator[Frame]]
    hello: Callable[[Base], bytes] = no_hello
