"""The loop of `gyrodrift top`: asks the service a few times a second, listens to keys, draws."""

import os
import select
import sys
import termios
import tty
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console
from rich.live import Live

from gyrodrift.errors import UsageError
from gyrodrift.outputs.status import ServiceStatus
from gyrodrift.service.control_client import ControlClient
from gyrodrift.top.view import draw

EVERY_S = 0.25
PATIENCE_S = 3.0
SPARKS = 60


class Watch:
    """A running service, asked for its status; one that went away is waited for."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._service: ControlClient | None = ControlClient(path, PATIENCE_S)
        self.status = ServiceStatus()
        self.yaws_deg: deque[float] = deque(maxlen=SPARKS)
        self.note = ""
        self.is_paused = False
        self.is_over = False

    def ask(self) -> None:
        """Take the status of now."""
        answer = self._ask("status")
        if answer is not None and not self.is_paused:
            del answer["ok"]
            self.status = ServiceStatus.from_dict(answer)
            self.yaws_deg.append(self.status.filter.yaw_deg)

    def type(self, keys: str) -> None:
        """Do what keys stand for; none at all comes from a terminal that is gone."""
        self.is_over = not keys
        for key in keys:
            self.press(key)

    def press(self, key: str) -> None:
        """Do what a key stands for."""
        match key:
            case "q" | "\x03" | "\x04":
                self.is_over = True
            case "p":
                self.is_paused = not self.is_paused
                self.note = "paused" if self.is_paused else ""
            case "z" if self._ask("zero") is not None:
                self.note = "yaw is 0"

    def close(self) -> None:
        """Let go of the service."""
        if self._service is not None:
            self._service.close()
            self._service = None

    def _ask(self, command: str) -> dict[str, object] | None:
        """The answer; None while the service is away."""
        try:
            if self._service is None:
                self._service = ControlClient(self._path, PATIENCE_S)
                self.note = ""
            return self._service.ask(command)
        except UsageError as error:
            self.close()
            self.note = f"{error}; waiting"
            return None


def show(path: Path) -> None:
    """Show a service until a key ends it; once, where nobody sits at a terminal.

    Raises
    ------
    UsageError
        Where there is no service.
    """
    console, watch = Console(), Watch(path)
    try:
        watch.ask()
        if not (console.is_terminal and sys.stdin.isatty()):
            console.print(draw(watch.status, watch.yaws_deg))
            return
        with _keys() as fd, Live(console=console, screen=True, auto_refresh=False) as live:
            while not watch.is_over:
                live.update(draw(watch.status, watch.yaws_deg, watch.note), refresh=True)
                if select.select([fd], [], [], EVERY_S)[0]:
                    watch.type(_typed(fd))
                watch.ask()
    except (OSError, termios.error):
        return  # the terminal is gone
    finally:
        watch.close()


@contextmanager
def _keys() -> Iterator[int]:
    """Standard input, each key as it is pressed."""
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
