"""Text that is sent to a waiting device: after each opening of its port, and again after a loss."""

import os
import pty
import select
import tty
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sources_support import Host
from support import Command

from gyrodrift.link.opening import SEND_LONGEST_BYTES, bytes_to_send
from gyrodrift.values.errors import DeviceSilentError

PROMPT = b"Send any character to begin: \r\n"


class Board:
    """The far end of a port, plugged in at `link`; what it is sent stays until it is asked for."""

    def __init__(self, link: Path) -> None:
        self.link = link
        self.fd = -1
        self.plug_in()

    def plug_in(self) -> None:
        self.fd, slave_fd = pty.openpty()
        tty.setraw(slave_fd)
        self.link.symlink_to(os.ttyname(slave_fd))
        os.close(slave_fd)
        os.set_blocking(self.fd, False)

    def unplug(self) -> None:
        self.link.unlink(missing_ok=True)
        os.close(self.fd)

    def sent(self, wait_s: float = 10.0) -> bytes:
        with suppress(OSError):
            if select.select([self.fd], [], [], wait_s)[0]:
                return os.read(self.fd, 8192)
        return b""

    def say(self, content: bytes) -> None:
        assert os.write(self.fd, content) == len(content)


@pytest.fixture
def board(port: Path) -> Iterator[Board]:
    board = Board(port)
    yield board
    board.unplug()


def test_a_board_that_waits_for_a_key_is_sent_one(board: Board) -> None:
    with Host(board.link, send=b"\r\n") as host:
        assert board.sent() == b"\r\n"
        assert host.told[-1] == ("sent", {"bytes": 2, "content": r"\r\n"})


@pytest.mark.promise("Samples")
def test_a_key_that_was_lost_in_the_reset_is_sent_again_after_a_silence(board: Board) -> None:
    """`--send` is sent after each opening, and again if the reset lost it."""
    with Host(board.link, send=b"x", baud=115200) as host:
        host.read(1.9)
        board.say(PROMPT)
        assert select.select([host.link.fileno() or 0], [], [], 10.0)[0]
        host.read(0.05)
        host.read(1.9)
        assert host.names().count("sent") == 1
        host.read(0.2)
        assert host.names().count("sent") == 2
        assert board.sent().startswith(b"x")


def test_a_board_that_is_busy_with_what_it_was_told_is_left_alone_longer_each_time(board: Board) -> None:
    with Host(board.link, send=b"x", timeout_s=0.0) as host:
        sent_s = []
        for half in range(140):
            before = host.names().count("sent")
            host.read(0.5)
            if host.names().count("sent") > before:
                sent_s.append(0.5 * (half + 1))
        assert sent_s == [2, 6, 14, 30, 46, 62]


def test_a_board_that_speaks_is_sent_nothing_more(board: Board) -> None:
    with Host(board.link, send=b"x") as host:
        samples = []
        for i in range(20):
            board.say(b"%d,1.5\n" % (10_000 * i))
            samples += host.read(0.01)
        assert samples
        for _ in range(30):
            host.read(1.0)
        assert host.names().count("sent") == 1


def test_a_board_that_comes_back_is_sent_it_again(board: Board) -> None:
    with Host(board.link, send=b"x") as host:
        host.link.send_at_opening(b"y")
        assert board.sent() == b"x"
        board.unplug()
        host.read(0.1)
        board.plug_in()
        host.read(0.1)
        assert board.sent() == b"y"
        assert [event for event, _ in host.told if event in {"sent", "link_restored"}] == [
            "sent",
            "link_restored",
            "sent",
        ]


@pytest.mark.promise("Samples")
def test_where_nothing_is_to_be_sent_nothing_is(board: Board) -> None:
    """Without `--send` no byte is sent to a device."""
    with Host(board.link, send=b"", timeout_s=20.0) as host:
        for _ in range(19):
            host.read(1.0)
        with pytest.raises(DeviceSilentError):
            host.read(1.0)
        assert (host.names().count("sent"), board.sent(0.0)) == (0, b"")


def test_the_command_starts_a_board_that_waits(board: Board) -> None:
    """`serve --send`: the board streams when its key has come."""
    with Command("serve", "--port", board.link, "--send", r"go\r") as serve:
        serve.until(lambda _: board.sent(0.1) == b"go\r", "what the board was sent")
        board.say(b"".join(b"%d,1.5\n" % (10_000 * i) for i in range(50)))
        assert serve.take_lines(40)[-1]["rate_dps"] == pytest.approx(1.5)
        assert serve.stop() == 0
    assert r"event=sent" in serve.log


def test_the_config_says_it_as_well(board: Board, tmp_path: Path) -> None:
    config = tmp_path / "c.yaml"
    config.write_text("send: 'a\\x0a'\n")
    with Command("serve", "--port", board.link, "--config", config) as serve:
        serve.until(lambda _: board.sent(0.1) == b"a\n", "what the config sends")
        assert serve.stop() == 0
    with Command("serve", "--port", board.link, "--config", config, "--send", "b") as serve:
        serve.until(lambda _: board.sent(0.1) == b"b", "what the option sends")
        assert serve.stop() == 0


@pytest.mark.parametrize(
    ("text", "content"),
    [
        (r"\r\n", b"\r\n"),
        (r"\\r", rb"\r"),
        (r"\x1b[c\0\177", b"\x1b[c\x00\x7f"),
        (r"\"\'\a\b\f\t\v", b"\"'\a\b\f\t\v"),
        ("\r", b"\r"),
        ("grün", "grün".encode()),
        ("\udcff", b"\xff"),
    ],
)
def test_escapes_are_those_of_python(text: str, content: bytes) -> None:
    assert bytes_to_send(text) == content


@given(st.binary(min_size=1, max_size=200))
def test_any_bytes_can_be_said_with_escapes(content: bytes) -> None:
    assert bytes_to_send(repr(content)[2:-1]) == content


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("", "is 0 bytes"),
        ("x" * (SEND_LONGEST_BYTES + 1), "is 4097 bytes; expected 1 to 4096"),
        (r"\q", r"has the unknown escape \\q; examples"),
        (r"\x1", r"has the unknown escape \\x; examples"),
        ("\\", r"has the unknown escape \\; examples"),
        (r"\777", r"has the unknown escape \\777; examples"),
        ("\ud800", "surrogates not allowed"),
    ],
)
def test_what_stands_for_no_bytes_is_refused(text: str, what: str) -> None:
    with pytest.raises(ValueError, match=what):
        bytes_to_send(text)
