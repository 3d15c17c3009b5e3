"""Inputs made of others, from a seed: bytes changed anywhere, pieces repeated, and what the format of a target allows.

Most bytes that are changed by chance end at a checksum or at the first word of a parser. So most changes know the
format: `fuzz.texts` those of lines and of files of text, `fuzz.frames` and `fuzz.archives` those with checksums.
"""

from collections.abc import Callable, Sequence
from random import Random

from fuzz.archives import changed_archive, changed_changes, changed_recording
from fuzz.frames import changed_frames, changed_readings
from fuzz.packets import changed_packets
from fuzz.texts import changed_cell, changed_json, changed_packed, changed_scalar, changed_word, nested, with_display

EDGES = (b"\x00", b"\xff", b"\x7f", b"\x80", b"\n", b",", b"[", b"{", b'"', b"-", b"1e999", b"nan", b"inf", b"9" * 40)
NUMBERS = tuple(value.to_bytes(size, "little") for size in (2, 4, 8) for value in (1, (1 << 8 * size - 1) - 1))
LONGEST = 1 << 15

Mutator = Callable[[bytes, Random], bytes]
"""From an input to another one; it gives the input itself where there is nothing that it could change."""


def mutated(name: str, seeds: Sequence[bytes], random: Random) -> bytes:
    """One of the seeds of a target, changed in some places."""
    content = random.choice(seeds)
    for _ in range(random.randint(1, 3)):
        if random.randrange(6):
            content = changed(name, content, random)
        else:
            content = joined(content, random.choice(seeds), random)
    return content[:LONGEST]


def changed(name: str, content: bytes, random: Random) -> bytes:
    """An input of a target, changed by one of the ways that the target has."""
    return random.choice((changed_bytes, repeated, *FORMATS[name]))(content, random)[:LONGEST]


def changed_bytes(content: bytes, random: Random) -> bytes:
    """A few bytes changed, put in or taken out."""
    made = bytearray(content)
    for _ in range(random.randint(1, 8)):
        at = random.randint(0, len(made))
        match random.randrange(5):
            case 0:
                made[at:at] = random.choice(EDGES + NUMBERS)
            case 1:
                del made[at : at + random.randint(1, 16)]
            case 2 if made:
                made[at % len(made)] = random.randrange(256)
            case 3:
                made[at : at + 8] = random.choice(EDGES + NUMBERS)
            case _:
                made[at:at] = random.randbytes(random.randint(1, 12))
    return bytes(made)


def repeated(content: bytes, random: Random) -> bytes:
    """A piece of a few bytes, a line or all of it over and over, up to the longest input: work that grows too fast."""
    at = random.randint(0, max(0, len(content) - 1))
    piece = content[at : at + random.choice((1, 1, 1, 2, 3, 8, 40, 200))] or b"1"
    length = LONGEST if not random.randrange(30) else random.choice((2, 20, 200, 200, 2_000))
    times = max(2, length // len(piece))
    return content[:at] + piece * times + random.choice((b"", b"a", b"\n", b"!")) + content[at:]


def joined(content: bytes, other: bytes, random: Random) -> bytes:
    """The beginning of one input and the end of another."""
    return content[: random.randint(0, len(content))] + other[random.randint(0, len(other)) :]


FORMATS: dict[str, tuple[Mutator, ...]] = {
    "decoders": (changed_frames, changed_frames, changed_cell),
    "detector": (changed_frames, changed_frames, changed_cell),
    "text": (with_display, changed_json, changed_cell, changed_word, nested),
    "columns": (changed_word, changed_cell),
    "clocks": (changed_readings, changed_readings),
    "config": (changed_scalar, changed_scalar, changed_word, nested),
    "rig": (changed_scalar, changed_scalar, changed_word, nested),
    "mcap": (changed_recording, changed_recording, changed_recording),
    "damage": (changed_changes, changed_changes),
    "csv": (changed_cell, changed_cell, changed_word),
    "journal": (changed_archive, changed_archive),
    "memory": (changed_json, changed_json, changed_json, changed_word),
    "clients": (changed_json, changed_json, changed_word, nested),
    "sockets": (changed_json, changed_json, changed_json, changed_word, changed_packed, nested),
    "source_decoders": (changed_packets, changed_packets),
}
"""Of each target the ways to change an input within its format."""
