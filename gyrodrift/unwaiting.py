"""Writing to a descriptor that others gave, without ever waiting for whoever reads it."""

import os
import socket
import stat
import time

from gyrodrift.waiting import POLLOUT, new_poller

CAN_REFUSE_TO_WAIT = hasattr(os, "O_NONBLOCK")
"""Windows waits for a slow reader of a pipe."""

PIECE_BYTES = 512
"""What a pipe that polls as writable takes at once, by POSIX; of a terminal that is only known of one byte."""


def send_unwaiting(fd: int, data: bytes) -> int:
    """Write what the reader takes at once; the number of bytes, 0 where it takes none.

    A pipe or a terminal is opened anew for each piece, since not to wait is a property of an open file that other
    programs share. Where that is not allowed, as after `su` or in a container with a user of its own, it is written to
    in pieces that a reader with any room takes.

    Raises
    ------
    OSError
        Where nobody will ever read it, or a disk does not take it.
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
        return _write_anew(fd, data)
    except BlockingIOError:
        return 0


def send_within(fd: int, data: bytes, patience_s: float) -> int:
    """Write what the reader takes in this time; the number of bytes. Raises OSError as `send_unwaiting` does."""
    if not CAN_REFUSE_TO_WAIT:
        return os.write(fd, data)
    poller, until_s, sent = new_poller(), time.monotonic() + patience_s, 0
    poller.register(fd, POLLOUT)
    while sent < len(data) and (left_s := until_s - time.monotonic()) > 0.0:
        if poller.poll(1e3 * left_s):
            sent += send_unwaiting(fd, data[sent:])
    return sent


def _write_anew(fd: int, data: bytes) -> int:
    try:
        own = os.open(f"/proc/self/fd/{fd}", os.O_WRONLY | os.O_NONBLOCK | os.O_NOCTTY | os.O_CLOEXEC)
    except (PermissionError, FileNotFoundError):  # the latter where there is no /proc
        return _send_a_piece(fd, data)
    try:
        return os.write(own, data)
    finally:
        os.close(own)


def _send_a_piece(fd: int, data: bytes) -> int:
    """No more than what never waits where there is room at all."""
    poller = new_poller()
    poller.register(fd, POLLOUT)
    if not poller.poll(0):
        return 0
    return os.write(fd, data[:1] if os.isatty(fd) else data[:PIECE_BYTES])
