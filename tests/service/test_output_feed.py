"""The way to the outputs' process: nothing waits for it, whether it starts, is stopped, dies or has to go."""

import os
import signal
import socket
import subprocess
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
import structlog
from outputs_support import address_of, connected, corrected, csv_at_100_hz, events, serving
from support import PATIENCE_S, Command, free_port, never

from gyrodrift.config.outputs import output_of
from gyrodrift.outputs import wire
from gyrodrift.outputs.status import ServiceStatus
from gyrodrift.service import output_feed
from gyrodrift.service.control_client import ControlClient
from gyrodrift.service.output_feed import OutputFeed

RELOADS = 6
TCP = output_of("tcp:port=0")
HDR = "hdr: {i_c_dps: 1e-3, tau_s: .5, theta_w_dps: 1, c1: 0, c2: 1}\n"


@dataclass
class Fed:
    """A feed on a clock that the test moves; its process is a real one."""

    now_s: float = 100.0
    feed: OutputFeed = field(init=False)

    def __post_init__(self) -> None:
        self.feed = OutputFeed(structlog.get_logger(), "error", "json", lambda: self.now_s)
        self.feed.state = ServiceStatus

    def until(self, is_so: Callable[[], bool], step_s: float = 0.0) -> None:
        """Let the loop come round until something is so."""
        until_s = time.monotonic() + PATIENCE_S
        while not is_so():
            assert time.monotonic() < until_s
            self.now_s += step_s
            self.feed.tick(self.now_s)
            time.sleep(0.01)

    def opened(self) -> None:
        """Once the outputs are open."""
        self.until(lambda: all(statuse.address for statuse in self.feed.statuses()))

    def stopped(self) -> int:
        """The process, which does nothing any more."""
        pid = self.feed.pid
        assert pid is not None
        os.kill(pid, signal.SIGSTOP)
        return pid


@pytest.fixture
def fed() -> Iterator[Fed]:
    fed = Fed()
    yield fed
    fed.feed.finish()
    fed.now_s += 2.0 * output_feed.END_S
    fed.feed.close()


def test_a_stopped_process_that_has_to_go_is_left_alone_and_killed_when_its_time_is_over(fed: Fed) -> None:
    fed.feed.want([TCP])
    fed.opened()
    pid = fed.stopped()
    fed.feed.want([])
    fed.feed.want([TCP])
    for _ in range(10):
        fed.feed.tick(fed.now_s)
    assert fed.feed.pid == pid
    fed.until(lambda: fed.feed.pid != pid, step_s=0.25)
    fed.opened()
    assert fed.feed.pid not in {None, pid}


def test_a_process_that_is_not_wanted_any_more_ends_by_itself(fed: Fed, logged: list[Any]) -> None:
    fed.feed.want([TCP])
    fed.opened()
    fed.feed.want([])
    fed.until(lambda: fed.feed.pid is None)
    assert [item["event"] for item in logged] == []


@pytest.mark.promise("Samples")
def test_what_waits_for_a_stopped_process_is_bounded(fed: Fed, monkeypatch: pytest.MonkeyPatch) -> None:
    """Data that waits for a stopped output process is bounded, and costs no sample."""
    monkeypatch.setattr(output_feed, "LONGEST_QUEUE_BYTES", 100_000)
    fed.feed.want([TCP])
    fed.opened()
    pid = fed.stopped()
    for number in range(20_000):
        fed.feed.take([corrected(number)])
        fed.feed.hear("gap", {"missing": number})
        if number % 100 == 0:
            fed.feed.want([TCP, output_of(f"tcp:port=0,rate_hz={1 + number}")])
            fed.now_s += 1.0
            fed.feed.tick(fed.now_s)
    assert fed.feed._queue_bytes == sum(map(len, fed.feed._queue)) <= 100_000
    assert fed.feed.dropped > 0
    os.kill(pid, signal.SIGCONT)
    fed.opened()
    assert fed.feed.statuses()[1].output == "tcp:port=0,rate_hz=19901.0"


def test_what_is_dropped_is_counted_in_samples(fed: Fed, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(output_feed, "LONGEST_QUEUE_BYTES", 100_000)
    fed.feed.want([TCP])
    fed.opened()
    with monkeypatch.context() as patched:
        patched.setattr(fed.feed, "_hand_over", lambda _message: False)
        for first in range(0, 20_000, 50):
            fed.feed.take([corrected(number) for number in range(first, first + 50)])
        waiting = [message for message in fed.feed._queue if message[:1] == wire.SAMPLES]
        assert fed.feed.dropped > 0
        assert fed.feed.dropped + sum((len(item) - 1) // wire.RECORD.size for item in waiting) == 20_000


@pytest.mark.promise("Samples")
def test_a_process_that_cannot_be_started_is_told_and_tried_again(
    fed: Fed, monkeypatch: pytest.MonkeyPatch, logged: list[Any]
) -> None:
    """An output process that cannot be started is logged and tried again, and costs no sample."""

    def refuse(*_: object, **__: object) -> None:
        raise OSError(11, "Resource temporarily unavailable")

    with monkeypatch.context() as patched:
        patched.setattr(subprocess, "Popen", refuse)
        fed.feed.want([TCP])
    assert [(item["event"], item["reason"]) for item in logged] == [
        ("outputs_not_started", "Resource temporarily unavailable")
    ]
    fed.until(lambda: fed.feed.pid is not None, step_s=0.25)
    fed.opened()


def children(serve: Command) -> list[int]:
    return [int(item) for item in _children_of(serve.process.pid).read_text().split()]


def _children_of(pid: int) -> Path:
    return Path(f"/proc/{pid}/task/{pid}/children")


@pytest.mark.promise("Samples")
def test_a_reload_that_removes_the_last_output_waits_for_nobody(port: Path, tmp_path: Path) -> None:
    """A reload that removes the last output costs no sample."""
    config = tmp_path / "c.yaml"
    with_output = f"{HDR}outputs: [{{name: tcp, port: 0}}]\n"
    config.write_text(with_output)
    with serving(port, "--config", config) as (serve, device):
        with connected(address_of(serve, "tcp")) as silent:
            silent.until("HELLO")
            (child,) = children(serve)
            os.kill(child, signal.SIGSTOP)
            config.write_text(HDR)
            serve.until_log("config_applied")
            device.send_all(csv_at_100_hz(201), never)
            assert [line["seq"] for line in serve.take_lines(200)] == list(range(200))
            config.write_text(with_output)
            serve.until(lambda it: len(events(it, "output_open", "tcp")) == 2, "the output again")
            assert child not in children(serve)
        assert serve.stop() == 0


@pytest.mark.promise("Memory and the end")
def test_a_stopped_process_of_outputs_does_not_hold_up_the_end(port: Path) -> None:
    """A stopped output process does not delay the end."""
    with serving(port, "--output", "tcp:port=0") as (serve, device):
        address_of(serve, "tcp")
        device.send_all(csv_at_100_hz(101), never)
        serve.take_lines(100)
        (child,) = children(serve)
        os.kill(child, signal.SIGSTOP)
        assert serve.stop() == 0
        assert not Path(f"/proc/{child}").exists()


def test_quick_reloads_leave_the_outputs_of_the_last_config(port: Path, tmp_path: Path) -> None:
    """Kinds that take turns on two ports, none in between; every line is there."""
    config, control, ports = tmp_path / "c.yaml", tmp_path / "control", (free_port(), free_port())
    config.write_text(HDR)
    with serving(port, "--config", config, "--control", control) as (serve, device):
        serve.until(lambda _: control.exists(), "control socket")
        with ControlClient(control, PATIENCE_S) as client:
            for number in range(RELOADS):
                config.write_text(HDR + "outputs: [" + ", ".join(_some_outputs(number, ports)) + "]\n")
                assert client.ask("reload")["ok"]
                device.send_all(csv_at_100_hz(10, first=10 * number), never)
            expected = [f"foxglove:port={ports[1]}"]
            config.write_text(f"{HDR}outputs: [{{name: foxglove, port: {ports[1]}}}]\n")
            client.ask("reload")
            serve.until(lambda _: opened(client) == expected, "the last outputs")
            device.send_all(csv_at_100_hz(10, first=10 * RELOADS), never)
            assert [line["seq"] for line in serve.take_lines(10 * RELOADS)] == list(range(10 * RELOADS))
        assert is_listened_on(ports[1])
        serve.until(lambda _: not is_listened_on(ports[0]), "end of the output on the first port")
        assert serve.stop() == 0


def is_listened_on(number: int) -> bool:
    with socket.socket() as trial:
        return trial.connect_ex(("127.0.0.1", number)) == 0


def _some_outputs(number: int, ports: tuple[int, int]) -> list[str]:
    kinds = ("web", "foxglove", "tcp", "rosbridge")
    count = number % 3
    return [f"{{name: {kinds[(number + i) % 4]}, port: {ports[i]}}}" for i in range(count)]


def opened(client: ControlClient) -> list[str]:
    """Outputs that the status has an address of, where it has no others."""
    outputs = client.ask("status")["outputs"]
    return [output["output"] for output in outputs] if all(output["address"] for output in outputs) else []


def test_starts_that_fail_have_growing_pauses(monkeypatch: pytest.MonkeyPatch) -> None:
    """From half a second, twice as long each time, up to half a minute."""
    fed, starts = Fed(), []

    def fail(*_: Any, **__: Any) -> None:
        starts.append(fed.now_s)
        raise OSError(12, "Cannot allocate memory")

    monkeypatch.setattr(subprocess, "Popen", fail)
    fed.feed.want([TCP])
    while len(starts) < 9:
        fed.now_s += 0.25
        fed.feed.tick(fed.now_s)
    assert [b - a for a, b in pairwise(starts)] == [0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 30.0, 30.0]
