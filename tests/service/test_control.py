"""`gyrodrift ctl` on a running `serve --control`: what each command does, and what is said of mistakes."""

import json
import socket
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from outputs_support import Reader, address_of, connected, csv_at_100_hz, serving
from support import Command, never

from gyrodrift.outputs.status import ServiceStatus

HDR = "hdr: {i_c_dps: 0, tau_s: 0, theta_w_dps: 1, c1: 0, c2: 1}\n"


@dataclass
class Controlled:
    serve: Command
    device: Any
    path: Path
    config: Path
    sent: int = 0

    def feed(self, count: int) -> list[dict[str, Any]]:
        """So many more samples at 10 deg/s and 100 Hz; their lines."""
        self.device.send_all(csv_at_100_hz(count, first=self.sent), never)
        lines = self.serve.take_lines(count)
        self.sent += count
        return lines

    def ask(self, line: str | bytes) -> dict[str, Any]:
        with socket.socket(socket.AF_UNIX) as connection:
            connection.connect(str(self.path))
            connection.sendall(line.encode() + b"\n" if isinstance(line, str) else line)
            return Reader(connection).json()


@pytest.fixture
def service(port: Path, tmp_path: Path) -> Iterator[Controlled]:
    path, config = tmp_path / "control", tmp_path / "c.yaml"
    config.write_text(HDR)
    with serving(port, "--control", path, "--config", config, "--output", "tcp:port=0") as (serve, device):
        address_of(serve, "tcp")
        yield Controlled(serve, device, path, config)


def ctl(path: Path, *words: str) -> tuple[int, dict[str, Any], str]:
    """Exit status, answer and what is said of a mistake."""
    with Command("ctl", path, *words) as command:
        status = command.end()
    return status, json.loads(command.out) if command.out else {}, command.log


def test_zero_and_heading_are_about_what_is_sent(service: Controlled) -> None:
    """Yaw is counter-clockwise from where it was made 0, a heading is clockwise from north."""
    assert service.feed(101)[-1]["yaw_deg"] == pytest.approx(10.0)
    assert "heading_deg" not in service.feed(1)[-1]
    assert ctl(service.path, "zero") == (0, {"ok": True, "yaw_deg": 0.0}, "")
    assert ctl(service.path, "heading", "450") == (0, {"ok": True, "heading_deg": 90.0}, "")
    last = service.feed(100)[-1]
    assert last["yaw_deg"] == pytest.approx(10.0)
    assert last["heading_deg"] == pytest.approx(80.0)


def test_rate_thins_the_lines_on_stdout(service: Controlled) -> None:
    service.feed(50)
    assert service.ask("rate 10") == {"ok": True, "rate_hz": 10.0}
    service.device.send_all(csv_at_100_hz(100, first=50), never)
    assert len(service.serve.take_lines(10)) == 10
    assert service.ask("rate 0") == {"ok": True, "rate_hz": None}


def test_status_tells_everything(service: Controlled) -> None:
    service.feed(200)
    with connected(address_of(service.serve, "tcp")) as client:
        client.until("HELLO")
        service.serve.until(lambda _: clients(service) == 1, "client in the status")
        answer = service.ask("status")
    assert answer.pop("ok") is True
    status = ServiceStatus.from_dict(answer)
    assert (status.link.protocol, status.link.samples, status.link.port) == ("csv", 200, str(service.device.link))
    assert (status.filter.name, status.config.file) == ("hdr", str(service.config))
    assert status.config.params["i_c_dps"] == 0.0
    assert status.filter.temp_c == 25.0
    assert status.memory_bytes > 1 << 20
    assert status.outputs[0].clients[0].peer.startswith("127.0.0.1:")


def clients(service: Controlled) -> int:
    return int(service.ask("status")["outputs"][0]["client_count"])


def test_reload_reads_the_config_again(service: Controlled) -> None:
    service.feed(50)  # without a sample the service ends after 10 s, and reading a config may take longer
    assert service.ask("reload") == {"ok": True, "changes": []}
    service.config.write_text("hdr: 5\n")
    answer = service.ask("reload")
    assert answer["ok"] is False
    assert f"{service.config}:1:1 hdr: is 5; expected a block with" in answer["error"]


def test_stop_ends_the_service(service: Controlled) -> None:
    assert service.path.stat().st_mode & 0o777 == 0o600
    assert ctl(service.path, "stop") == (0, {"ok": True}, "")
    assert service.serve.end() == 0
    assert not service.path.exists()
    status, _, statement = ctl(service.path, "status")
    assert status == 2
    assert statement == f"gyrodrift: {service.path}: there is no such socket; is serve running with --control?\n"


MISTAKES = {
    b"fly\n": "'fly' is no command; the commands are zero, heading DEG [--sigma DEG], turn-rate DPS --sigma DPS, rest",
    b"\n": "'' is no command",
    b"heading\n": "expected heading DEG, clockwise from north",
    b"heading nan\n": "expected heading DEG, clockwise from north",
    b"rate -1\n": "expected rate HZ with a number from 0 to 1000000",
    b"rest 2\n": "expected rest 0 or rest 1",
    b"rest 1\n": "the filter hdr takes no witness of rest",
    b"zero now\n": "expected zero alone",
    b"\xff\xfe\x00\n": "is no command",
    b"x" * 100_000: "a command has no more than 256 bytes",
}


def test_a_mistake_is_answered_and_the_stream_goes_on(service: Controlled) -> None:
    for statement, error in MISTAKES.items():
        answer = service.ask(statement)
        assert answer["ok"] is False
        assert error in answer["error"]
    status, answer, said_to_person = ctl(service.path, "rest", "1")
    assert (status, answer["ok"]) == (2, False)
    assert said_to_person == "gyrodrift: rest 1: the filter hdr takes no witness of rest\n"
    assert len(service.feed(10)) == 10


def test_a_crowd_at_the_socket_is_turned_away(service: Controlled, port: Path) -> None:
    with ExitStack() as stack:
        crowd = [stack.enter_context(socket.socket(socket.AF_UNIX)) for _ in range(50)]
        for item in crowd:
            item.connect(str(service.path))
        for item in crowd[8:]:
            assert Reader(item).json() == {"ok": False, "error": "there are 8 clients already"}
        assert len(service.feed(100)) == 100
    with Command("serve", "--port", port.resolve(), "--control", service.path) as second:
        assert second.end() != 0
    assert service.path.exists()


@pytest.mark.promise("Samples")
def test_zero_restarts_sigma_and_aligns_the_encoder(service: Controlled) -> None:
    """`ctl zero` restarts the sigma of yaw, and aligns the encoder."""
    service.config.write_text("filter: restlevel\n")
    assert service.ask("reload")["ok"]
    before = service.feed(300)[-1]
    assert before["yaw_sigma_deg"] > 1.0
    assert service.ask("zero") == {"ok": True, "yaw_deg": 0.0}
    status = service.ask("status")["filter"]
    assert (status["yaw_deg"], status["yaw_sigma_deg"], status["scale_sigma_deg"]) == (0.0, 0.0, 0.0)
    after = service.feed(1)[-1]
    assert after["yaw_sigma_deg"] < 0.1
    assert after["yaw_deg"] < 0.2


@pytest.mark.promise("Memory and the end")
@pytest.mark.parametrize(("word", "output_text"), [("1\nstop", "has a line break"), ("\udcff", "expected heading DEG")])
def test_an_argument_is_no_second_command(service: Controlled, word: str, output_text: str) -> None:
    """An argument of `ctl` with a line break is refused, and is no second command."""
    status, _, log = ctl(service.path, "heading", word)
    assert status == 2
    assert output_text in log
    assert "Traceback" not in log
    assert service.feed(50)[-1]["seq"] == 49
