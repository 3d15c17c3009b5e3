"""Loop of a calibration: samples from the link, keys from the terminal, and a status line."""

import os
import select
import termios
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TextIO

from gyrodrift.calibrate.guide import Guide, GuideStep, Key
from gyrodrift.io.terminal import CLEAR, line_in_place
from gyrodrift.link.link import Link
from gyrodrift.values.errors import DeviceSilentError

if TYPE_CHECKING:
    from gyrodrift.calibrate.positions.guide import PositionGuide

LINE_EVERY_S = 0.1
LONGEST_WAIT_S = 0.2
SILENT_MAX_S = 10.0


@dataclass(slots=True)
class GuideScreen:
    """Output for the user: sentences, and on a terminal a status line below them."""

    stream: TextIO
    is_terminal: bool
    _shown_s: float = 0.0

    def say(self, text: str) -> None:
        """Print a sentence."""
        self.stream.write(f"{CLEAR if self.is_terminal else ''}{text}\n")
        self.stream.flush()

    def show(self, line: str) -> None:
        """Rewrite the status line, at most ten times a second, cut to the width of the terminal."""
        if not self.is_terminal or time.monotonic() - self._shown_s < LINE_EVERY_S:
            return
        self._shown_s = time.monotonic()
        self.stream.write(line_in_place(line, self.stream, otherwise=80))
        self.stream.flush()

    def clear(self) -> None:
        """Remove the status line."""
        if self.is_terminal:
            self.stream.write(CLEAR)
            self.stream.flush()


@dataclass(slots=True)
class Keys:
    """Lines typed by the user, without waiting; the end of input means ENOUGH."""

    fd: int
    is_open: bool = True
    _typed: bytes = field(default=b"")

    def read(self) -> list[Key]:
        """Keys of the lines typed so far; other words are ignored."""
        typed = os.read(self.fd, 1024)
        if not typed:
            self.is_open = False
            return [Key.ENOUGH]
        *lines, self._typed = (self._typed + typed).split(b"\n")
        words = [line.decode("ascii", "replace").strip().lower() for line in lines]
        return [Key(word) for word in words if word in {key.value for key in Key}]


@contextmanager
def without_echo(fd: int) -> Iterator[None]:
    """Terminal without echo, so that typing does not move the status line."""
    before = termios.tcgetattr(fd)
    quiet = termios.tcgetattr(fd)
    quiet[3] &= ~termios.ECHO
    termios.tcsetattr(fd, termios.TCSANOW, quiet)
    try:
        yield
    finally:
        with suppress(termios.error):  # the terminal may be gone
            termios.tcsetattr(fd, termios.TCSANOW, before)


def guided(link: Link, guide: "Guide | PositionGuide", screen: GuideScreen, keys: Keys | None, stop_fd: int) -> bool:
    """Run until the guide is done, or until `stop_fd` becomes readable; True if it is done.

    Raises
    ------
    LinkError
        The device sends nothing, or stops sending.
    CalibrationError
        A step failed, and there is no user to repeat it.
    """
    guide.begin()
    clipped = 0
    while guide.step is not GuideStep.DONE:
        ready = _wait(link, keys, stop_fd)
        if stop_fd in ready:
            return False
        if keys is not None and keys.fd in ready:
            for key in keys.read():
                guide.press(key)
        samples = link.read()
        clipped_total = link.decoder.counters.clipped if link.decoder else 0
        guide.take(samples, clipped_total - clipped)
        clipped = clipped_total
        screen.show(guide.line)
        if link.is_over:
            raise DeviceSilentError(f"{link.name}: it ended before the calibration did; nothing is written")
        if link.counters.samples and link.silent_s() > SILENT_MAX_S:
            raise DeviceSilentError(f"{link.name}: stopped sending; nothing is written. Is it still plugged in?")
    return True


def _wait(link: Link, keys: Keys | None, stop_fd: int) -> set[int]:
    poller = select.poll()
    poller.register(stop_fd, select.POLLIN)
    link_fd = link.fileno()
    for fd in (link_fd, keys.fd if keys is not None and keys.is_open else None):
        if fd is not None:
            poller.register(fd, select.POLLIN)
    return {fd for fd, _ in poller.poll(1e3 * min(link.wake_s(), LONGEST_WAIT_S))}
