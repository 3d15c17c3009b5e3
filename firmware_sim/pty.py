"""Device on a pty: raw mode, a stable name, readers that come and go.

It depends on the behavior of Linux ptys. A master without a reader polls as hung up. In packet mode it is notified when
a reader flushes its input, which is the last step of pyserial when it opens a port. A pty buffers about 20 kB. Closing
the master discards unread bytes.
"""

import fcntl
import os
import pty
import select
import socket
import struct
import time
import tty
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from firmware_sim.reservation import reserve

TIOCPKT = 0x5420
TIOCPKT_FLUSHREAD = 0x01
TCGETS2, TERMIOS2 = 0x802C542A, struct.Struct("4I20s2I")
"""ioctl that returns baud rates outside the list of POSIX; its last field is the baud rate."""

OPENING_S = 1.0
"""Longest wait for the flush of a new reader, s; cat and screen do not flush."""

DRAIN_S = 2.0
DRAINED_S = 0.05


class LinkInUseError(Exception):
    """The link cannot be created, or its name is taken."""


class Cable:
    """Cable between device and reader, without faults."""

    def link_at(self, link: Path, t_s: float) -> Path | None:
        """Name of the device `link` at `t_s`, s since power-on; None while it is unplugged."""
        _ = t_s
        return link

    def carry(self, content: bytes, t_s: float, read_baud: Callable[[], int]) -> bytes:
        """Bytes that a reader at `read_baud()` gets from `content`, sent at `t_s`."""
        _ = t_s, read_baud
        return content


class PtyDevice:
    """Master end of a pty whose slave is linked at `link`.

    Unread bytes wait for the next reader, as in a real port; pyserial flushes them when it opens. Every new reader gets
    `greeting`, like from a board that DTR resets; a frame that is being sent may come before it.
    """

    def __init__(self, link: Path, greeting: bytes = b"", cable: Cable | None = None) -> None:
        self.link = link
        self.greeting = greeting
        self.fd = -1
        self.slave_name = ""
        self._cable = cable or Cable()
        self._first_link = link
        self._t_s = 0.0
        self._reservation: socket.socket | None = None
        self._plug_in(self._cable.link_at(link, 0.0) or link)

    @property
    def is_plugged(self) -> bool:
        """Whether the port exists."""
        return self.fd >= 0

    def live_until(self, t_s: float) -> None:
        """Set the time to `t_s`, s since power-on: the cable may be unplugged or plugged in."""
        self._t_s = t_s
        link = self._cable.link_at(self._first_link, t_s)
        if link is None:
            self.close()
        elif not self.is_plugged:
            self._plug_in(link)

    def is_pulled_at(self, t_s: float) -> bool:
        """Whether the cable is unplugged at `t_s`."""
        return self._cable.link_at(self._first_link, t_s) is None

    def _plug_in(self, link: Path) -> None:
        fd, slave_fd = pty.openpty()
        self.link, self.slave_name = link, os.ttyname(slave_fd)
        tty.setraw(slave_fd)
        fcntl.ioctl(fd, TIOCPKT, struct.pack("i", 1))
        os.close(slave_fd)
        os.set_blocking(fd, False)
        self._poller = select.poll()
        self._poller.register(fd, select.POLLIN | select.POLLPRI)
        self._unsent = b""
        self._flushed = False
        self._opened_s: float | None = None
        try:
            self._reservation = _reserved(link)
            _make_link(self.slave_name, link)
        except LinkInUseError:
            os.close(fd)
            self._release()
            raise
        self.fd = fd

    def has_reader(self) -> bool:
        """Whether a reader has the port open; bytes from the reader are dropped."""
        if not self.is_plugged:
            return False
        for _, events in self._poller.poll(0):
            if events & select.POLLHUP:
                self._flushed = False
                self._unsent = b""
                return False
            self._listen()
        return True

    def is_ready(self) -> bool:
        """Whether a reader has finished opening the port, so that its flush does not drop new bytes."""
        if not self.has_reader():
            self._opened_s = None
            return False
        self._opened_s = self._opened_s or time.monotonic()
        return self._flushed or time.monotonic() - self._opened_s > OPENING_S

    def wait_for_reader(self, is_over: Callable[[], bool]) -> None:
        """Wait until a reader is ready."""
        while not is_over() and not self.is_ready():
            time.sleep(0.005)

    def send(self, content: bytes) -> bool:
        """Send all bytes, or none if the reader is slow or missing; the rest of a started frame follows later."""
        if not self.has_reader() or not self._finish():
            return False
        self._unsent = self._carried(content)
        self._finish()
        return True

    def send_all(self, content: bytes, is_over: Callable[[], bool]) -> bool:
        """Send all bytes at the pace of the reader; False without a ready reader, or if it leaves."""
        if not self.is_ready():
            return False
        self._unsent += self._carried(content)
        out = select.poll()
        out.register(self.fd, select.POLLOUT)
        while not is_over() and self.has_reader():
            if self._finish():
                return True
            out.poll(100)
        return False

    def drain(self, is_over: Callable[[], bool] | None = None) -> None:
        """Wait until the reader has read everything, has left, or `is_over` (default: DRAIN_S have passed)."""
        until_s = time.monotonic() + DRAIN_S
        is_over = is_over or (lambda: time.monotonic() >= until_s)
        empty_s: float | None = None
        while not is_over() and self.has_reader():
            if self._finish() and self._reader_is_done():
                empty_s = empty_s or time.monotonic()
                if time.monotonic() - empty_s > DRAINED_S:
                    return
            else:
                empty_s = None
            time.sleep(0.005)

    def close(self) -> None:
        """Close the pty and remove the link."""
        if not self.is_plugged:
            return
        with suppress(OSError):
            if self.link.is_symlink() and str(self.link.readlink()) == self.slave_name:
                self.link.unlink()
        self._release()
        os.close(self.fd)
        self.fd = -1

    def _release(self) -> None:
        """Let other devices have the link."""
        if self._reservation is not None:
            self._reservation.close()
            self._reservation = None

    def _carried(self, content: bytes) -> bytes:
        return self._cable.carry(content, self._t_s, lambda: _line_rate(self.fd))

    def _finish(self) -> bool:
        """Send the rest, and return whether everything is sent."""
        while self._unsent:
            try:
                sent = os.write(self.fd, self._unsent)
            except (BlockingIOError, OSError):
                return False
            self._unsent = self._unsent[sent:]
        return True

    def _listen(self) -> None:
        with suppress(OSError):
            heard = os.read(self.fd, 4096)
            if heard and heard[0] & TIOCPKT_FLUSHREAD:
                self._flushed = True
                self._unsent = (
                    self._carried(self.greeting) + self._unsent
                )  # an incomplete frame before it counts as damaged

    def _reader_is_done(self) -> bool:
        """Whether nothing waits for the reader; a poll also sees bytes on their way to the port."""
        try:
            fd = os.open(self.slave_name, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        except OSError:
            return True
        try:
            return not select.select([fd], [], [], 0.0)[0]
        finally:
            os.close(fd)


def _line_rate(fd: int) -> int:
    """Baud rate that the reader has set, standard or not."""
    termios2 = fcntl.ioctl(fd, TCGETS2, bytes(TERMIOS2.size))
    return int(TERMIOS2.unpack(termios2)[-1])


def _reserved(link: Path) -> socket.socket:
    """Reservation of the link until it is closed."""
    reservation = reserve(link)
    if reservation is None:
        raise LinkInUseError(
            f"{link} belongs to a simulated device that is running; choose another --link or stop that device"
        )
    return reservation


def _make_link(target: str, link: Path) -> None:
    """Point the link at the pty in one step, so that readers never miss it."""
    fresh = link.with_name(f".{link.name}.{os.getpid()}")
    try:
        if os.path.lexists(link) and not (link.is_symlink() and str(link.readlink()).startswith("/dev/pts/")):
            raise LinkInUseError(f"{link} exists and is not a link to a pty; choose another name")
        link.parent.mkdir(parents=True, exist_ok=True)
        fresh.symlink_to(target)
        fresh.replace(link)
    except OSError as error:
        with suppress(OSError):
            fresh.unlink()
        raise LinkInUseError(f"{link} cannot be made: {error.strerror}") from error
