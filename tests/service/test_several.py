"""Several gyros in one service: each with its own filter, recording, outputs and faults."""

import json
import re
import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from threading import Event, Thread
from typing import Any

import pytest
from sources_support import lines, serving
from support import PATIENCE_S, Command, free_port

from gyrodrift.columns.fields import checksum
from gyrodrift.session.files import load_session


@contextmanager
def sending(number: int, rate_dps: str = "0.5") -> Iterator[None]:
    """A gyro of 100 Hz that sends datagrams to this machine."""
    is_over = Event()

    def send() -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as device:
            count = 0
            while not is_over.is_set():
                device.sendto(b"%d,%b\n" % (10_000 * count, rate_dps.encode()), ("127.0.0.1", number))
                count += 1
                time.sleep(0.01)

    thread = Thread(target=send)
    thread.start()
    try:
        yield
    finally:
        is_over.set()
        thread.join()


def config(folder: Path, **blocks: str) -> Path:
    path = folder / "gyros.yaml"
    path.write_text("sources:\n" + "".join(f"  {name}: {block}\n" for name, block in blocks.items()))
    return path


def udp(number: int, settings: str = "") -> str:
    """Block of a source that listens for datagrams."""
    return f"{{port: 'udp://:{number}', {settings}}}"


def of(samples: list[dict[str, Any]], source: str) -> list[dict[str, Any]]:
    return [sample for sample in samples if sample["source"] == source]


def until_both(serve: Command, count: int) -> list[dict[str, Any]]:
    """All lines, from the time when both sources have `count` of them."""
    serve.until(
        lambda serve: min(len(of(serve.all_lines(), name)) for name in ("left", "right")) >= count, f"{count} lines"
    )
    return serve.all_lines()


def sentence(body: str) -> bytes:
    """NMEA sentence with its checksum."""
    return f"${body}*{checksum(body):02X}\r\n".encode()


def test_a_receiver_aids_a_gyro(tmp_path: Path) -> None:
    """RMC sentences on a link of their own join the samples of the gyro, which names their ages."""
    gyro_port, gps_port = free_port(), free_port()
    path = config(tmp_path, imu=udp(gyro_port), gps=udp(gps_port, "aids: imu, late: 0.1"))
    with sending(gyro_port), Command("serve", "--config", path, "--record", tmp_path / "out") as serve:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
            serve.until(lambda it: len(it.all_lines()) > 5, "samples")
            receiver.sendto(sentence("GPRMC,120000,V,,,,,1.0,80.0,,,"), ("127.0.0.1", gps_port))
            receiver.sendto(sentence("GPRMC,120000,A,4800.0,N,01100.0,E,2.0,87.5,010126,,"), ("127.0.0.1", gps_port))
            serve.until(lambda it: bool(it.all_lines()) and "aids" in it.all_lines()[-1], "aids")
            (line,) = serve.all_lines()[-1:]
        assert serve.stop() == 0
    assert set(line["aids"]) == {"gps.speed", "gps.course"}
    (recorded,) = (tmp_path / "out" / "imu").glob("*.mcap")
    aids = {aid.name: aid for _, aid in load_session(recorded).aids or ()}
    assert aids["gps.course"].value == -87.5
    assert aids["gps.course"].speed == pytest.approx(2 * 1852 / 3600)


def test_a_second_source_needs_its_gyro(tmp_path: Path) -> None:
    path = config(tmp_path, imu=udp(1), gps=udp(2, "aids: gyro, filter: hdr, columns: 'v=speed:ly'"))
    with Command("serve", "--config", path) as serve:
        assert serve.end() == 2
    for message in ("sources.gps.filter: is not", "'ly' is not a unit of speed"):
        assert message in serve.log
    path = config(tmp_path, imu=udp(1), gps=udp(2, "aids: gyro"))
    with Command("serve", "--config", path) as serve:
        assert serve.end() == 2
    assert "sources.gps.aids: is 'gyro' (text); expected one of imu" in serve.log


def test_each_source_has_its_filter_its_recording_and_its_name(tmp_path: Path) -> None:
    left_port, right_port = free_port(), free_port()
    path = config(
        tmp_path,
        left=udp(left_port, "filter: restlevel"),
        right=udp(right_port, "filter: hdr"),
    )
    command = Command("serve", "--config", path, "--record", tmp_path / "out")
    with sending(left_port), sending(right_port, "-0.25"), command as serve:
        samples = until_both(serve, 50)
        assert serve.stop() == 0
    assert {sample["rate_dps"] for sample in of(samples, "left")} == {0.5}
    assert {sample["rate_dps"] for sample in of(samples, "right")} == {-0.25}
    assert all("confidence" in sample for sample in of(samples, "left"))
    assert all("confidence" not in sample for sample in of(samples, "right"))
    for name, rate_dps in (("left", 0.5), ("right", -0.25)):
        (recording,) = (tmp_path / "out" / name).glob("*.mcap")
        assert set(load_session(recording).rate_dps) == {rate_dps}


@pytest.mark.promise("Samples", "a source of several that fails, or is absent, leaves the others alone")
def test_a_source_that_is_not_there_keeps_no_other_one_waiting(tmp_path: Path) -> None:
    left_port, right_port = free_port(), free_port()
    path = config(tmp_path, left=udp(left_port), right=f"{{port: 'tcp://127.0.0.1:{right_port}'}}")
    with sending(left_port), Command("serve", "--config", path) as serve:
        serve.until(lambda serve: len(serve.all_lines()) >= 20, "lines of the one that is there")
        assert "nothing listens on port" in serve.log
        with serving(right_port) as server:
            connection, _ = server.accept()
            with connection:
                connection.sendall(lines(0, 200))
                until_both(serve, 200)
        assert serve.stop() == 0


@pytest.mark.promise("Samples")
def test_a_source_that_fails_ends_alone(tmp_path: Path) -> None:
    """A source of several that fails, or is absent, leaves the others alone."""
    left_port, right_port = free_port(), free_port()
    path = config(tmp_path, left=udp(left_port), right=udp(right_port, "timeout: 1"))
    with sending(left_port), Command("serve", "--config", path) as serve:
        serve.until_log("source_failed source=right")
        count = len(serve.all_lines())
        serve.until(lambda serve: len(serve.all_lines()) > count + 50, "more lines of the other one")
        assert serve.stop() == 3


def test_a_source_that_never_came_says_why(tmp_path: Path) -> None:
    path = config(tmp_path, left=f"{{port: 'unix:{tmp_path}/none.sock', timeout: 0.5}}")
    with Command("serve", "--config", path) as serve:
        serve.until_log("none.sock: there is no such socket; start the server first; it was not there for 0.5 s")
        assert serve.process.wait(PATIENCE_S) == 3


def test_a_mistake_in_an_address_names_its_source(tmp_path: Path) -> None:
    """The addresses stand in the config, and not on the command line."""
    path = config(tmp_path, left=udp(free_port()), right="{port: 'fax://office'}")
    with Command("serve", "--config", path) as serve:
        serve.until_log("sources.right: --port fax://office: unknown source 'fax'")
        assert serve.process.wait(PATIENCE_S) == 2


def test_a_new_config_changes_one_source(tmp_path: Path) -> None:
    left_port, right_port = free_port(), free_port()
    blocks = {
        "left": udp(left_port, "hdr: {}"),
        "right": udp(right_port, "hdr: {}"),
    }
    path = config(tmp_path, **blocks)
    with (
        sending(left_port),
        sending(right_port),
        Command("serve", "--config", path, "--control", tmp_path / "c.sock") as serve,
    ):
        until_both(serve, 20)
        assert (tmp_path / "c-left.sock").is_socket()
        assert (tmp_path / "c-right.sock").is_socket()
        config(tmp_path, **blocks | {"right": udp(right_port, "hdr: {tau_s: 0.5}")})
        serve.until_log("config_applied source=right")
        serve.until_log("config_applied source=left")
        assert re.search(r"config_applied source=left .*changes=\[\]", serve.log)
        assert serve.stop() == 0


def test_outputs_carry_the_name(tmp_path: Path) -> None:
    """JSON lines in `source`, PlotJuggler in the name of the series."""
    gyro, tcp = free_port(), free_port()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as plot, ExitStack() as stack:
        plot.bind(("127.0.0.1", 0))
        plot.settimeout(PATIENCE_S)
        outputs = f"[{{name: tcp, port: {tcp}}}, {{name: udp, port: {plot.getsockname()[1]}}}]"
        path = config(tmp_path, left=udp(gyro, f"outputs: {outputs}"))
        stack.enter_context(sending(gyro))
        serve = stack.enter_context(Command("serve", "--config", path))
        assert json.loads(plot.recv(65_536))["gyro"]["left"]["rate_dps"] == 0.5
        serve.until_log("output_open source=left output=tcp")
        with socket.create_connection(("127.0.0.1", tcp), 60.0) as client, client.makefile() as received:
            assert json.loads(received.readline())["class"] == "HELLO"
            assert json.loads(received.readline())["source"] == "left"
            client.sendall(b'{"class":"WATCH","fields":["yaw_deg"]}\n')
            samples = (json.loads(line) for line in received)
            sample = next(sample for sample in samples if sample["class"] == "SAMPLE" and "seq" not in sample)
        assert set(sample) == {"class", "source", "yaw_deg"}
        assert serve.stop() == 0


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("--output", "tcp"), "--output: with sources: in the config, set it in the block of a source"),
        (("--filter", "hdr"), "argument"),
        (("--baud", "9600"), "--baud: with sources: in the config, set it in the block of a source"),
    ],
)
def test_an_option_of_one_gyro_is_refused(tmp_path: Path, words: tuple[str, ...], expected: str) -> None:
    path = config(tmp_path, left="{port: x}")
    with Command("serve", "--config", path, *words) as serve:
        assert serve.end() == 2
        assert expected in serve.log


def test_without_port_and_sources_serve_says_what_is_missing() -> None:
    with Command("serve") as serve:
        assert serve.end() == 2
        assert "the following arguments are required: --port, or --config with sources:" in serve.log
