"""`gyrodrift serve --output` as a user runs it: beside stdout, changed while it runs, and in spite of its clients."""

import json
import os
import shutil
import signal
import socket
import subprocess
from pathlib import Path

import pytest
from outputs_support import Reader, address_of, connected, csv_at_100_hz, events, path_of, serving
from support import Command, never

HDR = "hdr: {i_c_dps: 1e-3, tau_s: .5, theta_w_dps: 1, c1: 0, c2: 1}\n"


def test_samples_go_to_stdout_and_to_every_client(port: Path, tmp_path: Path) -> None:
    """Equal lines over TCP and a unix socket."""
    path = tmp_path / "socket"
    with serving(port, "--output", "tcp:port=0", "--output", f"unix:path={path}") as (serve, device):
        path_of(serve, "unix")
        with connected(address_of(serve, "tcp")) as client, socket.socket(socket.AF_UNIX) as connection:
            connection.connect(str(path))
            local = Reader(connection)
            assert client.json()["class"] == local.json()["class"] == "HELLO"
            device.send_all(csv_at_100_hz(301), never)
            lines = serve.take_lines(300)
            assert [client.until("SAMPLE") for _ in lines] == [{"class": "SAMPLE"} | line for line in lines]
            assert [local.until("SAMPLE")["seq"] for _ in lines] == [line["seq"] for line in lines]
            assert serve.stop() == 0
            while client.line():
                pass  # the service says goodbye
    assert events(serve, "service_end")[-1]["clients"] >= 0
    assert not path.exists()


def test_nc_is_a_client(port: Path) -> None:
    nc = shutil.which("nc")
    if nc is None:
        pytest.skip("nc is not installed")
    with serving(port, "--output", "tcp:port=0") as (serve, device):
        host, number = address_of(serve, "tcp")
        with subprocess.Popen([nc, host, str(number)], stdout=subprocess.PIPE) as client:
            assert client.stdout is not None
            assert json.loads(client.stdout.readline())["class"] == "HELLO"
            device.send_all(csv_at_100_hz(50), never)
            while json.loads(client.stdout.readline())["class"] != "SAMPLE":
                pass  # events of the link come before
            client.kill()


def test_outputs_of_the_config_come_and_go_without_a_sample_lost_to_others(port: Path, tmp_path: Path) -> None:
    config = tmp_path / "c.yaml"
    config.write_text(HDR)
    with serving(port, "--config", config, "--output", "tcp:port=0,rate_hz=1000") as (serve, device):
        with connected(address_of(serve, "tcp")) as client:
            client.until("HELLO")
            device.send_all(csv_at_100_hz(101), never)
            serve.take_lines(100)
            config.write_text(HDR + f"outputs: [{{name: unix, path: {tmp_path / 'a'}}}]\n")
            path_of(serve, "unix")
            device.send_all(csv_at_100_hz(100, first=101), never)
            serve.take_lines(100)
            config.write_text(HDR + f"outputs: [{{name: unix, path: {tmp_path / 'b'}}}, {{name: unx}}]\n")
            serve.until_log("config_rejected")
            assert "outputs.1.name: 'unx' (text) is not an output; did you mean unix?" in serve.log
            config.write_text(HDR + f"outputs: [{{name: unix, path: {tmp_path / 'b'}}}]\n")
            serve.until(lambda it: len(events(it, "output_open", "unix")) == 2, "the other socket")
            assert not (tmp_path / "a").exists()
            device.send_all(csv_at_100_hz(100, first=201), never)
            assert [client.until("SAMPLE")["seq"] for _ in range(300)] == list(range(300))
        assert serve.stop() == 0


@pytest.mark.promise("Clients of outputs")
def test_a_process_of_outputs_that_dies_takes_no_sample_with_it(port: Path) -> None:
    """If the output process dies, no sample is lost."""
    with serving(port, "--output", "tcp:port=0") as (serve, device):
        address_of(serve, "tcp")
        device.send_all(csv_at_100_hz(101), never)
        (child,) = Path(f"/proc/{serve.process.pid}/task/{serve.process.pid}/children").read_text().split()
        os.kill(int(child), signal.SIGKILL)
        serve.until_log("outputs_died")
        device.send_all(csv_at_100_hz(100, first=101), never)
        assert [line["seq"] for line in serve.take_lines(200)] == list(range(200))
        serve.until(lambda it: len(events(it, "output_open", "tcp")) == 2, "the second process")
        with connected(address_of(serve, "tcp")) as client:
            client.until("HELLO")
            device.send_all(csv_at_100_hz(100, first=201), never)
            assert client.until("SAMPLE")["seq"] >= 200
        assert serve.stop() == 0


def test_the_service_goes_on_for_its_outputs_when_nobody_reads_stdout(port: Path) -> None:
    with serving(port, "--output", "tcp:port=0") as (serve, device):
        with connected(address_of(serve, "tcp")) as client:
            client.until("HELLO")
            serve.close_stdout()
            device.send_all(csv_at_100_hz(101), never)
            serve.until_log("reader_gone")
            assert [client.until("SAMPLE")["seq"] for _ in range(100)] == list(range(100))
        assert serve.stop() == 0


@pytest.mark.parametrize(
    ("output", "message"),
    [
        ("tpc", "gyrodrift: --output tpc: 'tpc' (text) is not an output; did you mean tcp?"),
        ("tcp:prt=1", "gyrodrift: --output tcp:prt=1: prt: is not an option of tcp; did you mean port?"),
    ],
)
def test_a_persons_mistake_is_one_line_and_an_exit_status(port: Path, output: str, message: str) -> None:
    with Command("serve", "--port", port, "--output", output) as serve:
        assert serve.end() == 2
    assert serve.log.splitlines() == [message]


def test_outputs_and_their_options_are_listed() -> None:
    with Command("serve", "--list-outputs") as command:
        assert command.end() == 0
    assert "tcp: JSON lines on a TCP port\n  host=127.0.0.1: address to listen on" in command.out
