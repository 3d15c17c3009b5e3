"""The loop of `gyrodrift top`: asks the service for its status, reads keys, and draws."""

import os
import select
import sys
import termios
import time
import tty
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from math import nan
from pathlib import Path

from rich.console import Console
from rich.live import Live

from gyrodrift.outputs.status import ServiceStatus
from gyrodrift.service.control_client import ControlClient
from gyrodrift.top.view import YawPoint, draw, state_of
from gyrodrift.values.errors import UsageError

EVERY_S = 0.25
PATIENCE_S = 3.0
KEPT_POINTS = 1200
"""Five minutes of yaw."""


class Watch:
    """Status of a running service. It waits for a service that has gone away."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._service: ControlClient | None = ControlClient(path, PATIENCE_S)
        self.status = ServiceStatus()
        self.points: deque[YawPoint] = deque(maxlen=KEPT_POINTS)
        self.note = ""
        self.is_paused = False
        self.is_over = False

    def ask(self) -> None:
        """Update the status."""
        answer = self._ask("status")
        if answer is not None and not self.is_paused:
            del answer["ok"]
            self.status = ServiceStatus.from_dict(answer)
            now, sigma_deg = self.status.filter, self.status.filter.yaw_sigma_deg
            self.points.append(YawPoint(time.monotonic(), now.yaw_deg, nan if sigma_deg is None else sigma_deg))

    def type(self, keys: str) -> None:
        """Carry out keys; an empty text means that the terminal is gone."""
        self.is_over = not keys
        for key in keys:
            self.press(key)

    def press(self, key: str) -> None:
        """Carry out a key."""
        match key:
            case "q" | "\x03" | "\x04":
                self.is_over = True
            case "p":
                self.is_paused = not self.is_paused
                self.note = "paused" if self.is_paused else ""
            case "z" if self._ask("zero") is not None:
                self.points.clear()
                self.note = "yaw is 0"

    def close(self) -> None:
        """Close the connection."""
        if self._service is not None:
            self._service.close()
            self._service = None

    def _ask(self, command: str) -> dict[str, object] | None:
        """Answer of the service; None while it is away."""
        try:
            if self._service is None:
                self._service = ControlClient(self._path, PATIENCE_S)
                self.note = ""
            return self._service.ask(command)
        except UsageError as error:
            self.close()
            self.note = f"waiting: {error}"
            return None


def show(path: Path) -> None:
    """Show a service until a key ends it. Without a terminal print it once.

    Raises
    ------
    UsageError
        If there is no service.
    """
    console, watch = Console(), Watch(path)
    try:
        watch.ask()
        if not (console.is_terminal and sys.stdin.isatty()):
            console.print(state_of(watch.status))
            return
        with _keys() as fd, Live(console=console, screen=True, auto_refresh=False) as live:
            while not watch.is_over:
                live.update(draw(watch.status, watch.points, watch.note, console.size), refresh=True)
                if select.select([fd], [], [], EVERY_S)[0]:
                    watch.type(_typed(fd))
                watch.ask()
    except (OSError, termios.error):
        return  # the terminal is gone
    finally:
        watch.close()


@contextmanager
def _keys() -> Iterator[int]:
    """Standard input without line editing: each key comes as it is pressed."""
    fd = sys.stdin.fileno()
    before = termios.tcgetattr(fd)
    tty.setcbreak(fd)
    try:
        yield fd
    finally:
        termios.tcsetattr(fd, termios.TCSADRAIN, before)


def _typed(fd: int) -> str:
    try:
        return os.read(fd, 64).decode(errors="replace")
    except OSError:  # the terminal was closed
        return ""
