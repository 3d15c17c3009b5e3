"""Serial lines, and ptys that another program opens like one, written without waiting."""

import asyncio
import errno
import fcntl
import os
import pty
import termios
import tty
from pathlib import Path

from gyrodrift.outputs.output import OutputError

PTYS = Path("/dev/pts")


class PtyWriter:
    """A pty behind a symbolic link; `sent` and `dropped` count messages.

    The kernel buffers 4 KiB for a reader. A full buffer is dropped as a whole, since it is older than the new message.
    It is unknown how much of it was read, so it counts as sent.
    """

    def __init__(self) -> None:
        self.sent = 0
        self.dropped = 0
        self._link: Path | None = None
        self._ours = self._theirs = -1

    def open(self, link: Path) -> str:
        """Make the pty and the link to it; returns the link.

        Raises
        ------
        OutputError
            If the path exists and is no link to a pty, or the folder is not writable.
        """
        if (link.exists() or link.is_symlink()) and not _was_left_behind(link):
            raise OutputError(f"{link} exists and is no link to a pty; choose another with path=")
        try:
            self._ours, self._theirs = pty.openpty()
            tty.setraw(self._theirs)
            os.set_blocking(self._ours, False)
            link.unlink(missing_ok=True)
            link.symlink_to(os.ttyname(self._theirs))
        except OSError as error:
            self.close()
            raise OutputError(f"cannot make a pty at {link}: {error.strerror or error}") from error
        self._link = link
        asyncio.get_running_loop().add_reader(self._ours, self._pass_by)
        return str(link)

    def send(self, content: bytes, messages: int = 1) -> None:
        """Write messages; for a slow reader the unread buffer is dropped."""
        if self._ours < 0:
            return
        if self._write(content):
            self.sent += messages
            return
        termios.tcflush(self._theirs, termios.TCIFLUSH)
        self.dropped += messages

    def close(self) -> None:
        """Remove the link and the pty."""
        if self._link is not None:
            asyncio.get_running_loop().remove_reader(self._ours)
            if self._link.is_symlink() and self._link.readlink() == Path(os.ttyname(self._theirs)):
                self._link.unlink()
            self._link = None
        for fd in (self._ours, self._theirs):
            if fd >= 0:
                os.close(fd)
        self._ours = self._theirs = -1

    def _write(self, content: bytes) -> bool:
        """Write; whether all bytes were taken."""
        try:
            return os.write(self._ours, content) == len(content)
        except BlockingIOError:
            return False

    def _pass_by(self) -> None:
        """Discard input from the reader."""
        try:
            os.read(self._ours, 4096)
        except OSError as error:
            if error.errno not in {errno.EAGAIN, errno.EIO}:
                raise


def _was_left_behind(link: Path) -> bool:
    """Whether a link is one of `open`; other links are not replaced."""
    return link.is_symlink() and link.readlink().parent == PTYS


class SerialLine:
    """A serial line; messages that do not fit are dropped whole. `sent` and `dropped` count messages."""

    def __init__(self) -> None:
        self.sent = 0
        self.dropped = 0
        self._fd: int | None = None
        self._rest = b""

    def open(self, path: str, baud: int) -> None:
        """Open a line raw, with 8 data bits, no parity and one stop bit, for this process alone.

        Raises
        ------
        OutputError
            If there is no such line, another program has it, or it does not support the rate.
        """
        speed = getattr(termios, f"B{baud}", None)
        if speed is None:
            raise OutputError(f"{path}: {baud} baud is no standard rate; usual rates are 57600, 115200 and 921600")
        try:
            self._fd = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
            fcntl.flock(self._fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
            tty.setraw(self._fd)
            mode = termios.tcgetattr(self._fd)
            mode[2] |= termios.CLOCAL
            mode[4] = mode[5] = speed
            termios.tcsetattr(self._fd, termios.TCSANOW, mode)
        except BlockingIOError as error:
            raise OutputError(f"{path}: another program has it open") from error
        except termios.error as error:
            raise OutputError(f"{path}: is no serial line, or refuses {baud} baud: {error.args[-1]}") from error
        except OSError as error:
            raise OutputError(f"{path}: {error.strerror or error}") from error

    def send(self, content: bytes) -> None:
        """Write one message, or nothing.

        Raises
        ------
        OutputError
            If the line is gone.
        """
        self._rest = self._rest[self._write(self._rest) :]
        written = 0 if self._rest else self._write(content)
        if not written:
            self.dropped += 1
            return
        self._rest = content[written:]
        self.sent += 1

    def close(self) -> None:
        """Close the line."""
        if self._fd is not None:
            os.close(self._fd)
            self._fd = None

    def _write(self, content: bytes) -> int:
        if self._fd is None or not content:
            return 0
        try:
            return os.write(self._fd, content)
        except BlockingIOError:
            return 0
        except OSError as error:
            raise OutputError(f"the serial line is gone: {error.strerror}") from error
