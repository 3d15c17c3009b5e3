"""Helpers for tests of `doctor`: a simulated device in the time of its reader, and findings about it."""

import argparse
import json
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from support import Command, never

from firmware_sim.command import add_arguments, device_of
from firmware_sim.pty import PtyDevice
from gyrodrift.cli import main
from gyrodrift.doctor import listen

Findings = dict[str, dict[str, Any]]

FAST = ("--speed", "40")
"""Device seconds in a second; 2 s of listening are 80 s."""

SECONDS = "2"

WAIT_S = 0.1
"""How long the command waits for a device that sends nothing."""


class DeviceInStep:
    """A simulated gyro on a pty that sends a frame each time its reader waits; time goes on to the time of the frame.

    It boots when its port is opened. A frame without a reader is lost.
    """

    def __init__(self, port: Path, *words: str | Path) -> None:
        parser = argparse.ArgumentParser()
        add_arguments(parser)
        arguments = parser.parse_args(["--link", str(port), *map(str, words)])
        made = device_of(arguments)
        self.pty = PtyDevice(port, made.greeting, made.cable)
        self.now_s = 0.0
        self._speed = arguments.speed
        self._frames = made.frames()
        self._next = next(self._frames)

    def send(self) -> None:
        """Send the next frame, or let the reader wait in vain."""
        due_s = self._next.t_s / self._speed
        if due_s > self.now_s + WAIT_S:
            self.now_s += WAIT_S
            return
        self.now_s = due_s
        self.pty.live_until(self._next.t_s)
        if self.pty.is_ready():
            assert self.pty.send_all(self._next.content, never)
        self._next = next(self._frames)


@contextmanager
def device(port: Path, *words: str | Path) -> Iterator[None]:
    """A simulated gyro that a `doctor` in this process listens to, in the time of the device."""
    gyro = DeviceInStep(port, *words)
    with closing(gyro.pty), pytest.MonkeyPatch.context() as patch:
        patch.setattr("gyrodrift.cli.doctor.listen", partial(listen.listen, monotonic=lambda: 100.0 + gyro.now_s))
        patch.setattr(listen, "_wait", lambda _: gyro.send())
        yield


@contextmanager
def running_device(port: Path, *words: str | Path) -> Iterator[None]:
    """A simulated gyro as a process, which boots when its port is opened."""
    with Command("--link", port, "--quiet", "--wait", *words, module="firmware_sim") as simulator:
        simulator.until(lambda _: port.is_symlink(), "port")
        yield


def doctor(capsys: pytest.CaptureFixture[str], *words: str | Path) -> tuple[int, Findings]:
    """Exit status and findings by id of the command, run in this process."""
    status = main(["doctor", "--json", *map(str, words)])
    statement = capsys.readouterr()
    assert statement.out, statement.err
    (line,) = statement.out.splitlines()
    about = json.loads(line)
    return status, {finding["id"]: finding for finding in about["findings"]}


def assert_findings(findings: Findings, expected: Sequence[tuple[str, str, str]]) -> None:
    """Each of (id, severity, words that it says or advises)."""
    for name, severity, words in expected:
        assert name in findings, f"{name} is not among {', '.join(findings)}"
        report = f"{findings[name]['says']} → {findings[name]['do']}"
        assert (findings[name]["severity"], words in report) == (severity, True), (
            f"{name} {findings[name]['severity']}: {report}"
        )
