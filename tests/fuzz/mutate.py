"""Inputs made of others, by chance and from a seed: where no coverage guides, and for short runs in the tests."""

from collections.abc import Sequence
from random import Random

EDGES = (b"\x00", b"\xff", b"\x7f", b"\x80", b"\n", b",", b"[", b"{", b'"', b"-", b"1e999", b"nan", b"inf", b"9" * 40)
NUMBERS = tuple(value.to_bytes(size, "little") for size in (2, 4, 8) for value in (1, (1 << 8 * size - 1) - 1))
LONGEST = 1 << 16


def mutated(seeds: Sequence[bytes], random: Random) -> bytes:
    """One of the seeds, changed in a few places, cut, doubled, or joined with another one."""
    content = bytearray(random.choice(seeds))
    for _ in range(random.randint(1, 8)):
        at = random.randint(0, len(content))
        match random.randrange(7):
            case 0:
                content[at:at] = random.choice(EDGES + NUMBERS)
            case 1:
                del content[at : at + random.randint(1, 16)]
            case 2 if content:
                content[at % len(content)] = random.randrange(256)
            case 3:
                content[at : at + 8] = random.choice(EDGES + NUMBERS)
            case 4:
                content[at:at] = content[at : at + random.randint(1, 200)] * random.choice((1, 2, 50))
            case 5:
                other = random.choice(seeds)
                start = random.randint(0, len(other))
                content[at:] = other[start:]
            case _:
                content[at:at] = random.randbytes(random.randint(1, 12))
    return bytes(content[:LONGEST])
