"""Base of all protocols of sentences with a checksum, `$words*hh` (NMEA 0183)."""

from abc import abstractmethod
from binascii import crc_hqx
from functools import reduce
from math import isfinite
from operator import xor

from gyrodrift.link.protocols.frames import PieceDecoder
from gyrodrift.values.sample import Reading

HEX = frozenset(b"0123456789ABCDEFabcdef")


class SentenceDecoder(PieceDecoder):
    """Decoder of lines that begin with `$` and end with two hexadecimal digits, or four of a CRC-16."""

    @abstractmethod
    def is_known(self, words: list[str]) -> bool:
        """Whether a sentence is of a kind that the decoder reads."""

    @abstractmethod
    def read(self, words: list[str]) -> Reading | None:
        """Reading of a known sentence; None without a valid rate."""

    def words(self, line: bytes) -> list[str] | None:
        """Words between the commas of a sentence; None if it is damaged."""
        return words_of(line)

    def take(self, piece: bytes, readings: list[Reading]) -> None:
        """Decode a line."""
        line = piece.strip()
        words = self.words(line) if line else []
        if words is None:
            self.counters.damaged += 1
        elif words and self.is_known(words):
            self.count(self.read(words), readings)
        elif words and self.counters.frames:  # other sentences count only after the first known one
            self.count(None, readings)


def checksum(body: bytes) -> int:
    """Exclusive or of all characters between `$` and `*` (NMEA 0183)."""
    return reduce(xor, body, 0)


def words_of(line: bytes) -> list[str] | None:
    """Words between the commas of a sentence; None if its checksum is wrong or missing."""
    body, mark, digits = line[1:].rpartition(b"*")
    if line[:1] != b"$" or not mark or not HEX.issuperset(digits) or not body.isascii():
        return None
    if len(digits) == 4:
        is_right = crc_hqx(body, 0) == int(digits, 16)
    else:
        is_right = len(digits) == 2 and checksum(body) == int(digits, 16)
    return body.decode("ascii").split(",") if is_right else None


def number_in(words: list[str], index: int) -> float | None:
    """Finite number at an index; None without one."""
    try:
        number = float(words[index])
    except (IndexError, ValueError):
        return None
    return number if isfinite(number) else None
