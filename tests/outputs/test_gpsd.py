"""Clients of gpsd: by hand, its own tools, and a client from PyPI."""

import fcntl
import json
import os
import select
import shutil
import signal
import struct
import subprocess
import termios
import time
from collections.abc import Iterator
from itertools import count
from pathlib import Path
from typing import Any

import pytest
from outputs_support import HubThread, Reader, address_of, connected, corrected, csv_at_100_hz, serving, tilted
from support import PATIENCE_S

from gyrodrift import __version__
from gyrodrift.outputs.fields import OF_EVERY_DEVICE
from gyrodrift.outputs.status import DeviceStatus, LinkStatus, ServiceStatus

WATCH = b'?WATCH={"enable":true,"json":true};\r\n'

Address = tuple[str, int]

nan = float("nan")


@pytest.fixture
def gpsd(outputs: HubThread) -> Address:
    outputs.want("gpsd:port=0")
    return outputs.endpoint()


@pytest.fixture
def client(gpsd: Address) -> Iterator[Reader]:
    """One that was greeted."""
    with connected(gpsd) as result:
        greeting = result.json()
        assert greeting == {
            "class": "VERSION",
            "release": f"gyrodrift {__version__}",
            "rev": __version__,
            "proto_major": 3,
            "proto_minor": 14,
        }
        yield result


def ask(client: Reader, request: bytes) -> None:
    client.connection.sendall(request)


def watching(client: Reader) -> None:
    ask(client, WATCH)
    client.until("WATCH")


def test_a_watcher_gets_devices_and_policy_and_then_reports(outputs: HubThread, client: Reader) -> None:
    """ATT has gpsd's names, units and signs; GYRO has everything with ours."""
    ask(client, WATCH)
    assert client.json() == {"class": "DEVICES", "devices": [{"class": "DEVICE", "path": "gyrodrift", "activated": 0}]}
    policy = client.json()
    assert policy["class"] == "WATCH"
    assert policy["enable"]
    assert policy["json"]
    assert not policy["nmea"]
    outputs.samples([corrected(100, yaw_deg=190.0)])
    opening = {"device": "gyrodrift", "time": "2023-11-14T22:13:21.000Z"}
    assert client.json() == {"class": "ATT", **opening, "heading": 90.0, "yaw": 170.0, "rot": -75.0, "temp": 25.0}
    gyro = client.json()
    assert gyro == {"class": "GYRO", **opening, **{field.name: gyro[field.name] for field in OF_EVERY_DEVICE}}
    assert gyro["yaw_deg"] == 190.0
    assert gyro["corrected_dps"] == 1.25


def test_what_is_not_known_is_left_out(outputs: HubThread, client: Reader) -> None:
    """Heading without a reference, temperature of a device without a thermometer."""
    watching(client)
    sample = corrected(0)
    outputs.samples([sample._replace(heading_deg=nan, sample=sample.sample._replace(temp_c=nan))])
    assert set(client.until("ATT")) == {"class", "device", "time", "yaw", "rot"}
    assert not {"heading_deg", "temp_c"} & set(client.json())


def test_a_tilted_device_has_pitch_and_roll(outputs: HubThread, client: Reader) -> None:
    """Bow up and starboard down are positive."""
    watching(client)
    outputs.samples([tilted(0)])
    attitude = client.until("ATT")
    assert (attitude["pitch"], attitude["roll"], attitude["yaw"]) == (20.0, 10.0, -30.0)
    assert client.until("GYRO")["pitch_deg"] == -20.0


def test_reports_are_thinned_to_ten_a_second(outputs: HubThread, client: Reader) -> None:
    watching(client)
    outputs.samples([corrected(seq) for seq in range(100)])
    times = [client.until("GYRO")["t_s"] for _ in range(10)]
    assert times == pytest.approx([0.1 * i for i in range(10)])


def test_poll_gives_the_last_sample_of_a_device_that_is_watched(outputs: HubThread, client: Reader) -> None:
    ask(client, b"?POLL;\n")
    poll = client.json()
    assert (poll["class"], poll["active"], poll["tpv"], poll["sky"]) == ("POLL", 0, [], [])
    watching(client)
    outputs.samples([corrected(7)])
    client.until("GYRO")
    ask(client, b"?POLL;\n")
    poll = client.json()
    assert poll["active"] == 1
    assert poll["tpv"] == [{"class": "TPV", "device": "gyrodrift", "mode": 0}]
    assert poll["att"][0]["rot"] == -75.0
    assert poll["gyro"][0]["seq"] == 7


def test_who_stops_to_watch_gets_no_more(outputs: HubThread, client: Reader) -> None:
    watching(client)
    ask(client, b'?WATCH={"enable":false,"json":true};?VERSION;\n')
    client.until("VERSION")
    outputs.samples([corrected(1)])
    outputs.statuses()
    ask(client, b"?WATCH;\n")
    policy = client.json()
    assert policy["class"] == "WATCH"
    assert not policy["enable"]


def test_the_device_is_told_when_it_comes_and_when_it_goes(outputs: HubThread, client: Reader) -> None:
    watching(client)
    link = LinkStatus(port="/dev/ttyUSB0", baud=115200, protocol="csv", is_open=True)
    outputs.status(ServiceStatus(started_s=1.7e9, link=link, device=DeviceStatus(device_id="gyro-7")))
    assert client.json() == {
        "class": "DEVICE",
        "path": "/dev/ttyUSB0",
        "driver": "gyrodrift csv",
        "subtype": "gyro-7",
        "activated": "2023-11-14T22:13:20.000Z",
        "readonly": True,
        "bps": 115200,
        "parity": "N",
        "stopbits": 1,
    }
    outputs.status(ServiceStatus(started_s=1.7e9, link=LinkStatus(port="/dev/ttyUSB0")))
    assert client.json() == {"class": "DEVICE", "path": "/dev/ttyUSB0", "activated": 0}


@pytest.mark.parametrize(
    ("request_line", "message"),
    [
        (b"?FOO;", "Unrecognized request '?FOO'"),
        (b"hello", "Unrecognized request 'hello'"),
        (b"\xff\xfe", "Unrecognized request '\ufffd\ufffd'"),
        (b'?WATCH={"enable":1};', "Invalid WATCH: enable is true or false"),
        (b"?WATCH={;", "Invalid WATCH: no JSON object follows the ="),
        (b"?WATCH=" + b'{"a":' * 200 + b"}" * 200, "a line of requests is longer than 1024 characters"),
        (b"?WATCH=" + b'{"a":' * 200, "Invalid WATCH: no JSON object follows the ="),
        (b"?WATCH=" + b"[" * 1000, "Invalid WATCH: no JSON object follows the ="),
        (b"?WATCH=" + b'{"a":' * 17 + b"1" + b"}" * 17 + b";", "Invalid WATCH: no JSON object follows the ="),
        (b'?WATCH={"enable":' + b"1" * 900 + b"};", "Invalid WATCH: enable is true or false"),
        (b'?WATCH={"enable":NaN};', "Invalid WATCH: no JSON object follows the ="),
        (b"?POLL;" * 200, "a line of requests is longer than 1024 characters"),
        (b'?WATCH={"device":[[]]};', "No such device, there is gyrodrift"),
        (b'?WATCH={"device":"/dev/gps0"};', "No such device as /dev/gps0, there is gyrodrift"),
        (b'?DEVICE={"bps":4800};', "the device cannot be set from here"),
    ],
)
def test_a_mistake_is_told_and_the_connection_stays(client: Reader, request_line: bytes, message: str) -> None:
    ask(client, request_line + b"\n?DEVICE;\n")
    assert client.json() == {"class": "ERROR", "message": message}
    assert client.json()["class"] == "DEVICE"


def test_gpsdclient_reads_it(outputs: HubThread, gpsd: Address) -> None:
    module = pytest.importorskip("gpsdclient", reason="gpsdclient is not installed: pip install gpsdclient")
    with module.GPSDClient(*gpsd, timeout=PATIENCE_S) as client:
        result = client.dict_stream()
        assert [next(result)["class"] for _ in range(3)] == ["VERSION", "DEVICES", "WATCH"]
        outputs.samples([corrected(100)])
        attitude = next(result)
    assert attitude["rot"] == -75.0
    assert attitude["time"].timestamp() == 1.7e9 + 1.0


def test_cgps_shows_it(outputs: HubThread, gpsd: Address) -> None:
    cgps = shutil.which("cgps")
    if cgps is None:
        pytest.skip("cgps is not installed: apt-get install gpsd-clients")
    terminal, its_end = os.openpty()
    fcntl.ioctl(its_end, termios.TIOCSWINSZ, struct.pack("4H", 40, 200, 0, 0))
    command = [cgps, f"{gpsd[0]}:{gpsd[1]}"]
    with (
        os.fdopen(terminal, "rb", buffering=0) as shown,
        subprocess.Popen(command, stdin=its_end, stdout=its_end, env=os.environ | {"TERM": "xterm"}) as running,
    ):
        os.close(its_end)
        screen = b""
        for seq in count(0, 10):
            outputs.samples([tilted(seq)])
            if select.select([shown], [], [], 0.1)[0]:
                screen += shown.read(1 << 16)
            if b'"pitch":20.0,"roll":10.0,"rot":-75.0' in screen:
                break
            assert running.poll() is None, screen
        running.terminate()


def test_xgps_takes_it(outputs: HubThread, gpsd: Address) -> None:
    result = [shutil.which(name) for name in ("xgps", "xvfb-run", "xwininfo")]
    if None in result:
        pytest.skip("xgps, xvfb-run or xwininfo is not installed: apt-get install gpsd-clients xvfb x11-utils")
    xgps, screen, windows = map(str, result)
    shell = f"{xgps} {gpsd[0]}:{gpsd[1]} & while sleep 0.5; do {windows} -root -tree; done"
    command = [screen, "-a", "sh", "-c", shell]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, start_new_session=True
    ) as running:
        assert running.stdout is not None
        os.set_blocking(running.stdout.fileno(), False)
        try:
            shown, sent = b"", 0
            until_s = time.monotonic() + 3 * PATIENCE_S
            for seq in count(0, 10):
                outputs.samples([corrected(seq)])
                (status,) = outputs.statuses()
                shown += running.stdout.read() or b""
                sent = max((item.sent for item in status.clients), default=0)
                if b'"xgps' in shown and sent > 20:
                    break
                assert time.monotonic() < until_s, (shown, sent)
        finally:
            os.killpg(running.pid, signal.SIGTERM)


def test_gpspipe_reads_a_running_service(tmp_path: Path) -> None:
    """Rate of turn of a device that turns counter-clockwise is minus."""
    reports = _of_gpspipe(tmp_path / "port")
    assert [report["class"] for report in reports[:3]] == ["VERSION", "DEVICES", "WATCH"]
    attitudes = [report for report in reports if report["class"] == "ATT"]
    assert len(attitudes) >= 2
    assert all(item["rot"] < -500.0 for item in attitudes)
    assert all("heading" not in item for item in attitudes)
    assert attitudes[-1]["temp"] == 25.0


def _of_gpspipe(port: Path) -> list[dict[str, Any]]:
    """Its first objects of a device that turns with 10 deg/s."""
    gpspipe = shutil.which("gpspipe")
    if gpspipe is None:
        pytest.skip("gpspipe is not installed: apt-get install gpsd-clients")
    with serving(port, "--output", "gpsd:port=0") as (serve, device):
        host, index = address_of(serve, "gpsd")
        command = [gpspipe, "-w", "-n", "8", f"{host}:{index}"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as pipe:
            assert pipe.stdout is not None
            result = [json.loads(pipe.stdout.readline()) for _ in range(3)]
            device.send(csv_at_100_hz(200))
            result += [json.loads(line) for line in pipe.stdout]
    return result
