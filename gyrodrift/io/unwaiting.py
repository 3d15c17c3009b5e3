"""Write to a shared file descriptor without waiting for its reader."""

import os
import socket
import stat
import time

from gyrodrift.io.waiting import POLLOUT, new_poller

CAN_REFUSE_TO_WAIT = hasattr(os, "O_NONBLOCK")
"""Windows waits for a slow reader of a pipe."""

PIECE_BYTES = 512
"""Bytes that a writable pipe takes at once (POSIX); a terminal guarantees one byte only."""


def send_unwaiting(fd: int, data: bytes) -> int:
    """Write as much as the reader takes at once, and return the number of bytes.

    O_NONBLOCK belongs to the open file, which other programs share, so a pipe or a terminal is opened again for every
    write. If that is not allowed (after `su`, or in a container), small pieces are written instead, which never block.

    Raises
    ------
    OSError
        The reader is gone, or the disk is full.
    """
    if not CAN_REFUSE_TO_WAIT:
        return os.write(fd, data)
    mode = os.fstat(fd).st_mode
    try:
        if stat.S_ISSOCK(mode):
            with socket.socket(fileno=os.dup(fd)) as end:
                return end.send(data, socket.MSG_DONTWAIT)
        if stat.S_ISREG(mode):
            return os.write(fd, data)
        return _write_reopened(fd, data)
    except BlockingIOError:
        return 0


def send_within(fd: int, data: bytes, patience_s: float) -> int:
    """Write as much as the reader takes within a time, and return the number of bytes; raises as `send_unwaiting`."""
    if not CAN_REFUSE_TO_WAIT:
        return os.write(fd, data)
    poller, until_s, sent = new_poller(), time.monotonic() + patience_s, 0
    poller.register(fd, POLLOUT)
    while sent < len(data) and (remaining_s := until_s - time.monotonic()) > 0.0:
        if poller.poll(1e3 * remaining_s):
            sent += send_unwaiting(fd, data[sent:])
    return sent


def _write_reopened(fd: int, data: bytes) -> int:
    try:
        own = os.open(f"/proc/self/fd/{fd}", os.O_WRONLY | os.O_NONBLOCK | os.O_NOCTTY | os.O_CLOEXEC)
    except (PermissionError, FileNotFoundError):  # FileNotFoundError without /proc
        return _send_a_piece(fd, data)
    try:
        return os.write(own, data)
    finally:
        os.close(own)


def _send_a_piece(fd: int, data: bytes) -> int:
    """Write a piece that never blocks if the reader has any space."""
    poller = new_poller()
    poller.register(fd, POLLOUT)
    if not poller.poll(0):
        return 0
    return os.write(fd, data[:1] if os.isatty(fd) else data[:PIECE_BYTES])
