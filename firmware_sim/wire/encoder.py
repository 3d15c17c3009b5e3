"""What an encoder is: one record a protocol, which turns measurements into frames."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

from firmware_sim.measure import COUNTS_MOST, Block
from firmware_sim.rig import Base


class Frame(NamedTuple):
    """Bytes that leave together; `t_s` is when the host has them, in s since power-on.

    rows
        How many measurements are in it: 0 for HELLO.
    end_mark
        Bytes by which a reader knows that a frame is over; none where a protocol has no such mark.
    """

    t_s: float
    content: bytes
    rows: int
    end_mark: bytes = b""


class Measurement(NamedTuple):
    """One sample of a recording, in physical units.

    due_s
        When it is due, s after the first; it never goes back.
    t_us, seq
        Device clock in µs and counter, neither of them wrapped.
    rate_dps
        Yaw rate, deg/s, with all its digits; it may be no finite number.
    encoder_deg, temp_c
        Reference angle in degrees and temperature in °C; None, or NaN, where there is none.
    still
        What is said of rest beside the rate: 1 stands still, 0 moves; likewise.
    """

    due_s: float
    t_us: int
    seq: int
    rate_dps: float
    encoder_deg: float | None
    temp_c: float | None
    still: float | None = None


MOST_32_BITS = 2**31 - 1
MOST_FLOAT32 = 3.4028234e38


def in_16_bits(value: float) -> int:
    """The nearest that a signed register of 16 bits can say, which is the same in both directions."""
    return round(max(-COUNTS_MOST, min(COUNTS_MOST, value)))


def in_32_bits(value: float) -> int:
    """The same of 32 bits, as counters of an encoder have."""
    return round(max(-MOST_32_BITS, min(MOST_32_BITS, value)))


def in_float32(value: float) -> float:
    """The nearest number that a float of four bytes can say."""
    return max(-MOST_FLOAT32, min(MOST_FLOAT32, value))


def no_hello(_base: Base) -> bytes:
    """The greeting of a protocol that has none."""
    return b""


@dataclass(frozen=True, slots=True)
class WireEncoder:
    """A protocol as a device speaks it.

    name
        What `--protocol` calls it.
    frames
        From the blocks of a rig that measures without end, and its base, to frames.
    recorded
        The same from the samples of a recording: `gyrodrift replay` plays them. `dps_per_lsb` and `encoder_cpr` of
        the base say how fine a protocol of whole counts is to be; any other keeps every digit.
    hello
        What greets a reader that has just opened the port, from the base of the rig.
    """

    name: str
    frames: Callable[[Iterable[Block], Base], Iterator[Frame]]
    recorded: Callable[[Iterable[Measurement], Base], Iterator[Frame]]
    hello: Callable[[Base], bytes] = no_hello
