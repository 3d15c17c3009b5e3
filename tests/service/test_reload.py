"""A config that changes while `serve` runs: reading it costs no sample, however long that takes."""

import os
import signal
import socket
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from outputs_support import Reader, csv_at_100_hz, serving
from support import PATIENCE_S, Command, awaited, never

from gyrodrift.service.control_client import ControlClient

HDR = "hdr: {{i_c_dps: 1e-3, tau_s: {tau_s}, theta_w_dps: 1, c1: 0, c2: 1}}\n"
READING = b"gyrodrift.config"


@dataclass
class Followed:
    """A service that follows a config."""

    serve: Command
    device: Any
    config: Path
    control: Path
    sent: int = 0

    def feed(self, count: int) -> None:
        """So many more samples; each is a line before more come."""
        self.device.send_all(csv_at_100_hz(count, first=self.sent), never)
        assert [line["seq"] for line in self.serve.take_lines(count)] == list(range(self.sent, self.sent + count))
        self.sent += count

    def stopped_reading(self) -> int:
        """The process that reads the config, which does nothing any more."""
        pid = awaited(lambda: _reading_of(self.serve.process.pid))
        os.kill(pid, signal.SIGSTOP)
        return pid


def _reading_of(service: int) -> int | None:
    """The process that reads a config for a service."""
    children = Path(f"/proc/{service}/task/{service}/children").read_text().split()
    for child in children:
        try:
            words = Path(f"/proc/{child}/cmdline").read_bytes().split(b"\0")
        except OSError:
            continue
        if READING in words:
            return int(child)
    return None


def asking(path: Path) -> socket.socket:
    """A client that has asked for the config to be read, and does not wait for the answer."""
    connection = socket.socket(socket.AF_UNIX)
    connection.settimeout(PATIENCE_S)
    connection.connect(str(path))
    connection.sendall(b"reload\n")
    return connection


@pytest.fixture
def followed(port: Path, tmp_path: Path) -> Iterator[Followed]:
    config, control = tmp_path / "c.yaml", tmp_path / "control"
    config.write_text(HDR.format(tau_s=1.0))
    with serving(port, "--config", config, "--control", control) as (serve, device):
        serve.until(lambda _: control.exists(), "control socket")
        followed = Followed(serve, device, config, control)
        followed.feed(100)
        yield followed


@pytest.mark.promise("Samples")
def test_samples_and_commands_go_on_while_a_config_is_read(followed: Followed) -> None:
    """Samples and commands continue while a config is read."""
    followed.config.write_text(HDR.format(tau_s=2.0))
    with asking(followed.control) as patient, ControlClient(followed.control, PATIENCE_S) as second:
        reading = followed.stopped_reading()
        followed.feed(2000)
        assert second.ask("zero")["ok"]
        assert second.ask("status")["config"]["applied"] == 0
        followed.feed(2000)
        os.kill(reading, signal.SIGCONT)
        assert Reader(patient).json()["ok"]
        assert second.ask("status")["config"]["params"]["tau_s"] == 2.0
        followed.feed(100)
    assert followed.serve.stop() == 0


def test_who_leaves_before_the_answer_costs_nobody_anything(followed: Followed) -> None:
    """Nor who has said all there is to say, as `echo reload | nc` does: that one is answered."""
    with asking(followed.control), asking(followed.control) as half:
        half.shutdown(socket.SHUT_WR)
        followed.stopped_reading()
    with asking(followed.control) as patient:
        patient.shutdown(socket.SHUT_WR)
        followed.feed(100)
        reading = _reading_of(followed.serve.process.pid)
        assert reading is not None
        os.kill(reading, signal.SIGCONT)
        assert Reader(patient).json() == {"ok": True, "changes": []}
    followed.feed(100)
    assert followed.serve.stop() == 0


@pytest.mark.promise("Configs and commands")
def test_a_reading_that_dies_is_told_and_the_old_config_stays(followed: Followed) -> None:
    """If the process that reads a config dies, this is reported and the old config stays."""
    with asking(followed.control) as patient:
        os.kill(followed.stopped_reading(), signal.SIGKILL)
        answer = Reader(patient).json()
    assert answer["ok"] is False
    assert "the process that reads it ended by signal 9; save it again" in answer["error"]
    followed.serve.until_log("config_rejected")
    followed.config.write_text(HDR.format(tau_s=2.0))
    followed.serve.until_log("config_applied")
    followed.feed(100)
    assert followed.serve.stop() == 0


@pytest.mark.promise("Configs and commands")
@pytest.mark.parametrize("stop", [signal.SIGTERM, signal.SIGKILL])
def test_no_reading_outlives_the_service(followed: Followed, stop: signal.Signals) -> None:
    """No process that reads a config outlives the service."""
    with asking(followed.control):
        reading = followed.stopped_reading()
        assert followed.serve.stop(stop) == (0 if stop == signal.SIGTERM else -stop)
        with suppress(ProcessLookupError):
            os.kill(reading, signal.SIGCONT)  # it may have been stopped before it could ask for its end
    awaited(lambda: _is_gone(reading))


def _is_gone(pid: int) -> bool:
    """Whether a process has ended; one of another parent may be left as a zombie for a moment."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except OSError:
        return True
