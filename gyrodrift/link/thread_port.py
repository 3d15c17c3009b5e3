"""A serial port that a thread reads through pyserial alone, for systems without termios, such as Windows.

Windows cannot wait for a serial port and a socket at once. The thread therefore wakes the loop through a socket.
"""

import socket
import threading
import time
from contextlib import suppress

from gyrodrift.link.port import Port, PortGoneError, open_serial

WAIT_S = 0.1
"""Longest wait of one read, s; the thread notices within this time that the port is being closed."""

LONGEST_KEPT_BYTES = 1 << 20
"""With more than this waiting for the loop, the thread stops reading, and the driver drops bytes."""

JOIN_S = 2.0


class ThreadPort(Port):
    """An open port; `fd` is a socket that becomes readable when bytes arrive."""

    def __init__(self, path: str, baud: int) -> None:
        self.path = path
        self.is_pty = False
        self._serial = open_serial(path, baud)
        self._serial.timeout = WAIT_S
        self._serial.write_timeout = 0
        self._arrived = bytearray()
        self._lock = threading.Lock()
        self._is_gone = self._is_closed = False
        self._wake, self._waker = socket.socketpair()
        self._wake.setblocking(False)
        self._waker.setblocking(False)
        self.fd = self._wake.fileno()
        self._thread = threading.Thread(target=self._run, name=f"read {path}", daemon=True)
        self._thread.start()

    def read(self) -> bytes:
        """All that has arrived, without waiting.

        Raises
        ------
        PortGoneError
            If the port was unplugged and everything it had before has been read.
        """
        with suppress(BlockingIOError):
            while self._wake.recv(4096):
                pass
        chunk = self._taken()
        if not chunk and self._is_gone:
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
        self._taken()

    def close(self) -> None:
        """Close, whatever state the device is in."""
        self._is_closed = True
        with suppress(OSError, AttributeError):  # not every system can cancel a read
            self._serial.cancel_read()
        self._thread.join(JOIN_S)
        with suppress(OSError):
            self._serial.close()
        self._wake.close()
        self._waker.close()

    def _taken(self) -> bytes:
        with self._lock:
            chunk = bytes(self._arrived)
            self._arrived.clear()
        return chunk

    def _run(self) -> None:
        try:
            while not self._is_closed:
                self._take_one_read()
        except (OSError, TypeError):  # unplugged; pyserial raises TypeError during a close
            self._is_gone = True
        self._tell()

    def _take_one_read(self) -> None:
        chunk = self._serial.read(max(1, self._serial.in_waiting))
        if not chunk:
            return
        with self._lock:
            self._arrived += chunk
        self._tell()
        while len(self._arrived) > LONGEST_KEPT_BYTES and not self._is_closed:
            time.sleep(WAIT_S)

    def _tell(self) -> None:
        with suppress(OSError):  # full of wake-ups already, or closed
            self._waker.send(b"\0")
