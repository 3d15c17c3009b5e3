"""The line that says how a recording goes."""

import fcntl
import io
import os
import pty
import select
import struct
import termios
import tty
from collections.abc import Iterator
from contextlib import suppress
from random import Random
from types import SimpleNamespace
from typing import TextIO, cast

import pytest

from gyrodrift.filters.restlevel.model import RestlevelParams
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.filters.run import FilterRun
from gyrodrift.io.log import open_log
from gyrodrift.io.terminal import CLEAR, AboveLine
from gyrodrift.link.link import Link
from gyrodrift.recording.live_line import LiveLine, LiveYaw
from gyrodrift.recording.recorder import Recorder
from gyrodrift.values.sample import Sample

QUIET_S = 0.2


class Going:
    """A recording that is going on, as far as the line looks at it."""

    def __init__(self, stream: TextIO) -> None:
        self.link = SimpleNamespace(
            name="/dev/gyro", counters=SimpleNamespace(gaps=0), decoder=None, device=SimpleNamespace(device_id=None)
        )
        self.recorder = SimpleNamespace(samples=0, size_bytes=0, left_bytes=36_000_000_000)
        self.line = LiveLine(
            cast("Link", self.link),
            cast("Recorder", self.recorder),
            LiveYaw(FilterRun(RESTLEVEL, RestlevelParams())),
            stream,
        )

    def go_on(self, now_s: float, samples: int, size_bytes: int) -> str:
        self.recorder.samples, self.recorder.size_bytes = samples, size_bytes
        self.line.tick(now_s)
        return self.line.text(now_s)


class Terminal:
    """A pty with so many columns, and a text stream on it."""

    def __init__(self, columns: int) -> None:
        self.master, slave = pty.openpty()
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("4H", 24, columns, 0, 0))
        tty.setraw(slave)
        self.stream = os.fdopen(slave, "w")

    def hang_up(self) -> None:
        os.close(self.master)
        self.master = -1

    def shown(self) -> str:
        """All that has come; a pty hands on what is written in its own time."""
        result = os.read(self.master, 1 << 16)
        while select.select([self.master], [], [], QUIET_S)[0]:
            result += os.read(self.master, 1 << 16)
        return result.decode()

    def close(self) -> None:
        with suppress(OSError):  # what a dead terminal did not take
            self.stream.close()
        if self.master >= 0:
            self.hang_up()


@pytest.fixture
def terminal() -> Iterator[Terminal]:
    terminal = Terminal(80)
    yield terminal
    terminal.close()


def test_it_waits_until_samples_come() -> None:
    assert Going(io.StringIO()).go_on(5.0, 0, 400) == "waiting for samples on /dev/gyro"


def test_it_tells_time_yaw_rate_gaps_damage_size_and_how_long_the_disk_will_do() -> None:
    """The rate over the last two seconds or so, the time since the first sample."""
    going = Going(io.StringIO())
    going.go_on(10.0, 100, 1_000_000)
    going.link.counters.gaps = 2
    going.link.decoder = SimpleNamespace(counters=SimpleNamespace(damaged=7))
    statement = going.go_on(12.0, 300, 3_000_000)
    assert (
        statement
        == "0:00:02   yaw +0.0 deg   100.0 Hz   300 samples   2 gaps   7 damaged   3.0 MB   36.0 GB left for 10 h"
    )


def test_the_rate_is_that_of_the_last_moments() -> None:
    going = Going(io.StringIO())
    for tick in range(40):
        going.go_on(tick * 0.25, tick * 250, tick * 20_000)
    for tick in range(9):
        statement = going.go_on(10.0 + tick * 0.25, 10_000 + tick * 25, 800_000 + tick * 2000)
    assert " 100.0 Hz " in statement


@pytest.mark.parametrize(
    ("remaining", "size_bytes", "message_part"),
    [
        (None, 1_000_000, "disk gone"),
        (36_000_000_000, 0, "36.0 GB left"),
        (36_000_000_000, 100_000, "36.0 GB left for 4 days"),
        (0, 100_000, "0.0 GB left for 0 h"),
    ],
)
def test_the_disk_is_told_in_words_for_a_person(remaining: int | None, size_bytes: int, message_part: str) -> None:
    """Hours up to three days; nothing where nothing is written."""
    going = Going(io.StringIO())
    going.recorder.left_bytes = remaining
    going.go_on(0.0, 1, 0)
    assert going.go_on(1.0, 101, size_bytes).endswith(f"   {message_part}")


def test_it_is_written_over_and_over_and_gone_at_the_end() -> None:
    stream = io.StringIO()
    going = Going(stream)
    statement = [going.go_on(float(second), second, second) for second in range(3)]
    going.line.close()
    assert stream.getvalue() == "".join(CLEAR + text for text in [*statement, ""])


def test_it_never_wraps(terminal: Terminal) -> None:
    """A line that wraps would not be cleared, and fill the terminal four times a second."""
    going = Going(terminal.stream)
    going.go_on(0.0, 1_000_000, 83_000_000)
    statement = going.go_on(0.25, 1_000_250, 83_020_750)
    assert len(statement) > 80
    assert terminal.shown().split(CLEAR)[-1] == statement[:79]


def test_a_terminal_that_is_gone_does_not_end_a_recording(terminal: Terminal) -> None:
    going = Going(terminal.stream)
    going.go_on(0.0, 1, 1)
    terminal.hang_up()
    going.go_on(0.25, 2, 2)
    log = AboveLine(terminal.stream)
    log.write("level=info\n")
    log.flush()
    going.line.close()
    assert not terminal.stream.closed, "its owner closes it"


def test_the_log_clears_the_line_and_ends_its_own() -> None:
    stream = io.StringIO()
    open_log("info", "json", AboveLine(stream)).info("gap")
    line = stream.getvalue()
    assert line.startswith(f'{CLEAR}{{"event": "gap"')
    assert line.count(CLEAR) == 1
    assert line.endswith("}\n")


def test_yaw_is_that_of_the_filter() -> None:
    """A bias of 0.35 deg/s from a rest, then a turn of 90 degrees; nothing of it is for the log."""
    going = Going(io.StringIO())
    rates_dps, noise = [0.35] * 1000 + [90.35] * 100 + [0.35] * 100, Random(1)
    going.line.take([Sample(n, n / 100, n / 100, rate + noise.gauss(0.0, 0.03)) for n, rate in enumerate(rates_dps)])
    assert "   yaw +90.0 deg   " in going.go_on(12.0, 1200, 100_000)
    assert going.line.stats() == {}
