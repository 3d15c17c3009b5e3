"""The loop of a calibration: samples from the link, keys from the terminal, one line that says what is going on."""

import os
import select
import termios
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from typing import TextIO

from gyrodrift.calibrate.guide import Guide, GuideStep, Key
from gyrodrift.errors import DeviceSilentError
from gyrodrift.link.link import Link

CLEAR = "\r\x1b[K"
LINE_EVERY_S = 0.1
LONGEST_WAIT_S = 0.2
SILENT_MOST_S = 10.0


@dataclass(slots=True)
class GuideScreen:
    """Where a person reads: sentences that stay, and on a terminal a line below them that is rewritten."""

    stream: TextIO
    is_terminal: bool
    _shown_s: float = 0.0

    def say(self, text: str) -> None:
        """A sentence that stays."""
        self.stream.write(f"{CLEAR if self.is_terminal else ''}{text}\n")
        self.stream.flush()

    def show(self, line: str) -> None:
        """What is going on, ten times a second; no more of it than a line takes."""
        if not self.is_terminal or time.monotonic() - self._shown_s < LINE_EVERY_S:
            return
        self._shown_s = time.monotonic()
        columns = 80
        with suppress(OSError):
            columns = os.get_terminal_size(self.stream.fileno()).columns or columns
        self.stream.write(CLEAR + line[: columns - 1])
        self.stream.flush()

    def clear(self) -> None:
        """Leave the terminal as it was."""
        if self.is_terminal:
            self.stream.write(CLEAR)
            self.stream.flush()


@dataclass(slots=True)
class Keys:
    """Lines that a person types, without waiting; the end of input says that it is enough."""

    fd: int
    is_open: bool = True
    _typed: bytes = field(default=b"")

    def read(self) -> list[Key]:
        """What has been typed, line by line; other words are passed over."""
        typed = os.read(self.fd, 1024)
        if not typed:
            self.is_open = False
            return [Key.ENOUGH]
        *lines, self._typed = (self._typed + typed).split(b"\n")
        words = [line.decode("ascii", "replace").strip().lower() for line in lines]
        return [Key(word) for word in words if word in {key.value for key in Key}]


@contextmanager
def without_echo(fd: int) -> Iterator[None]:
    """A terminal that does not show what is typed: the line that is rewritten stays where it is."""
    before = termios.tcgetattr(fd)
    quiet = termios.tcgetattr(fd)
    quiet[3] &= ~termios.ECHO
    termios.tcsetattr(fd, termios.TCSANOW, quiet)
    try:
        yield
    finally:
        with suppress(termios.error):  # the terminal may be gone
            termios.tcsetattr(fd, termios.TCSANOW, before)


def guided(link: Link, guide: Guide, screen: GuideScreen, keys: Keys | None, stop_fd: int) -> bool:
    """Run until the guide is done, or until `stop_fd` becomes readable; whether it is done.

    Raises
    ------
    LinkError
        Where the device says nothing, or falls silent.
    CalibrationError
        Where what it says calibrates nothing, and nobody is there to do it again.
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
        seen = link.decoder.counters.clipped if link.decoder else 0
        guide.take(samples, seen - clipped)
        clipped = seen
        screen.show(guide.line)
        if link.counters.samples and link.silent_s() > SILENT_MOST_S:
            raise DeviceSilentError(f"{link.name}: fell silent; nothing is written. Is it still plugged in?")
    return True


def _wait(link: Link, keys: Keys | None, stop_fd: int) -> set[int]:
    poller = select.poll()
    poller.register(stop_fd, select.POLLIN)
    link_fd = link.fileno()
    for fd in (link_fd, keys.fd if keys is not None and keys.is_open else None):
        if fd is not None:
            poller.register(fd, select.POLLIN)
    return {fd for fd, _ in poller.poll(1e3 * min(link.wake_s(), LONGEST_WAIT_S))}
