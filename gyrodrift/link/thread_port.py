"""A serial port that a thread reads through pyserial alone, for systems without termios, such as Windows."""

import threading
import time
from contextlib import suppress

from gyrodrift.link.inbox import Inbox
from gyrodrift.link.port import PortGoneError, open_serial
from gyrodrift.link.sources.source import SourcePort

WAIT_S = 0.1
"""Longest wait of one read, s; the thread notices within this time that the port is being closed."""

LONGEST_KEPT_BYTES = 1 << 20
"""With more than this waiting for the loop, the thread stops reading, and the driver drops bytes."""

JOIN_S = 2.0


class ThreadPort(SourcePort):
    """Open port with exclusive use of its device."""

    has_line_rate = True

    def __init__(self, path: str, baud: int) -> None:
        self._serial = open_serial(path, baud)
        self._serial.timeout = WAIT_S
        self._serial.write_timeout = 0
        self._inbox = Inbox()
        super().__init__(path, self._inbox.fd)
        self._is_closed = False
        self._thread = threading.Thread(target=self._run, name=f"read {path}", daemon=True)
        self._thread.start()

    def read(self) -> bytes:
        """All that has arrived, without waiting."""
        chunk = self._inbox.take()
        if not chunk and self._inbox.is_over:
            raise PortGoneError(self.path)
        return chunk

    def write(self, content: bytes) -> int:
        """Send without waiting; the number of bytes that the driver took."""
        try:
            return self._serial.write(content) or 0
        except OSError:  # SerialException is an OSError
            return 0

    def set_baud(self, baud: int) -> None:
        """Change the line rate and drop the bytes that came at the old rate."""
        try:
            self._serial.baudrate = baud
            self._serial.reset_input_buffer()
        except (OSError, ValueError) as error:
            raise PortGoneError(self.path) from error
        self._inbox.take()

    def close(self) -> None:
        """Close, whatever state the device is in."""
        self._is_closed = True
        with suppress(OSError, AttributeError):  # not every system can cancel a read
            self._serial.cancel_read()
        self._thread.join(JOIN_S)
        with suppress(OSError):
            self._serial.close()
        self._inbox.close()

    def _run(self) -> None:
        with suppress(OSError, TypeError):  # unplugged; pyserial raises TypeError during a close
            while not self._is_closed:
                self._take_one_read()
        self._inbox.end()

    def _take_one_read(self) -> None:
        chunk = self._serial.read(max(1, self._serial.in_waiting))
        if not chunk:
            return
        self._inbox.put(chunk)
        while len(self._inbox) > LONGEST_KEPT_BYTES and not self._is_closed:
            time.sleep(WAIT_S)
