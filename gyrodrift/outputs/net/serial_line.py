"""A serial line or pty, written without waiting; messages that do not fit are dropped whole, and counted."""

import fcntl
import os
import termios
import tty

from gyrodrift.outputs.output import OutputError


class SerialLine:
    """Writes messages; `sent` and `dropped` count them. It reads nothing."""

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
