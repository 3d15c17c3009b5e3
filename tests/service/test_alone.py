"""Several gyros in one loop: whatever fails in one of them ends it alone, with its name; a signal ends the start."""

import os
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any, cast

import pytest
import structlog

from gyrodrift.service.listener import ReaderGoneError
from gyrodrift.service.loop import Service, Waiting
from gyrodrift.service.several import SeveralServices
from gyrodrift.service.signals import StopSignal


@dataclass
class Gyro:
    """A service that fails in one place, or is over after ten turns."""

    name: str
    fails_in: str = ""
    error: Exception = field(default_factory=lambda: OSError(5, "Input/output error"))
    turns: int = 0
    ended: int = 0
    shares: int = 0

    @property
    def log(self) -> Any:
        return structlog.get_logger().bind(source=self.name)

    @property
    def link(self) -> Any:
        return SimpleNamespace(name=self.name, share_turn=self.share)

    @property
    def is_over(self) -> bool:
        return self.turns >= 10

    def share(self, sources: int) -> None:
        self.shares = sources

    def work(self, place: str) -> None:
        if place == self.fails_in:
            raise self.error

    def begin(self) -> None:
        self.work("begin")

    def end(self) -> None:
        self.ended += 1
        self.work("end")

    @contextmanager
    def open_listeners(self) -> Iterator[None]:
        yield
        self.work("close")

    def descriptors(self) -> dict[int, int]:
        self.work("descriptors")
        return {}

    def wake_s(self) -> float:
        return 0.0

    def turn(self, _ready: set[int]) -> None:
        self.work("turn")
        self.turns += 1


@pytest.mark.promise("Samples", "any error of one of several sources ends this source alone, and the log names it")
@pytest.mark.parametrize("place", ["begin", "descriptors", "turn", "close", "end"])
@pytest.mark.parametrize("error", [OSError(21, "Is a directory"), ValueError("x"), MemoryError(), RecursionError()])
def test_whatever_fails_in_a_source_ends_it_alone(place: str, error: Exception) -> None:
    left, right = Gyro("left", place, error), Gyro("right")
    with StopSignal() as stop, structlog.testing.capture_logs() as logged:
        services = cast("list[Service]", [left, right])
        status = SeveralServices(services, structlog.get_logger(), stop).run()
    assert (right.turns, right.ended, right.shares) == (10, 1, 2)
    assert left.ended == (0 if place == "begin" else 1)
    assert status == 3
    (failed,) = [line for line in logged if line["event"] == "source_failed"]
    assert failed["source"] == "left"
    assert failed["reason"].startswith(f"{type(error).__name__}: ")


def test_a_reader_that_is_gone_is_no_failure() -> None:
    left, right = Gyro("left", "turn", cast("Exception", ReaderGoneError())), Gyro("right")
    with StopSignal() as stop:
        services = cast("list[Service]", [left, right])
        assert SeveralServices(services, structlog.get_logger(), stop).run() == 0
    assert right.turns == 10


def test_the_loop_sleeps_until_a_source_is_due(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each source says after every turn when it wants the next one."""
    waits: list[float] = []

    def ready(_: Waiting, _events: dict[int, int], most_s: float) -> set[int]:
        waits.append(most_s)
        time.sleep(most_s)
        return set()

    monkeypatch.setattr(Waiting, "ready", ready)
    monkeypatch.setattr(Gyro, "wake_s", lambda _: 0.02)
    with StopSignal() as stop:
        services = cast("list[Service]", [Gyro("left"), Gyro("right")])
        assert SeveralServices(services, structlog.get_logger(), stop).run() == 0
    assert waits[0] == 0.0
    assert all(0.0 <= wait <= 0.02 for wait in waits)
    assert sum(wait > 0.0 for wait in waits) >= 8


@pytest.mark.promise("Memory and the end")
def test_a_signal_ends_the_first_connection() -> None:
    """SIGTERM ends `serve` and `record` at once while the first connection is made, or a file is read."""
    is_reached = False
    with StopSignal() as stop:
        with stop.at_once():
            threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGTERM)).start()
            threading.Event().wait(60.0)
        is_reached = True
    assert stop.is_set
    assert not is_reached
    with StopSignal() as stop:
        os.kill(os.getpid(), signal.SIGTERM)
        assert stop.is_set, "outside, a signal only sets the mark"
        with stop.at_once():
            is_reached = True
    assert not is_reached
