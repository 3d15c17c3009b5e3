"""Telnet: data, commands and subnegotiations, in any pieces."""

from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.link.sources.rfc2217 import (
    DO,
    IAC,
    LONGEST_SUBNEGOTIATION,
    SB,
    SE,
    WILL,
    TelnetReceived,
    TelnetStream,
    escaped,
)

STREAM = (
    b"ab"
    + bytes((IAC, IAC))
    + b"c"
    + bytes((IAC, DO, 44))
    + b"d"
    + bytes((IAC, SB, 44, 101, 0, IAC, IAC, 1, IAC, SE))
    + bytes((IAC, 241))
    + b"e"
    + bytes((IAC, WILL, 0))
)


def joined(pieces: list[TelnetReceived]) -> TelnetReceived:
    return TelnetReceived(
        b"".join(piece.content for piece in pieces),
        [command for piece in pieces for command in piece.commands],
        [content for piece in pieces for content in piece.subnegotiations],
    )


@given(st.lists(st.integers(0, len(STREAM)), max_size=8))
def test_any_split_gives_the_same(cuts: list[int]) -> None:
    ends = [0, *sorted(cuts), len(STREAM)]
    stream = TelnetStream()
    received = joined([stream.push(STREAM[a:b]) for a, b in pairwise(ends)])
    assert received == TelnetReceived(b"ab\xffcde", [(DO, 44), (WILL, 0)], [bytes((44, 101, 0, 255, 1))])


@given(st.binary(max_size=200))
def test_escaped_bytes_come_back(content: bytes) -> None:
    assert TelnetStream().push(escaped(content)).content == content


@given(st.lists(st.binary(max_size=600), max_size=8))
def test_hostile_bytes_cost_bytes_only(chunks: list[bytes]) -> None:
    stream = TelnetStream()
    for chunk in chunks:
        stream.push(bytes((IAC, SB)) + chunk)
        assert len(stream._pending) <= LONGEST_SUBNEGOTIATION
