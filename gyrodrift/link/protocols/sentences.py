"""Sentences with a checksum, `$words*hh`: what holds for every protocol of them (NMEA 0183)."""

from abc import ABC, abstractmethod
from binascii import crc_hqx
from functools import reduce
from math import isfinite
from operator import xor

from gyrodrift.link.protocols.decoder import DecoderCounters, DeviceDescription
from gyrodrift.sample import Reading

LONGEST_BYTES = 256
HEX = frozenset(b"0123456789ABCDEFabcdef")


class SentenceDecoder(ABC):
    """Lines that begin with `$` and end with a checksum of two hexadecimal digits, or a CRC-16 of four."""

    name: str

    def __init__(self) -> None:
        self.counters = DecoderCounters()
        self.device = DeviceDescription()
        self._pending = b""
        self._overlong = False

    @abstractmethod
    def is_known(self, words: list[str]) -> bool:
        """Whether a sentence is of the kind that is listened for."""

    @abstractmethod
    def read(self, words: list[str]) -> Reading | None:
        """The rate in a sentence that is known; None where it holds none, or says that it is not valid."""

    def words(self, line: bytes) -> list[str] | None:
        """What stands between the commas of a sentence; None where it is damaged."""
        return words_of(line)

    def push(self, chunk: bytes) -> list[Reading]:
        """Split at line ends."""
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
        text = line.strip()
        if not text and not self._overlong:
            return
        words = None if self._overlong or len(line) > LONGEST_BYTES else self.words(text)
        if words is None:
            self.counters.damaged += 1
        elif self.is_known(words):
            self.counters.frames += 1
            reading = self.read(words)
            if reading is None:
                self.counters.other += 1
            else:
                readings.append(reading)
        elif self.counters.frames:  # what others say is of no interest before a sentence came that is
            self.counters.frames += 1
            self.counters.other += 1


def words_of(line: bytes) -> list[str] | None:
    """What stands between the commas of a sentence; None where its checksum is wrong, or it has none."""
    body, mark, said = line[1:].rpartition(b"*")
    if line[:1] != b"$" or not mark or not HEX.issuperset(said) or not body.isascii():
        return None
    if len(said) == 4:
        is_right = crc_hqx(body, 0) == int(said, 16)
    else:
        is_right = len(said) == 2 and reduce(xor, body, 0) == int(said, 16)
    return body.decode("ascii").split(",") if is_right else None


def number_in(words: list[str], place: int) -> float | None:
    """The number at a place; None where there is none, or none that is finite."""
    try:
        number = float(words[place])
    except (IndexError, ValueError):
        return None
    return number if isfinite(number) else None
