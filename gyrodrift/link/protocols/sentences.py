"""Base of all protocols of sentences with a checksum, `$words*hh` (NMEA 0183)."""

from abc import ABC, abstractmethod
from binascii import crc_hqx
from functools import reduce
from math import isfinite
from operator import xor

from gyrodrift.link.protocols.decoder import DecoderCounters, DeviceDescription
from gyrodrift.values.sample import Reading

LONGEST_BYTES = 256
HEX = frozenset(b"0123456789ABCDEFabcdef")


class SentenceDecoder(ABC):
    """Decoder of lines that begin with `$` and end with two hexadecimal digits, or four of a CRC-16."""

    name: str

    def __init__(self) -> None:
        self.counters = DecoderCounters()
        self.device = DeviceDescription()
        self._pending = b""
        self._overlong = False

    @abstractmethod
    def is_known(self, words: list[str]) -> bool:
        """Whether a sentence is of a kind that the decoder reads."""

    @abstractmethod
    def read(self, words: list[str]) -> Reading | None:
        """Reading of a known sentence; None without a valid rate."""

    def words(self, line: bytes) -> list[str] | None:
        """Words between the commas of a sentence; None if it is damaged."""
        return words_of(line)

    def push(self, chunk: bytes) -> list[Reading]:
        """Split at line ends, and decode complete lines."""
        readings: list[Reading] = []
        *lines, pending = (self._pending + chunk).split(b"\n")
        for line in lines:
            self._line(line, readings)
            self._overlong = False
        if len(pending) > LONGEST_BYTES:
            self._overlong = True
            pending = pending[:1]
        self._pending = pending
        return readings

    def _line(self, line: bytes, readings: list[Reading]) -> None:
        text, is_overlong = line.strip(), self._overlong or len(line) > LONGEST_BYTES
        if not text and not is_overlong:
            return
        words = None if is_overlong else self.words(text)
        if words is None:
            self.counters.damaged += 1
        elif self.is_known(words):
            self.counters.frames += 1
            reading = self.read(words)
            if reading is None:
                self.counters.other_frames += 1
            else:
                readings.append(reading)
        elif self.counters.frames:  # other sentences count only after the first known one
            self.counters.frames += 1
            self.counters.other_frames += 1


def words_of(line: bytes) -> list[str] | None:
    """Words between the commas of a sentence; None if its checksum is wrong or missing."""
    body, mark, digits = line[1:].rpartition(b"*")
    if line[:1] != b"$" or not mark or not HEX.issuperset(digits) or not body.isascii():
        return None
    if len(digits) == 4:
        is_right = crc_hqx(body, 0) == int(digits, 16)
    else:
        is_right = len(digits) == 2 and reduce(xor, body, 0) == int(digits, 16)
    return body.decode("ascii").split(",") if is_right else None


def number_in(words: list[str], index: int) -> float | None:
    """Finite number at an index; None without one."""
    try:
        number = float(words[index])
    except (IndexError, ValueError):
        return None
    return number if isfinite(number) else None
