"""Outputs on their loop: what a client gets, what it may do, and what it cannot do to others."""

import json
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from outputs_support import HubThread, Reader, connected, corrected, hub
from support import PATIENCE_S, awaited

from gyrodrift import __version__
from gyrodrift.outputs.fields import CHOICES, OF_EVERY_DEVICE
from gyrodrift.outputs.line_output import JsonSession
from gyrodrift.outputs.status import MOST_CLIENTS, ClientStatus
from gyrodrift.outputs.udp import UdpOutput

Address = tuple[str, int]


@pytest.fixture
def outputs(logged: list[Any]) -> Iterator[HubThread]:
    with hub() as running:
        yield running


@pytest.fixture
def tcp(outputs: HubThread) -> Address:
    outputs.want("tcp:port=0")
    return outputs.endpoint()


def test_a_client_gets_hello_and_then_samples(outputs: HubThread, tcp: Address) -> None:
    with connected(tcp) as client:
        hello = client.json()
        assert hello == {"class": "HELLO", "program": "gyrodrift", "version": __version__, "fields": list(CHOICES)}
        outputs.samples([corrected(seq) for seq in range(300)])
        samples = [client.json() for _ in range(300)]
    assert [sample["seq"] for sample in samples] == list(range(300))
    assert set(samples[0]) == {"class", *(field.name for field in OF_EVERY_DEVICE)} - {"t_host_s", "raw_yaw_deg"}


def test_a_client_asks_for_a_rate_and_for_fields(outputs: HubThread, tcp: Address) -> None:
    with connected(tcp) as client, connected(tcp) as second:
        client.until("HELLO")
        second.until("HELLO")
        client.connection.sendall(b'{"class":"WATCH","rate_hz":10,"fields":["t_host_s","yaw_deg"]}\n')
        assert client.json() == {"class": "WATCH", "rate_hz": 10, "fields": ["t_host_s", "yaw_deg"]}
        outputs.samples([corrected(seq) for seq in range(101)])
        got = [client.json() for _ in range(11)]
        assert [second.until("SAMPLE")["seq"] for _ in range(101)] == list(range(101))
    assert [item["t_host_s"] for item in got] == pytest.approx([1.7e9 + n / 10 for n in range(11)])
    assert set(got[0]) == {"class", "t_host_s", "yaw_deg"}


@pytest.mark.parametrize(
    ("output_text", "answer"),
    [
        (b"garbage", "'garbage': this is no JSON"),
        (b"\xff\xfe\x00", "no JSON"),
        (b"[" * 5000, "no JSON"),
        (b'{"class":' + b"[" * 20 + b"]" * 20 + b"}", "nested more than 16 deep"),
        (b'{"rate_hz":' + b"1" * 5000 + b"}", "no JSON"),
        (b'{"class":"WATCH","rate_hz":Infinity}', "no JSON"),
        (b"[1]", 'expected {"class":"WATCH","rate_hz":10,"fields":["t_s","yaw_deg"]}'),
        (b'{"class":"WATCH","rate_hz":-1}', "rate_hz: expected a number above 0"),
        (b'{"class":"WATCH","rate_hz":true}', "rate_hz: expected a number above 0"),
        (b'{"class":"WATCH","fields":["yaw"]}', "fields: 'yaw' is no field; did you mean yaw_deg?"),
        (b'{"class":"WATCH","fields":"yaw"}', "fields: expected a list of names"),
        (b'{"class":"WATCH","zero":1}', "unknown key 'zero'"),
    ],
)
def test_nonsense_is_answered_with_what_was_expected(
    outputs: HubThread, tcp: Address, output_text: bytes, answer: str
) -> None:
    with connected(tcp) as client:
        client.until("HELLO")
        client.connection.sendall(output_text + b"\n")
        assert answer in client.until("ERROR")["message"]
        outputs.samples([corrected(0)])
        assert client.until("SAMPLE")["seq"] == 0


def test_a_line_of_10_mb_closes_its_connection_alone(outputs: HubThread, tcp: Address) -> None:
    with connected(tcp) as client, connected(tcp) as second:
        client.until("HELLO")
        try:
            for _ in range(160):
                client.connection.sendall(b"x" * (1 << 16))
        except OSError:
            pass  # closed before all of it was sent
        else:
            pytest.fail("10 MB were taken")
        outputs.samples([corrected(7)])
        assert second.until("SAMPLE")["seq"] == 7


def test_who_sends_too_much_is_told_to_go(outputs: HubThread, tcp: Address) -> None:
    with connected(tcp) as client:
        client.until("HELLO")
        client.connection.sendall(b"\n" * 1000)
        assert client.until("ERROR")["message"] == "more than 200 lines a second"
        assert client.line() == b""


@pytest.mark.promise("Clients of outputs")
def test_a_mistake_of_ours_ends_the_connection_that_found_it_alone(
    outputs: HubThread, tcp: Address, logged: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """An error with one client ends only its connection, and writes at most two log lines a second."""
    taken = JsonSession.line

    def line(session: JsonSession, text: bytes) -> None:
        if text == b"trap":
            raise RecursionError("trapped")
        taken(session, text)

    monkeypatch.setattr(JsonSession, "line", line)
    with connected(tcp) as second:
        second.until("HELLO")
        for _ in range(50):
            with connected(tcp) as client:
                client.until("HELLO")
                client.connection.sendall(b"trap\n")
                assert "RecursionError: trapped" in client.until("ERROR")["message"]
                assert client.line() == b""
        outputs.samples([corrected(1)])
        assert second.until("SAMPLE")["seq"] == 1
    report = [item for item in logged if item["event"].startswith(("client", "output_broke"))]
    assert "RecursionError" in report[0]["reason"]
    assert len(report) < 50


def test_a_crowd_leaves_room_for_who_was_there(outputs: HubThread, tcp: Address, logged: list[Any]) -> None:
    with ExitStack() as many, connected(tcp) as first:
        first.until("HELLO")
        clients = [many.enter_context(connected(tcp)) for _ in range(300)]
        assert clients[-1].until("ERROR")["message"] == "there are 64 clients already"
        assert clients[-1].line() == b""
        outputs.samples([corrected(1)])
        assert first.until("SAMPLE")["seq"] == 1
        status = awaited(lambda: outputs.statuses()[0], lambda heard: heard.client_count == 64)
        assert len(status.clients) == MOST_CLIENTS
    closed = [item for item in logged if item["event"].startswith("client")]
    assert closed[0]["reason"] == "there are 64 clients already"
    assert len(closed) < 50


def test_a_client_that_does_not_read_loses_the_oldest_and_is_told(outputs: HubThread, tcp: Address) -> None:
    """Whole lines; the newest are there, and who reads has them all."""
    count = 30_000
    with connected(tcp) as sleeper, connected(tcp) as reader:
        sleeper.until("HELLO")
        reader.until("HELLO")
        for first in range(0, count, 1000):
            outputs.samples([corrected(seq) for seq in range(first, first + 1000)])
            assert [reader.json()["seq"] for _ in range(1000)] == list(range(first, first + 1000))
        got: list[int] = []
        dropped = 0
        while not got or got[-1] < count - 1:
            statement = sleeper.json()
            if statement["class"] == "DROPPED":
                dropped += statement["lines"]
            else:
                got.append(statement["seq"])
        assert dropped > 0
        assert got == sorted(got)
        assert len(got) + dropped == count
        assert next(statuse for statuse in iter(outputs.statuses, None) if statuse[0].dropped == dropped)


def test_outputs_come_and_go_and_the_others_notice_nothing(outputs: HubThread, tcp: Address, tmp_path: Path) -> None:
    with connected(tcp) as client:
        client.until("HELLO")
        outputs.samples([corrected(0)])
        path = tmp_path / "socket"
        outputs.want("tcp:port=0", f"unix:path={path}")
        outputs.opened(2)
        with socket.socket(socket.AF_UNIX) as connection:
            connection.connect(str(path))
            local = Reader(connection)
            local.until("HELLO")
            assert path.stat().st_mode & 0o777 == 0o600
            outputs.samples([corrected(1)])
            assert local.until("SAMPLE")["seq"] == 1
            outputs.want("tcp:port=0")
            assert local.line() == b""
        outputs.samples([corrected(2)])
        assert [client.until("SAMPLE")["seq"] for _ in range(3)] == [0, 1, 2]
    assert not path.exists()


LISTENING = "import socket; s = socket.create_server(('127.0.0.1', 0)); print(s.getsockname()[1], flush=True); input()"


def problem(outputs: HubThread) -> str:
    """Why the last of the outputs is not open."""
    return next(
        statuse[-1].problem for statuse in iter(outputs.statuses, None) if statuse and "is used" in statuse[-1].problem
    )


def test_a_port_that_is_taken_is_told_with_by_whom_and_tried_again(
    outputs: HubThread, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("gyrodrift.outputs.running.RETRY_FIRST_S", 0.05)
    with subprocess.Popen([sys.executable, "-c", LISTENING], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as holder:
        assert holder.stdout is not None
        port = int(holder.stdout.readline())
        outputs.want(f"tcp:port={port}")
        name = Path(f"/proc/{holder.pid}/comm").read_text().strip()
        assert problem(outputs) == (
            f"port 127.0.0.1:{port} is used by {name} (process {holder.pid}); choose another with port="
        )
        holder.communicate(b"\n")
    assert outputs.endpoint() == ("127.0.0.1", port)
    outputs.want(f"tcp:port={port}", f"tcp:port={port},rate_hz=10")
    assert "is used by another output of this service" in problem(outputs)


@pytest.mark.promise("Clients of outputs")
def test_a_path_that_is_no_socket_is_left_alone(outputs: HubThread, tmp_path: Path) -> None:
    """A file at the path of a socket is kept."""
    file = tmp_path / "notes.txt"
    file.write_text("mine")
    outputs.want(f"unix:path={file}")
    (status,) = next(
        statuse for statuse in iter(outputs.statuses, None) if statuse and "no socket" in statuse[0].problem
    )
    assert status.problem == f"{file} exists and is no socket; choose another with path="
    assert file.read_text() == "mine"
    remaining = tmp_path / "left"
    with socket.socket(socket.AF_UNIX) as dead:
        dead.bind(str(remaining))
    outputs.want(f"unix:path={remaining}")
    assert outputs.opened()[0].address == str(remaining)


@pytest.mark.promise("Clients of outputs")
def test_a_socket_of_others_that_has_the_place_of_ours_is_left_alone(outputs: HubThread, tmp_path: Path) -> None:
    """A socket of another program at the path of ours is kept."""
    path = tmp_path / "gyro"
    outputs.want(f"unix:path={path}")
    outputs.opened()
    path.rename(tmp_path / "ours")
    with socket.socket(socket.AF_UNIX) as second:
        second.bind(str(path))
        outputs.want()
        while outputs.statuses():
            pass
        assert path.is_socket()


def test_events_reach_clients(outputs: HubThread, tcp: Address) -> None:
    with connected(tcp) as client:
        client.until("HELLO")
        outputs.event("gap", missing=3)
        assert client.json() == {"class": "EVENT", "event": "gap", "missing": 3}


@pytest.mark.promise("Clients of outputs")
def test_a_status_that_fails_is_a_problem_of_its_output_alone(
    outputs: HubThread, tcp: Address, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An output whose status fails is reported; others are reported as before."""
    outputs.want("tcp:port=0", "udp:port=9")
    outputs.opened(2)

    def clients(_: UdpOutput) -> list[ClientStatus]:
        raise UnicodeDecodeError("utf-8", b"\xff", 0, 1, "invalid start byte")

    monkeypatch.setattr(UdpOutput, "clients", clients)
    statuses = awaited(outputs.statuses, lambda heard: "UnicodeDecodeError" in heard[1].problem)
    assert statuses[0].address
    with connected(tcp) as client:
        client.until("HELLO")


def test_datagrams_are_what_plotjuggler_takes(outputs: HubThread) -> None:
    """One flat JSON object each, numbers alone, `timestamp` at the top: what its JSON parser makes curves of.

    A stand-in: PlotJuggler itself needs a screen. It parses as its DataStreamUDP and JSON parser do.
    """
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.bind(("127.0.0.1", 0))
        receiver.settimeout(PATIENCE_S)
        outputs.want(f"udp:port={receiver.getsockname()[1]},rate_hz=10")
        outputs.opened()
        outputs.samples([corrected(seq) for seq in range(51)])
        curves = plotjuggler([receiver.recv(1 << 16) for _ in range(6)])
    assert [t_s for t_s, _ in curves["yaw_deg"]] == pytest.approx([1.7e9 + n / 10 for n in range(6)])
    assert [value for _, value in curves["seq"]] == [0, 10, 20, 30, 40, 50]


def plotjuggler(datagrams: list[bytes]) -> dict[str, list[tuple[float, float]]]:
    """Curves by name: numbers of each object, at the time of its field `timestamp`; anything else fails."""
    curves: dict[str, list[tuple[float, float]]] = {}
    for datagram in datagrams:
        statement = json.loads(datagram)
        t_s = statement.pop("timestamp")
        for name, value in statement.items():
            curves.setdefault(name, []).append((t_s, float(value)))
    return curves
