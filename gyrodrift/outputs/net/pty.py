"""A pty that another program opens as if it were a serial port, never waiting for that program."""

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
    """A pty behind a symbolic link; `sent` and `dropped` count what the kernel took and what not.

    The kernel keeps 4 KiB for a reader. Where that is full, all of it is dropped: it is older than what comes. Nobody
    knows how much of it was read, so it stays with what was sent.
    """

    def __init__(self) -> None:
        self.sent = 0
        self.dropped = 0
        self._link: Path | None = None
        self._ours = self._theirs = -1

    def open(self, link: Path) -> str:
        """Make the pty and the link to it; gives the link.

        Raises
        ------
        OutputError
            Where something lies there that is no link to a pty, or the folder does not take it.
        """
        if (link.exists() or link.is_symlink()) and not _was_left_behind(link):
            raise OutputError(f"{link} is there and is no link to a pty; give another with path=")
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
        """Write messages; where the reader is too slow, what it has not read goes first."""
        if self._ours < 0:
            return
        if self._write(content):
            self.sent += messages
            return
        termios.tcflush(self._theirs, termios.TCIFLUSH)
        self.dropped += messages

    def close(self) -> None:
        """Take the link away, and the pty with it."""
        if self._link is not None:
            asyncio.get_running_loop().remove_reader(self._ours)
            if self._link.is_symlink() and self._link.readlink() == Path(os.ttyname(self._theirs)):
                self._link.unlink()
            self._link = None
        for each in (self._ours, self._theirs):
            if each >= 0:
                os.close(each)
        self._ours = self._theirs = -1

    def _write(self, content: bytes) -> bool:
        """Whether all of it was taken."""
        try:
            return os.write(self._ours, content) == len(content)
        except BlockingIOError:
            return False

    def _pass_by(self) -> None:
        """What the reader writes is for a receiver, and there is none."""
        try:
            os.read(self._ours, 4096)
        except OSError as error:
            if error.errno not in {errno.EAGAIN, errno.EIO}:
                raise


def _was_left_behind(link: Path) -> bool:
    """It is a link as `open` makes one; links that the system or a person made stay."""
    return link.is_symlink() and link.readlink().parent == PTYS
