"""`gyrodrift devices` and `--port auto`: the real commands on a machine whose ports are ptys."""

import json
import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from support import Command, speaking_on

from gyrodrift.cli import doctor, main
from gyrodrift.link import holder
from gyrodrift.link.serial_port import SerialPort
from gyrodrift.session.mcap.read import read_mcap

Simulated = Callable[..., Path]


@pytest.fixture
def simulated(tmp_path: Path) -> Iterator[Simulated]:
    """Makes a simulated gyro that waits for its reader, and gives its port."""
    with ExitStack() as devices:

        def device(name: str, protocol: str = "native") -> Path:
            path = tmp_path / name
            words = ("--link", path, "--protocol", protocol, "--quiet")
            running = devices.enter_context(Command(*words, module="firmware_sim"))
            running.until(lambda _: path.exists(), "port")
            return path

        yield device


def on(ports: list[Path], *words: str | Path) -> Command:
    """A command on a machine with these ports."""
    return Command(",".join(map(str, ports)), *words, module="tests.plugged_in")


def listed(ports: list[Path], *words: str) -> list[dict[str, Any]]:
    with on(ports, "devices", "--json", *words) as run:
        assert run.end() == 0, run.log
        result: list[dict[str, Any]] = json.loads(run.out)
    return result


def test_each_port_is_listed_with_what_speaks_there(simulated: Simulated, tmp_path: Path) -> None:
    """Two gyros of two protocols, and a port at which nothing is said."""
    ports = [simulated("a-native"), simulated("b-csv", "csv"), tmp_path / "c-silent"]
    with speaking_on(ports[2]):
        native, csv, silent = listed(ports, "--listen")
        with on(ports, "devices", "--listen") as run:
            assert run.end() == 0
    assert (native["speech"]["protocol"], csv["speech"]["protocol"]) == ("native", "csv")
    assert native["speech"]["rate_hz"] == pytest.approx(csv["speech"]["rate_hz"], rel=0.05)
    assert native["speech"]["device_id"] is not None
    assert silent["speech"] is None
    assert silent["reason"].startswith("sent nothing within 3 s")
    assert f"{ports[1]}\n  speaks         csv at " in run.out


def test_without_listen_no_port_is_opened(tmp_path: Path) -> None:
    """The device never sees a reader."""
    with speaking_on(tmp_path / "gyro") as device:
        (result,) = listed([tmp_path / "gyro"])
        assert not device._flushed
    assert result["name"] == str(tmp_path / "gyro")
    assert (result["holder"], result["speech"], result["reason"]) == (None, None, None)


def test_a_port_that_is_held_is_left_alone(simulated: Simulated) -> None:
    port = simulated("gyro", "csv")
    with Command("serve", "--port", port) as first:
        first.take_lines(5)
        (result,) = listed([port], "--listen")
        assert result["holder"]["pid"] == first.process.pid
        assert result["reason"] == f"in use by {result['holder']['name']} (pid {first.process.pid})"
        with on([port], "serve", "--port", "auto") as second:
            assert second.end() == 3
        assert f"gyrodrift: {port}: in use by" in second.log
        first.take_lines(5)
        assert first.stop() == 0
    assert "gap" not in first.log.replace("gaps=", "")


def test_serve_finds_the_one_gyro_among_other_ports(simulated: Simulated, tmp_path: Path) -> None:
    gyro, silent, rubbish = simulated("gyro"), tmp_path / "silent", tmp_path / "rubbish"
    words = ("serve", "--port", "auto", "--timeout", "4")
    with speaking_on(silent) as quiet, speaking_on(rubbish) as noisy, on([silent, rubbish, gyro], *words) as run:

        def has_spoken(run: Command) -> bool:
            noisy.send(os.urandom(40))
            return run.out.count("\n") > 5

        run.until(has_spoken, "yaw")
        assert not quiet.has_reader()
        assert not noisy.has_reader()
        assert run.stop() == 0
    (result,) = [line for line in run.log.splitlines() if "port_found" in line]
    assert f"port={gyro}" in result
    assert "protocol=native" in result


def test_record_takes_the_one_gyro_too(simulated: Simulated, tmp_path: Path) -> None:
    words = ("--columns", "t_us, rate", "--duration", "0.3", "--out", tmp_path / "sessions")
    with on([simulated("gyro", "csv")], "record", "--port", "auto", *words) as run:
        assert run.end() == 0, run.log
    (path,) = (tmp_path / "sessions").glob("*.mcap")
    assert len(read_mcap(path).rate_dps) > 20


def test_several_gyros_are_listed_and_none_is_chosen(simulated: Simulated) -> None:
    """Status 2, and what to do."""
    ports = [simulated("left"), simulated("right", "csv")]
    with on(ports, "serve", "--port", "auto") as run:
        assert run.end() == 2
    assert "gyrodrift: --port auto: 2 gyros found; name one of them with --port\n" in run.log
    assert f"gyrodrift: {ports[0]}: native at " in run.log
    assert f"gyrodrift: {ports[1]}: csv at " in run.log


def test_where_no_gyro_speaks_each_port_is_listed_with_why(tmp_path: Path) -> None:
    """A silent port, and one that is not there any more."""
    with speaking_on(tmp_path / "silent"):
        ports = [tmp_path / "silent", tmp_path / "gone"]
        with on(ports, "serve", "--port", "auto", "--timeout", "1") as run:
            assert run.end() == 3
    assert "--port auto: no gyro found; plug one in, or name its port with --port" in run.log
    assert f"gyrodrift: {ports[0]}: the device sent nothing within 1 s" in run.log
    assert f"gyrodrift: {ports[1]}: there is no such port" in run.log


def test_where_no_port_is_there_it_is_said() -> None:
    """The link is missing, the command line is right: status 3."""
    with on([], "serve", "--port", "auto") as run:
        assert run.end() == 3
    assert run.log == (
        "gyrodrift: --port auto: no serial port is plugged in; plug the gyro in, or name its port with --port\n"
    )
    assert listed([], "--listen") == []


def test_a_simulated_device_is_listed_with_its_link(simulated: Simulated, monkeypatch: pytest.MonkeyPatch) -> None:
    """`devices --listen` finds it without hardware; its row says that it is simulated."""
    port = simulated("gyro")
    monkeypatch.setenv("SIMULATED_BELOW", str(port.parent))
    (device,) = listed([], "--listen")
    assert (device["name"], device["product"]) == (str(port), "simulated device")
    assert device["speech"]["protocol"] == "native"


@pytest.mark.promise("Configs and commands")
def test_port_auto_ignores_a_simulated_device(simulated: Simulated, monkeypatch: pytest.MonkeyPatch) -> None:
    """`--port auto` ignores simulated devices."""
    port = simulated("gyro")
    monkeypatch.setenv("SIMULATED_BELOW", str(port.parent))
    with on([], "serve", "--port", "auto") as run:
        assert run.end() == 3
    assert "no serial port is plugged in" in run.log
    assert f"gyrodrift: {port}: simulated device, which --port auto ignores\n" in run.log


def test_a_service_wants_one_port_for_good(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["install-service", "--port", "auto", "--dry-run"]) == 2
    assert "gyrodrift devices --listen shows it" in capsys.readouterr().err


def test_doctor_takes_the_console_of_the_kernel_for_no_gyro(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "active").write_text("ttyS9\n")
    monkeypatch.setattr(holder, "CONSOLES", tmp_path / "active")
    monkeypatch.setattr(doctor, "serial_ports", lambda: [SerialPort("/dev/ttyS9", "/dev/ttyS9")])
    monkeypatch.setattr(doctor, "simulated_ports", list)
    assert main(["doctor", "--port", "auto", "--timeout", "1"]) == 3
    report = capsys.readouterr().out
    assert "No gyro found" in report
    assert "/dev/ttyS9: in use by the kernel's console" in report
    assert "Stop that program" not in report
