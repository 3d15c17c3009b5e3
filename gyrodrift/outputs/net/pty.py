"""A pty that another program opens like a serial port, written without waiting."""

import asyncio
import errno
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
