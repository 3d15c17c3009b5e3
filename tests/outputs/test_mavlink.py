"""MAVLink as pymavlink reads it, over UDP and a pty, and as MAVProxy shows it."""

import os
import pty
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from math import atan2, degrees, isnan, nan, pi, radians
from pathlib import Path
from typing import Any

import pytest
from outputs_support import HubThread, corrected, csv_at_100_hz, hub, serving, tilted
from support import PATIENCE_S, never

from gyrodrift.outputs.mavlink import PITCH, POSITION, ROLL, UNKNOWN_VARIANCE, YAW
from gyrodrift.outputs.status import ConfigStatus, LinkStatus, ServiceStatus
from gyrodrift.service.control_client import ControlClient

pytest.importorskip("pymavlink", reason="pymavlink is not installed: pip install 'gyrodrift[mavlink]'")

from pymavlink import mavutil
from pymavlink.dialects.v20 import common
from pymavlink.quaternion import QuaternionBase


class Station:
    """A ground station: decodes what comes in on a socket."""

    def __init__(self, receiver: socket.socket) -> None:
        self._receiver = receiver
        self._link = common.MAVLink(None)
        self.port = receiver.getsockname()[1]

    def next(self, kind: str) -> Any:
        """The next message of a kind."""
        until_s = time.monotonic() + PATIENCE_S
        while time.monotonic() < until_s:
            result = self._link.parse_buffer(self._receiver.recv(4096)) or []
            for item in result:
                if item.get_type() == kind:
                    return item
        raise AssertionError(kind)

    def next_of_any(self) -> str:
        """Kind of the next message; a datagram has one."""
        (result,) = self._link.parse_buffer(self._receiver.recv(4096))
        return str(result.get_type())


@contextmanager
def listening() -> Iterator[Station]:
    with closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as receiver:
        receiver.bind(("127.0.0.1", 0))
        receiver.settimeout(PATIENCE_S)
        yield Station(receiver)


def yaw_deg(q: list[float]) -> float:
    return degrees(2.0 * atan2(q[3], q[0]))


def test_odometry_is_clockwise_with_covariance() -> None:
    """A turn to the left is negative in axes forward, right, down."""
    with listening() as station, hub(f"mavlink:port={station.port}") as outputs:
        outputs.samples([corrected(100, yaw_deg=90.0, corrected_dps=2.0, yaw_sigma_deg=0.5)])
        got = station.next("ODOMETRY")
    assert yaw_deg(got.q) == pytest.approx(-90.0, abs=1e-4)
    assert got.yawspeed == pytest.approx(radians(-2.0))
    assert (got.frame_id, got.child_frame_id) == (common.MAV_FRAME_LOCAL_FRD, common.MAV_FRAME_BODY_FRD)
    assert got.pose_covariance[YAW] == pytest.approx(radians(0.5) ** 2)
    assert [got.pose_covariance[item] for item in POSITION] == [UNKNOWN_VARIANCE] * 3
    assert got.time_usec == 1_700_000_001_000_000
    assert (got.get_srcSystem(), got.get_srcComponent(), got.quality) == (1, 200, 90)


def test_without_sigma_the_covariance_is_unknown() -> None:
    """NaN in the first element, and an estimator without covariance."""
    with listening() as station, hub(f"mavlink:port={station.port}") as outputs:
        outputs.samples([corrected(100, yaw_sigma_deg=nan, bias_sigma_dps=nan, confidence=nan)])
        got = station.next("ODOMETRY")
    assert isnan(got.pose_covariance[0])
    assert isnan(got.velocity_covariance[0])
    assert (got.estimator_type, got.quality) == (common.MAV_ESTIMATOR_TYPE_NAIVE, 0)


def test_ned_is_the_heading_and_waits_for_it() -> None:
    with listening() as station, hub(f"mavlink:port={station.port},frame=ned,message=attitude") as outputs:
        outputs.samples([corrected(0, heading_deg=nan), corrected(100, heading_deg=270.0)])
        attitude, covariance = station.next("ATTITUDE"), station.next("ATTITUDE_QUATERNION_COV")
    assert attitude.time_boot_ms == 1000
    assert attitude.yaw == pytest.approx(-pi / 2.0)
    assert yaw_deg(covariance.q) == pytest.approx(-90.0, abs=1e-4)
    assert covariance.covariance[8] == pytest.approx(radians(0.5) ** 2)


TILT_RATES = [radians(rate) for rate in (2.0 - 0.1, 3.0 + 0.2, -(1.5 - 0.25))]
"""Rates of `tilted` about forward, right and down, without the drift."""


@pytest.mark.promise("Clients of outputs")
def test_a_tilted_device_sends_its_attitude() -> None:
    """Pymavlink reads roll, pitch and yaw from a quaternion and from angles, and they agree."""
    with listening() as station, hub(f"mavlink:port={station.port},message=attitude") as outputs:
        outputs.samples([tilted(100)])
        attitude = station.next("ATTITUDE")
        quaternion, covariance = station.next("ATTITUDE_QUATERNION"), station.next("ATTITUDE_QUATERNION_COV")
    angles = attitude.roll, attitude.pitch, attitude.yaw
    yaw = 2.0 * atan2(quaternion.q4, quaternion.q1)
    assert degrees(yaw) == pytest.approx(-30.0, abs=1e-4)
    assert [degrees(angle) for angle in angles[:2]] == pytest.approx([10.0, 20.0], abs=1e-4)
    q = QuaternionBase([quaternion.q1, quaternion.q2, quaternion.q3, quaternion.q4])
    assert list(q.euler) == pytest.approx(angles, abs=1e-5)
    assert list(covariance.q) == pytest.approx([quaternion.q1, quaternion.q2, quaternion.q3, quaternion.q4])
    for message in (attitude, quaternion, covariance):
        assert [message.rollspeed, message.pitchspeed, message.yawspeed] == pytest.approx(TILT_RATES)
    assert covariance.covariance[0] == covariance.covariance[4] == pytest.approx(radians(0.4) ** 2)


def test_odometry_of_a_tilted_device_has_three_rates() -> None:
    with listening() as station, hub(f"mavlink:port={station.port},frame=ned") as outputs:
        outputs.samples([tilted(100, heading_deg=330.0)])
        got = station.next("ODOMETRY")
    assert [got.rollspeed, got.pitchspeed, got.yawspeed] == pytest.approx(TILT_RATES)
    assert got.pose_covariance[ROLL] == got.pose_covariance[PITCH] == pytest.approx(radians(0.4) ** 2)
    assert got.velocity_covariance[ROLL] == got.velocity_covariance[YAW] == pytest.approx(radians(0.01) ** 2)
    roll, pitch, _ = QuaternionBase(list(got.q)).euler
    assert [degrees(roll), degrees(pitch)] == pytest.approx([10.0, 20.0], abs=1e-4)
    assert yaw_deg(got.q) == pytest.approx(-30.0, abs=1e-4)


def test_rates_are_about_the_axes_of_the_device() -> None:
    with listening() as station, hub(f"mavlink:port={station.port}") as outputs:
        outputs.status(ServiceStatus(config=ConfigStatus(mount={"up": "+x", "forward": "+y"})))
        outputs.samples([tilted(100)])
        got = station.next("ODOMETRY")
    expected = [radians(rate) for rate in (-3.0 - 0.2, -(1.5 - 0.25), -(2.0 - 0.1))]
    assert [got.rollspeed, got.pitchspeed, got.yawspeed] == pytest.approx(expected)


def test_without_a_sigma_of_tilt_the_option_counts() -> None:
    sample = tilted(100)
    assert sample.attitude is not None
    with listening() as station, hub(f"mavlink:port={station.port},tilt_sigma_deg=2") as outputs:
        outputs.samples([sample._replace(attitude=sample.attitude._replace(tilt_sigma_deg=nan))])
        got = station.next("ODOMETRY")
    assert got.pose_covariance[ROLL] == pytest.approx(radians(2.0) ** 2)


def test_a_device_with_one_axis_sends_no_attitude_quaternion() -> None:
    with listening() as station, hub(f"mavlink:port={station.port},message=attitude") as outputs:
        outputs.samples([corrected(0), corrected(100)])
        assert [station.next_of_any() for _ in range(4)] == ["ATTITUDE", "ATTITUDE_QUATERNION_COV"] * 2


@pytest.mark.parametrize(
    ("frame", "event", "step"),
    [
        ("frd", "yaw_zeroed", 1),
        ("frd", "heading_set", 0),
        ("ned", "heading_set", 1),
        ("ned", "yaw_zeroed", 0),
        ("frd", "device_reset", 1),
        ("ned", "link_restored", 1),
        ("frd", "gap", 0),
    ],
)
def test_what_makes_yaw_jump_is_counted(frame: str, event: str, step: int) -> None:
    """An autopilot begins its estimate again where the counter changes, and nowhere else."""
    with listening() as station, hub(f"mavlink:port={station.port},frame={frame}") as outputs:
        outputs.samples([corrected(0)])
        before = station.next("ODOMETRY").reset_counter
        outputs.event(event)
        outputs.samples([corrected(100)])
        assert station.next("ODOMETRY").reset_counter == (before + step) % 256


@pytest.mark.parametrize(
    ("link", "state"),
    [
        (LinkStatus(is_open=True, silent_s=0.1), common.MAV_STATE_ACTIVE),
        (LinkStatus(is_open=True, silent_s=9.0), common.MAV_STATE_UNINIT),
        (LinkStatus(is_open=False), common.MAV_STATE_UNINIT),
    ],
)
def test_the_heartbeat_says_whether_samples_come(link: LinkStatus, state: int) -> None:
    with listening() as station, hub(f"mavlink:port={station.port}") as outputs:
        outputs.status(ServiceStatus(link=link))
        got = station.next("HEARTBEAT")
    assert (got.type, got.autopilot) == (common.MAV_TYPE_IMU, common.MAV_AUTOPILOT_INVALID)
    assert got.system_status == state


def test_a_serial_line_gets_the_same() -> None:
    numbers = [*range(1000), 2000]
    time_us = [round(corrected(seq).sample.t_host_s * 1e6) for seq in numbers]
    master, slave = pty.openpty()
    try:
        with hub(f"mavlink:device={os.ttyname(slave)},rate_hz=100") as outputs:
            outputs.samples([corrected(seq) for seq in numbers[:-1]])
            while not (status := outputs.statuses()[0]).dropped:
                pass
            assert status.sent + status.dropped == 1000
            reader = common.MAVLink(None)
            got: list[Any] = []
            while len(got) < status.sent - 1:  # of the last one a part waits still
                got += reader.parse_buffer(os.read(master, 1 << 16)) or []
            outputs.samples([corrected(numbers[-1])])
            while got[-1].time_usec != time_us[-1]:  # the rest of one that was begun comes first
                got += reader.parse_buffer(os.read(master, 1 << 16)) or []
    finally:
        os.close(master)
        os.close(slave)
    assert {item.get_type() for item in got} == {"ODOMETRY"}
    assert len(got) == status.sent + 1
    came = [time_us.index(item.time_usec) for item in got]
    assert came == sorted(set(came))
    assert [item.get_seq() for item in got] == [number % 256 for number in came]


def test_a_line_that_goes_is_tried_again() -> None:
    master, slave = pty.openpty()
    name = os.ttyname(slave)
    os.close(slave)
    with hub(f"mavlink:device={name}") as outputs:
        os.close(master)
        outputs.samples([corrected(0)])
        while not (problem := outputs.statuses()[0].problem):
            pass
    assert "is gone" in problem or "No such file" in problem


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ("device=/nowhere", "No such file"),
        ("device=/dev/null", "no serial line"),
        ("baud=7,device=/dev/null", "7 baud"),
    ],
)
def test_a_line_that_cannot_be_had_is_explained(options: str, says: str) -> None:
    with hub() as outputs:
        outputs.want(f"mavlink:{options}")
        while not (result := outputs.statuses()) or "being opened" in result[0].problem:
            pass
    assert says in result[0].problem


def test_the_command_sends_to_a_ground_station(tmp_path: Path) -> None:
    with closing(mavutil.mavlink_connection("udpin:127.0.0.1:0", dialect="common")) as station:
        tty, output = tmp_path / "tty", f"mavlink:port={station.port.getsockname()[1]}"
        control = tmp_path / "control"
        options = ("--protocol", "csv", "--filter", "hdr", "--output", output, "--control", control)
        with serving(tty, *options) as (serve, device):
            serve.until(lambda it: "output_open" in it.log, "an open output")
            device.send_all(csv_at_100_hz(300), never)
            turn = station.recv_match(
                type="ODOMETRY", condition="ODOMETRY.q[3] < -0.1", blocking=True, timeout=PATIENCE_S
            )
            assert station.recv_match(type="HEARTBEAT", blocking=True, timeout=PATIENCE_S) is not None
            with ControlClient(control, PATIENCE_S) as person:
                assert person.ask("zero")["ok"]
            device.send_all(csv_at_100_hz(20, first=300), never)
            zeroed = station.recv_match(
                type="ODOMETRY", condition="abs(ODOMETRY.q[3]) < 0.05", blocking=True, timeout=PATIENCE_S
            )
    assert turn is not None
    assert turn.yawspeed < 0.0
    assert zeroed is not None
    assert zeroed.reset_counter == (turn.reset_counter + 1) % 256


MAVPROXY = Path(sys.executable).with_name("mavproxy.py")


@pytest.mark.skipif(not MAVPROXY.exists(), reason="MAVProxy is not installed: pip install MAVProxy")
def test_mavproxy_shows_it(tmp_path: Path) -> None:
    with listening() as free:
        port = free.port
    options = (f"--master=udpin:127.0.0.1:{port}", "--nowait", f"--state-basedir={tmp_path}", "--default-modules=")
    with (
        subprocess.Popen(
            [sys.executable, MAVPROXY, *options, "--cmd=watch ODOMETRY"],
            cwd=tmp_path,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            env=os.environ | {"PYTHONUNBUFFERED": "1", "HOME": str(tmp_path)},
        ) as mavproxy,
        hub() as outputs,
    ):
        try:
            outputs.want(f"mavlink:port={port}")
            outputs.opened()
            shown = said_by(mavproxy, outputs)
        finally:
            mavproxy.kill()
    assert "Detected vehicle 1:200" in shown
    assert f"frame_id : {common.MAV_FRAME_LOCAL_FRD}" in shown


def said_by(mavproxy: "subprocess.Popen[bytes]", outputs: HubThread) -> str:
    assert mavproxy.stdout is not None
    os.set_blocking(mavproxy.stdout.fileno(), False)
    text, until_s, seq = "", time.monotonic() + PATIENCE_S, 0
    while not ("Detected" in text and "child_frame_id" in text):
        assert time.monotonic() < until_s, text
        assert mavproxy.poll() is None, text
        outputs.samples([corrected(seq)])
        outputs.status(ServiceStatus(link=LinkStatus(is_open=True)))
        outputs.statuses()
        seq += 100
        text += (mavproxy.stdout.read() or b"").decode()
    return text
