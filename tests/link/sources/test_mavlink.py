"""Source mavlink: frames that pymavlink packs, over UDP, TCP and a pty."""

import os
import pty
import socket
from math import degrees, isnan, nan
from random import Random
from typing import Any

import pytest
from sources_support import Events, Host, read_until, serving
from support import free_port

from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.sources.mavlink import protocol_of
from gyrodrift.link.sources.mavlink_decoder import ImuChoice, MavlinkDecoder
from gyrodrift.link.sources.registry import address_of
from gyrodrift.values.errors import DeviceSilentError, PortMissingError, UsageError
from gyrodrift.values.sample import Reading

pytest.importorskip("pymavlink", reason="pymavlink is not installed: pip install 'gyrodrift[mavlink]'")

from pymavlink.dialects.v10 import common as common_1
from pymavlink.dialects.v20 import common

GRAVITY_MPS2 = 9.80665
ALL_UPDATED = 0xFFFF


class Vehicle:
    """Packs messages as an autopilot."""

    def __init__(self, system: int = 1, dialect: Any = common) -> None:
        self._dialect = dialect
        self._link = dialect.MAVLink(None, system, 1)

    def pack(self, name: str, *fields: Any, **named: Any) -> bytes:
        message = getattr(self._dialect, f"MAVLink_{name}_message")(*fields, **named)
        content: bytes = message.pack(self._link)
        self._link.seq = (self._link.seq + 1) % 256
        return content

    def highres(self, t_us: int, z_rads: float, updated: int = ALL_UPDATED, temp_c: float = 31.5) -> bytes:
        axes = (0.1, 0.2, -GRAVITY_MPS2, 0.01, 0.02, z_rads)
        return self.pack("highres_imu", t_us, *axes, *(0.0,) * 6, temp_c, updated)

    def scaled(self, t_ms: int, z_mrads: int, name: str = "scaled_imu") -> bytes:
        return self.pack(name, t_ms, 10, 20, -1000, 1, 2, z_mrads, 0, 0, 0)

    def raw(self, t_us: int, z: int) -> bytes:
        return self.pack("raw_imu", t_us, 10, 20, -1000, 1, 2, z, 0, 0, 0)

    def attitude(self, t_ms: int) -> bytes:
        return self.pack("attitude", t_ms, 0.1, 0.2, 0.3, 0.0, 0.0, 0.0)


def highres_stream(count: int, first: int = 0, vehicle: Vehicle | None = None) -> bytes:
    """HIGHRES_IMU at 100 Hz beside other messages."""
    vehicle = vehicle or Vehicle()
    steps = range(first, first + count)
    return b"".join(vehicle.highres(10_000 * step, -0.5) + vehicle.attitude(10 * step) for step in steps)


def decoded(content: bytes, choice: ImuChoice | None = None) -> tuple[list[Reading], MavlinkDecoder]:
    decoder = MavlinkDecoder(choice or ImuChoice())
    return decoder.push(content), decoder


def test_highres_imu_is_read_with_z_up() -> None:
    (reading,), decoder = decoded(Vehicle().highres(2**32 + 7_000, -0.5))
    assert (reading.t_us, reading.seq, reading.temp_c) == (7_000, None, 31.5)
    assert reading.rate_dps == pytest.approx(degrees(0.5))
    expected = (degrees(0.01), -degrees(0.02), degrees(0.5), 0.1, -0.2, GRAVITY_MPS2)
    assert reading.inertial == pytest.approx(expected, rel=1e-6)
    assert decoder.device.device_id == "MAVLink 1/1 HIGHRES_IMU"


def test_scaled_imu_has_milliradians_and_thousandths_of_g() -> None:
    content = b"".join(Vehicle().scaled(10 * step, -500) for step in range(101))
    readings, decoder = decoded(content)
    assert len(readings) == 101
    assert readings[1].t_us == 10_000
    expected = (degrees(0.001), -degrees(0.002), degrees(0.5), 0.01 * GRAVITY_MPS2, -0.02 * GRAVITY_MPS2, GRAVITY_MPS2)
    assert readings[1].inertial == pytest.approx(expected)
    assert isnan(readings[1].temp_c)
    assert decoder.counters.late == 100


@pytest.mark.parametrize("dialect", [common_1, common], ids=["version 1", "version 2"])
def test_both_versions_are_read(dialect: Any) -> None:
    readings, decoder = decoded(highres_stream(50, vehicle=Vehicle(dialect=dialect)))
    assert len(readings) == 50
    assert (decoder.counters.frames, decoder.counters.other_frames, decoder.counters.damaged) == (100, 50, 0)


def test_the_best_message_is_read_whichever_comes_first() -> None:
    """HIGHRES_IMU before SCALED_IMU before SCALED_IMU2, and never a mixture."""
    vehicle = Vehicle()
    content = b"".join(
        vehicle.scaled(10 * step, 1, "scaled_imu2") + vehicle.scaled(10 * step, 2) + vehicle.raw(10_000 * step, 3)
        for step in range(5)
    )
    content += b"".join(vehicle.scaled(10 * step, 2) + vehicle.highres(10_000 * step, -1.0) for step in range(5, 200))
    readings, decoder = decoded(content)
    assert {round(reading.rate_dps, 4) for reading in readings} == {round(degrees(1.0), 4)}
    assert len(readings) == 195
    assert decoder.counters.before_hello == 0


def test_a_message_is_read_that_the_address_names() -> None:
    vehicle = Vehicle()
    content = b"".join(vehicle.highres(1000 * step, -1.0) + vehicle.scaled(step, -500) for step in range(5))
    readings, _ = decoded(content, ImuChoice(message="scaled_imu"))
    assert [round(reading.rate_dps, 4) for reading in readings] == [round(degrees(0.5), 4)] * 5


def test_one_vehicle_is_read() -> None:
    """The first one, or the one that the address names."""
    first, second = Vehicle(1), Vehicle(2)
    content = b"".join(first.highres(1000 * step, -1.0) + second.highres(1000 * step, -2.0) for step in range(9))
    for choice, rads in ((ImuChoice(), 1.0), (ImuChoice(system=2), 2.0)):
        readings, _ = decoded(content, choice)
        assert [round(reading.rate_dps, 4) for reading in readings] == [round(degrees(rads), 4)] * 9


def test_other_vehicles_are_reported() -> None:
    first, second = Vehicle(1), Vehicle(2)
    content = b"".join(first.highres(1000 * step, -1.0) + second.highres(1000 * step, -2.0) for step in range(9))
    content += b"".join(Vehicle(system).highres(9_000, -2.0) for system in range(3, 50))
    _, decoder = decoded(content)
    assert len(decoder.counters.passed_over) == 8
    events, port = Events(), free_port()
    link = Link(LinkOptions(f"mavlink:udpin::{port}"), events)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as vehicle:
        vehicle.sendto(first.highres(1_000, -1.0) + second.highres(1_000, -2.0), ("127.0.0.1", port))
        read_until(link, lambda samples: len(samples) == 1)
    link.close()
    fields = next(fields for event, fields in events.told if event == "talkers_passed_over")
    assert fields == {
        "names": "2/1",
        "hint": "the first vehicle is used; append ?system=N to the address for another one",
    }


def test_raw_imu_is_read_with_the_unit_of_the_address_alone() -> None:
    content = b"".join(Vehicle().raw(10_000 * step, -500) for step in range(120))
    assert decoded(content)[0] == []
    for raw, dps in (("mrads", degrees(0.5)), ("lsb/16.4", 500 / 16.4)):
        address = address_of(f"mavlink:udpin:127.0.0.1:14550?raw={raw}")
        assert address is not None
        readings = protocol_of(address).decoder().push(content)
        assert readings[0].rate_dps == pytest.approx(dps)
        assert readings[0].inertial is not None
        assert isnan(readings[0].inertial.accel_z_mps2) == (raw != "mrads")


def test_a_message_without_new_rates_is_no_reading() -> None:
    """HIGHRES_IMU states which fields are new."""
    vehicle = Vehicle()
    content = vehicle.highres(1_000, -0.5, updated=0b111) + vehicle.highres(2_000, -0.5, updated=0b111000)
    assert [reading.t_us for reading in decoded(content)[0]] == [2_000]


@pytest.mark.parametrize("z_rads", [nan, float("inf"), 1e9])
def test_an_impossible_rate_is_no_reading(z_rads: float) -> None:
    assert decoded(Vehicle().highres(1_000, z_rads))[0] == []


def test_a_frame_with_unknown_flags_is_dropped() -> None:
    content = bytearray(Vehicle().highres(1_000, -0.5))
    content[2] = 0x02
    assert decoded(bytes(content))[0] == []


def test_any_split_and_any_damage_give_the_same_readings() -> None:
    random = Random(5)
    stream = bytearray(highres_stream(300))
    for _ in range(20):
        stream[random.randrange(len(stream))] ^= 1 << random.randrange(8)
    whole, decoder = decoded(bytes(stream))
    split, start = MavlinkDecoder(ImuChoice()), 0
    pieces: list[Reading] = []
    while start < len(stream):
        size = random.randrange(1, 90)
        pieces += split.push(bytes(stream[start : start + size]))
        start += size
    assert repr(pieces) == repr(whole)
    assert split.counters == decoder.counters
    assert len(whole) >= 260
    assert decoder.counters.damaged > 10
    rates = {round(reading.rate_dps, 3) for reading in whole}
    assert rates == {round(degrees(0.5), 3)}


def test_the_decoder_keeps_less_than_two_frames() -> None:
    decoder, stream = MavlinkDecoder(ImuChoice()), b"\xfd" + highres_stream(2000)
    for start in range(0, len(stream), 701):
        decoder.push(stream[start : start + 701])
        assert len(decoder._parser.buf) < 600


@pytest.mark.parametrize("host", ["127.0.0.1", ""])
def test_datagrams_of_a_vehicle_are_read(host: str) -> None:
    events, port = Events(), free_port()
    link = Link(LinkOptions(f"mavlink:udpin:{host}:{port}"), events)
    for first in (5_000, 0):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as vehicle:
            for step in range(first, first + 60):
                vehicle.sendto(highres_stream(1, step), ("127.0.0.1", port))
            if link.port is not None and first == 0:
                link.port._understood_s = float("-inf")  # type: ignore[attr-defined] # the silence of a restart
            samples = read_until(link, lambda samples: len(samples) >= 59)
    link.close()
    assert samples[-1].rate_dps == pytest.approx(degrees(0.5))
    assert link.counters.device_resets == 1
    assert "device" in events.names()


def test_a_server_of_frames_is_read_and_read_again_when_it_comes_back() -> None:
    events = Events()
    with serving() as server:
        port = server.getsockname()[1]
        link = Link(LinkOptions(f"mavlink:tcp:127.0.0.1:{port}"), events)
        connection, _ = server.accept()
        with connection:
            connection.sendall(highres_stream(100))
            read_until(link, lambda samples: len(samples) == 100)
    read_until(link, lambda _: link.port is None)
    with serving(port) as server:
        read_until(link, lambda _: link.port is not None)
        connection, _ = server.accept()
        with connection:
            connection.sendall(highres_stream(100, 150))
            samples = read_until(link, lambda samples: len(samples) >= 99)
        link.close()
    assert samples[-1].t_device_s == pytest.approx(2.49)
    assert (link.counters.reconnects, link.counters.gaps) == (1, 1)


def test_a_serial_line_is_read() -> None:
    master, slave = pty.openpty()
    link = Link(LinkOptions(f"mavlink:{os.ttyname(slave)},115200"), Events())
    os.write(master, highres_stream(20))
    assert len(read_until(link, lambda samples: len(samples) == 20)) == 20
    link.close()
    os.close(master)
    os.close(slave)


def test_a_vehicle_without_rates_is_an_error_with_advice() -> None:
    port = free_port()
    with Host(f"mavlink:udpin::{port}", timeout_s=3.0) as host:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as vehicle:
            for step in range(20):
                vehicle.sendto(Vehicle().raw(step, 1), ("127.0.0.1", port))
        read_until(host.link, lambda _: host.link.counters.bytes > 400)
        with pytest.raises(DeviceSilentError, match=r"good mavlink frames .* none with a yaw rate; .* \?raw=mrads"):
            host.read(3.0)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("mavlink:udpin:127.0.0.1:x", r"expected mavlink:udpin:\[HOST\]:PORT with a port"),
        ("mavlink:", r"expected mavlink:udpin:\[HOST\]:PORT, mavlink:tcp:HOST:PORT or mavlink:PATH"),
        ("mavlink:udpin::14550?system=0", "system=0 is no number from 1 to 255"),
        ("mavlink:udpin::14550?system=00019", "system=00019 is no number from 1 to 255"),
        ("mavlink:udpin::14550?message=attitude", "message=attitude has no gyro; there are highres_imu, scaled_imu"),
        ("mavlink:udpin::14550?raw=dps", r"raw=dps is no unit of RAW_IMU; expected mrads .* or lsb/N"),
        ("mavlink:udpin::14550?sytem=1", "'sytem=1' is no option of this source; there are system=… and message=…"),
    ],
)
def test_a_wrong_address_is_an_error(text: str, expected: str) -> None:
    with pytest.raises(UsageError, match=expected):
        Link(LinkOptions(text), Events())


def test_a_serial_line_that_is_not_there_is_an_error() -> None:
    with pytest.raises(PortMissingError, match="there is no such port"):
        Link(LinkOptions("mavlink:/dev/ttyNone0"), Events())
