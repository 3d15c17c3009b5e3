"""NMEA 0183 over TCP, UDP and a pty: read by pynmeagps, and by gpsd as if it were a receiver on a serial port."""

import json
import shutil
import socket
import subprocess
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from itertools import count
from math import radians
from pathlib import Path

import pytest
from outputs_support import HubThread, Reader, connected, corrected, tilted
from serial import Serial
from signalk_support import signalk_server
from support import PATIENCE_S, free_port

from gyrodrift.outputs.nmea import sentences

pynmeagps = pytest.importorskip("pynmeagps", reason="NMEA 0183 is an extra: pip install 'gyrodrift[nmea]'")

nan = float("nan")


def fields(sentence: bytes) -> dict[str, object]:
    result = pynmeagps.NMEAReader.parse(sentence, validate=pynmeagps.VALCKSUM)
    return {"id": result.identity} | {key: value for key, value in vars(result).items() if not key.startswith("_")}


def are_of_the_sample(answer: list[bytes]) -> bool:
    heading, rate, temperature = map(fields, answer)
    return (
        heading == {"id": "IIHDT", "headingT": 90.0, "headingTu": "T"}
        and rate == {"id": "IIROT", "rot": -75.0, "valid": "A"}
        and list(temperature.values()) == ["IIXDR", "C", 25.0, "C", "GYRO"]
    )


def test_sentences_have_what_is_known() -> None:
    assert are_of_the_sample(sentences(corrected(0)))
    sample = corrected(0, heading_deg=nan)
    assert [item[3:6] for item in sentences(sample._replace(sample=sample.sample._replace(temp_c=nan)))] == [b"ROT"]
    assert fields(sentences(corrected(0, heading_deg=359.999))[0])["headingT"] == 0.0


def test_a_tilted_device_has_pitch_and_roll() -> None:
    """Bow up and starboard down are positive, under the names that plotters know."""
    statement = [sentence.decode() for sentence in sentences(tilted(0))]
    assert statement[2][:-5] == "$IIXDR,A,20.00,D,PTCH,A,10.00,D,ROLL"
    assert list(fields(statement[2].encode()).values()) == ["IIXDR", "A", 20.0, "D", "PTCH", "A", 10.0, "D", "ROLL"]
    assert are_of_the_sample([sentence.encode() for sentence in (statement[0], statement[1], statement[3])])
    assert "A,0.00,D,ROLL" in sentences(tilted(0, roll_deg=-0.001))[2].decode()


def test_over_tcp(outputs: HubThread) -> None:
    outputs.want("nmea:port=0")
    with connected(outputs.endpoint()) as client:
        client.connection.sendall(b"$ECRMB,A*00\r\n")
        while outputs.statuses()[0].client_count == 0:
            pass
        outputs.samples([corrected(seq) for seq in range(11)])
        statement = [client.line() + b"\n" for _ in range(6)]
    assert are_of_the_sample(statement[:3])
    assert are_of_the_sample(statement[3:])


def test_over_udp(outputs: HubThread) -> None:
    with closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as receiver:
        receiver.bind(("127.0.0.1", 0))
        receiver.settimeout(PATIENCE_S)
        outputs.want(f"nmea:to=udp,port={receiver.getsockname()[1]}")
        outputs.opened()
        outputs.samples([corrected(0)])
        assert are_of_the_sample([receiver.recv(200) for _ in range(3)])


def test_over_a_pty(outputs: HubThread, tmp_path: Path) -> None:
    link = tmp_path / "gyro"
    outputs.want(f"nmea:to=pty,path={link}")
    outputs.opened()
    outputs.samples([corrected(seq) for seq in range(0, 10_000, 10)])
    while (status := outputs.statuses()[0]).sent + status.dropped != 3000:
        pass
    assert status.dropped > 0
    with Serial(str(link), timeout=PATIENCE_S) as port:
        port.reset_input_buffer()
        port.write(b"$PUBX,00*33\r\n")
        outputs.samples([corrected(20_000)])
        assert are_of_the_sample([port.readline() for _ in range(3)])
    outputs.want()
    while outputs.statuses():
        pass
    assert not link.is_symlink()


def test_a_file_at_the_path_is_left_alone(outputs: HubThread, tmp_path: Path) -> None:
    there = tmp_path / "gyro"
    there.write_text("mine")
    outputs.want(f"nmea:to=pty,path={there}")
    while not (problem := next((statuse.problem for statuse in outputs.statuses()), "")):
        pass
    assert problem == f"{there} exists and is no link to a pty; choose another with path="
    assert there.read_text() == "mine"


@pytest.mark.promise("Clients of outputs")
@pytest.mark.parametrize("target", ["notes.txt", "/dev/null", "gone"])
def test_a_link_that_leads_elsewhere_is_left_alone(outputs: HubThread, tmp_path: Path, target: str) -> None:
    """A link to another file at the path of a pty is kept."""
    (tmp_path / "notes.txt").write_text("mine")
    link = tmp_path / "gyro"
    link.symlink_to(target)
    outputs.want(f"nmea:to=pty,path={link}")
    while not (problem := next((statuse.problem for statuse in outputs.statuses()), "")):
        pass
    assert problem == f"{link} exists and is no link to a pty; choose another with path="
    assert str(link.readlink()) == target


def test_a_link_that_was_left_behind_is_replaced(outputs: HubThread, tmp_path: Path) -> None:
    link = tmp_path / "gyro"
    link.symlink_to("/dev/pts/999999")
    outputs.want(f"nmea:to=pty,path={link}")
    assert outputs.opened()[0].address == str(link)
    assert link.exists()


def test_gpsd_reads_the_pty(outputs: HubThread, tmp_path: Path) -> None:
    outputs.want(f"nmea:to=pty,path={tmp_path / 'gyro'}")
    outputs.opened()
    with gpsd_of(tmp_path / "gyro") as client:
        client.connection.sendall(b'?WATCH={"enable":true,"json":true,"raw":1};\n')
        client.connection.settimeout(0.1)
        statement: list[bytes] = []
        until_s = time.monotonic() + PATIENCE_S
        for seq in count(0, 10):
            outputs.samples([tilted(seq)])
            try:
                statement.append(client.line().rstrip())
            except TimeoutError:
                assert time.monotonic() < until_s, statement
                continue
            if any(b'"ATT"' in item for item in statement) and any(b"PTCH" in item for item in statement):
                break
    attitude = next(json.loads(item) for item in statement if b'"ATT"' in item)
    assert attitude["heading"] == 90.0
    assert {sentence.rstrip() for sentence in sentences(tilted(0))[1:3]} <= set(statement)


@contextmanager
def gpsd_of(device: Path) -> Iterator[Reader]:
    """A client of a gpsd that reads a device."""
    gpsd = shutil.which("gpsd") or shutil.which("gpsd", path="/usr/sbin")
    if gpsd is None:
        pytest.skip("gpsd is not installed: apt-get install gpsd")
    with closing(socket.create_server(("127.0.0.1", 0))) as free:
        port = free.getsockname()[1]
    with subprocess.Popen([gpsd, "-N", "-n", "-b", "-S", str(port), device.resolve()], stderr=subprocess.DEVNULL) as it:
        try:
            with connected_soon(port) as client:
                yield client
        finally:
            it.terminate()


@contextmanager
def connected_soon(port: int) -> Iterator[Reader]:
    """Once it listens."""
    until_s = time.monotonic() + PATIENCE_S
    while True:
        try:
            connection = socket.create_connection(("127.0.0.1", port), PATIENCE_S)
            break
        except ConnectionRefusedError:
            assert time.monotonic() < until_s
            time.sleep(0.05)
    with connection:
        yield Reader(connection)


def test_signalk_server_shows_heading_and_rate_of_turn(outputs: HubThread, tmp_path: Path) -> None:
    nmea = free_port()
    outputs.want(f"nmea:port={nmea}")
    outputs.opened()
    source = {"type": "tcp", "host": "127.0.0.1", "port": str(nmea), "validateChecksum": True}
    with signalk_server("NMEA0183", source, tmp_path) as server:
        shown = server.navigation("rateOfTurn", lambda seq: outputs.samples([corrected(seq)]))
    assert shown["headingTrue"]["value"] == pytest.approx(radians(90.0))
    assert (shown["rateOfTurn"]["value"], shown["rateOfTurn"]["meta"]["units"]) == (
        pytest.approx(radians(-1.25), rel=1e-3),
        "rad/s",
    )
