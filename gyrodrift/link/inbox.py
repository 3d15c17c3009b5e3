"""Bytes that a thread has read, for a loop that waits for a descriptor.

Windows cannot wait for a serial port and a socket at once, and a library may read in a thread of its own. The thread
therefore wakes the loop through a socket.
"""

import socket
import threading
from contextlib import suppress


class Inbox:
    """Bytes between a thread and the loop.

    fd
        Descriptor that becomes readable when bytes arrive, or when the thread has ended.
    is_over
        Whether the thread has ended.
    """

    def __init__(self) -> None:
        self._wake, self._waker = socket.socketpair()
        self._wake.setblocking(False)
        self._waker.setblocking(False)
        self.fd = self._wake.fileno()
        self.is_over = False
        self._arrived = bytearray()
        self._lock = threading.Lock()

    def __len__(self) -> int:
        return len(self._arrived)

    def put(self, content: bytes) -> None:
        """Add bytes, in the thread."""
        with self._lock:
            self._arrived += content
        self._tell()

    def end(self) -> None:
        """End, in the thread."""
        self.is_over = True
        self._tell()

    def take(self) -> bytes:
        """All bytes, without waiting."""
        with suppress(BlockingIOError):
            while self._wake.recv(4096):
                pass
        with self._lock:
            content = bytes(self._arrived)
            self._arrived.clear()
        return content

    def close(self) -> None:
        """Close the descriptors."""
        self._wake.close()
        self._waker.close()

    def _tell(self) -> None:
        with suppress(OSError):  # full of wake-ups already, or closed
            self._waker.send(b"\0")
