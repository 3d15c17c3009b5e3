"""The open outputs are those of the last config, however quickly it has changed."""

import asyncio
import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from pathlib import Path
from random import Random
from typing import Any

import pytest
import structlog
from outputs_support import HubThread, hub
from support import PATIENCE_S, awaited, free_port

from gyrodrift.config.outputs import output_of
from gyrodrift.outputs import running
from gyrodrift.outputs.line_output import TcpOutput
from gyrodrift.outputs.options import OutputSpec
from gyrodrift.outputs.output import Output
from gyrodrift.outputs.registry import OUTPUTS
from gyrodrift.outputs.status import OutputStatus

KINDS = ("tcp", "gpsd", "web", "rosbridge", "prometheus", "foxglove", "nmea", "signalk", "networktables")
RELOADS = 1000
SEED = 1


@pytest.fixture(autouse=True)
def logged() -> Iterator[list[Any]]:
    with structlog.testing.capture_logs() as events:
        yield events


def descriptors() -> int:
    return len(list(Path("/proc/self/fd").iterdir()))


def listened_on() -> set[int]:
    """TCP ports that this process listens on; pytest has some of its own."""
    own = set(_descriptors())
    rows = [row.split() for name in ("tcp", "tcp6") for row in Path("/proc/net", name).read_text().splitlines()[1:]]
    return {int(row[1].rpartition(":")[2], 16) for row in rows if row[3] == "0A" and f"socket:[{row[9]}]" in own}


def _descriptors() -> Iterator[str]:
    for link in Path("/proc/self/fd").iterdir():
        with suppress(OSError):  # closed meanwhile
            yield str(link.readlink())


def settled(outputs: HubThread, desired: list[OutputSpec]) -> list[OutputStatus]:
    """The statuses once every wanted output is open and no other is told of."""
    names, until_s = [str(spec) for spec in desired], time.monotonic() + PATIENCE_S
    while True:
        statuses = outputs.statuses()
        if [statuse.output for statuse in statuses] == names and all(statuse.address for statuse in statuses):
            return statuses
        assert time.monotonic() < until_s, statuses


def random_config(random: Random, ports: list[int], folder: Path) -> list[OutputSpec]:
    """Some outputs, each with a port of its own; any kind may take over the port of any other."""
    chosen = [f"{random.choice(KINDS)}:port={port}" for port in ports if random.random() < 0.5]
    if random.random() < 0.3:
        chosen.append(f"unix:path={folder / random.choice('ab')}")
    return [output_of(item) for item in chosen]


@pytest.mark.promise("Recovery")
def test_after_a_thousand_random_reloads_exactly_the_last_config_is_open(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After a thousand random reloads, exactly the outputs of the last config are open."""
    random, ports, rest = Random(SEED), [free_port() for _ in range(6)], listened_on()
    with hub() as outputs, ExitStack() as clients:
        first = [output_of(f"{kind}:port={port}") for kind, port in zip(KINDS, ports, strict=False)]
        outputs.want(*first)
        settled(outputs, first)
        outputs.want()
        settled(outputs, [])
        before = until_steady(descriptors)
        for number in range(RELOADS):
            target = random_config(random, ports, tmp_path)
            outputs.want(*target)
            if random.random() < 0.2:
                outputs.statuses()  # time passes
            if number % 50 == 49:
                settled(outputs, target)
                connect_to_one(random, target, clients)
        outputs.want(*(last := random_config(random, ports, tmp_path)))
        settled(outputs, last)
        clients.close()
        expected = rest | {spec.options.port for spec in last if spec.name != "unix"}
        awaited(listened_on, lambda ports: ports == expected)
        assert {path.name for path in tmp_path.iterdir()} == {
            Path(spec.options.path).name for spec in last if spec.name == "unix"
        }
        outputs.want()
        settled(outputs, [])
        awaited(descriptors, lambda count: count == before)
        assert listened_on() == rest


def connect_to_one(random: Random, desired: list[OutputSpec], clients: ExitStack) -> None:
    """A client that never says or reads anything."""
    ports = [spec.options.port for spec in desired if spec.name != "unix"]
    if ports:
        clients.enter_context(socket.create_connection(("127.0.0.1", random.choice(ports)), PATIENCE_S))


def until_steady(measure: Any) -> Any:
    last = None
    while (now := measure()) != last:
        last = now
        time.sleep(0.3)
    return now


@pytest.mark.promise("Recovery")
def test_the_port_of_an_output_that_is_slow_to_go_is_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """An output waits for its port until the previous output has closed it."""
    closing = TcpOutput.close

    async def slow(self: TcpOutput) -> None:
        await asyncio.sleep(0.5)
        await closing(self)

    monkeypatch.setattr(TcpOutput, "close", slow)
    port = free_port()
    with hub() as outputs, structlog.testing.capture_logs() as events:
        outputs.want(first := output_of(f"tcp:port={port}"))
        settled(outputs, [first])
        outputs.want(second := output_of(f"gpsd:port={port}"))
        settled(outputs, [second])
    assert [event for event in events if event["event"] == "output_failed"] == []


def test_an_output_that_is_wanted_again_while_it_goes_comes_back(
    monkeypatch: pytest.MonkeyPatch, logged: list[Any]
) -> None:
    opening = TcpOutput.open

    async def slow(self: TcpOutput) -> None:
        await asyncio.sleep(0.2)
        await opening(self)

    monkeypatch.setattr(TcpOutput, "open", slow)
    port, rest = free_port(), listened_on()
    with hub() as outputs:
        spec, peer = output_of(f"tcp:port={port}"), output_of(f"web:port={port}")
        for _ in range(20):
            outputs.want(spec)
            outputs.want(peer)
            outputs.want()
        outputs.want(spec)
        settled(outputs, [spec])
        awaited(listened_on, lambda ports: ports == rest | {port})
    assert [item for item in logged if item["event"] == "output_failed"] == []


def test_an_output_that_cannot_even_be_made_is_told_and_tried_again(
    monkeypatch: pytest.MonkeyPatch, logged: list[Any]
) -> None:
    def broken(*_: object) -> None:
        raise ImportError("no such library")

    monkeypatch.setattr(running, "RETRY_FIRST_S", 0.05)
    monkeypatch.setattr(OUTPUTS["gpsd"].output, "__init__", broken)
    with hub() as outputs:
        outputs.want("gpsd:port=0", "tcp:port=0")
        awaited(lambda: any(statuse.address for statuse in outputs.statuses()))
        monkeypatch.undo()
        outputs.opened(2)
    assert [item["reason"] for item in logged if item["log_level"] == "error"] == ["ImportError: no such library"]


def test_what_an_output_claims_is_its_port_or_its_path() -> None:
    """A port that is given by the system is nobody's, and the port of a broker is the broker's."""
    resources: dict[str, Any] = {
        text: Output.exclusive_resources(output_of(text).options)
        for text in ("tcp:port=5", "tcp:port=0", "unix:path=/a")
    }
    assert resources == {"tcp:port=5": {"port 5"}, "tcp:port=0": set(), "unix:path=/a": {"path /a"}}
    assert OUTPUTS["mqtt"].output.exclusive_resources(output_of("mqtt:port=5").options) == {"mqtt 127.0.0.1 "}
