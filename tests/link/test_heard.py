"""Bytes before the protocol is known: text, or not."""

from random import Random

import pytest

from gyrodrift.io.plain_text import plain_text
from gyrodrift.link.heard import Heard


def heard(content: bytes, seconds: float = 1.0) -> Heard:
    result = Heard()
    result.add(content[:1], 0.0)
    result.add(content[1:], seconds)
    return result


@pytest.mark.parametrize(
    "content",
    [
        b"gx=0.36,gy=-0.73,gz=0.50\rgx=0.26,gy=-0.85,gz=0.50\r",
        b"Gz: 0.58\xb0/s\r\nGz: 0.46\xb0/s\r\n",
        "Gz: 0.58°/s\nGz: 0.46°/s\n".encode()[1:],
        b"gx: 0.3\x00\ngx: 0.4\x00\n",
        b"\x1b[2J\x1b[H gz 0.51\n\x1b[2J\x1b[H gz 0.52\n",
        b"Type help() for more information.\r\n>>> ",
        b"gx: 0.30 gy: -0.80 gz: 0.50\r\n",
    ],
    ids=["CR alone", "Latin-1", "UTF-8", "zeros", "screen control", "a prompt", "one slow line"],
)
def test_text_is_known_as_text(content: bytes) -> None:
    assert heard(content).is_text


@pytest.mark.parametrize("seed", range(20))
def test_noise_and_frames_are_no_text(seed: int) -> None:
    assert not heard(Random(seed).randbytes(40)).is_text
    assert not heard(b"ue\x80\x1c\x0e\x04<#L9\xbc\xcb\xff\xf8?~\x9ck" * 3).is_text


def test_a_few_bytes_say_nothing() -> None:
    assert not heard(b"ok\r\n").is_text


@pytest.mark.parametrize("line", [b"a=1\r", b"a=1\r\n", b"a=1\n"])
def test_the_pace_counts_lines_of_any_end(line: bytes) -> None:
    result = Heard()
    for number in range(41):
        result.add(line, number / 20.0)
    assert result.lines_per_s == pytest.approx(20.0, rel=0.05)


def test_the_last_words_are_those_that_have_no_end() -> None:
    assert heard(b"Welcome\r\npress a key: ").last_words() == "press a key:"


def test_what_steers_a_terminal_is_no_text() -> None:
    assert plain_text(b"\x1b[0;36m[D] gz\x1b[0m\x00 1\x1b[2K") == b"[D] gz 1"
