"""Notifications for systemd: the service is ready, its loop runs, it ends (sd_notify(3)).

Each is a datagram to the socket of NOTIFY_SOCKET, sent without waiting; without that variable nothing is sent.
"""

import os
import socket
from collections.abc import MutableMapping
from contextlib import suppress

WATCHDOG_SHARE = 0.25
"""Interval of notifications as a share of the watchdog time of systemd."""


class SystemdNotify:
    """Notifies systemd. It removes the variables from the environment, so that no child notifies for the service."""

    def __init__(self, environ: MutableMapping[str, str] = os.environ) -> None:
        address = environ.pop("NOTIFY_SOCKET", "")
        pid, usec = environ.pop("WATCHDOG_PID", ""), environ.pop("WATCHDOG_USEC", "")
        is_ours = pid in ("", str(os.getpid()))
        self._every_s = WATCHDOG_SHARE * int(usec) * 1e-6 if usec.isdigit() and is_ours else float("inf")
        self._fed_s = float("-inf")
        self._socket: socket.socket | None = None
        if address:
            self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC)
            self._socket.setblocking(False)
            self._address = f"\0{address[1:]}" if address.startswith("@") else address

    def ready(self, status: str) -> None:
        """Report that the service is ready."""
        self._send(f"READY=1\nSTATUS={status}")

    def alive(self, now_s: float) -> None:
        """Report a turn of the loop; `now_s` is on the monotonic clock."""
        if now_s - self._fed_s >= self._every_s:
            self._fed_s = now_s
            self._send("WATCHDOG=1")

    def stopping(self) -> None:
        """Report that the service ends."""
        self._send("STOPPING=1")
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def _send(self, text: str) -> None:
        if self._socket is not None:
            with suppress(OSError):  # the manager may not listen
                self._socket.sendto(text.encode(), self._address)
