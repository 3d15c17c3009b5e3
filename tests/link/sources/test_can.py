"""Source can: python-can's virtual bus and its bus over UDP multicast, DBC files, and the gyros that have a name."""

import os
import socket
import struct
import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager
from itertools import count
from math import degrees, isnan
from pathlib import Path
from random import Random
from typing import Any

import pytest
from fuzz.source_target import is_valid
from sources_support import Events, Host, read_until

from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.second_source import SecondSource
from gyrodrift.link.sources import can_dbc
from gyrodrift.link.sources.can import gyro_of
from gyrodrift.link.sources.can_frames import EXTENDED, CanGyro, CanReadings
from gyrodrift.link.sources.opening import open_port
from gyrodrift.link.sources.registry import address_of
from gyrodrift.values.errors import DeviceSilentError, LinkError, UsageError
from gyrodrift.values.sample import Reading, Sample

can = pytest.importorskip("can", reason="python-can is not installed: pip install 'gyrodrift[can]'")
pytest.importorskip("cantools", reason="cantools is not installed: pip install 'gyrodrift[can]'")

GRAVITY_MPS2 = 9.80665
BOSCH_ZERO = 0x8000
MULTICAST = "can:239.74.163.2?gyro=bosch-mm7.10&interface=udp_multicast"

DBC = """VERSION ""
BU_: ESC
BO_ 176 ESP_Sensors: 8 ESC
 SG_ YawRate : 0|16@1- (0.01,0) [-327|327] "deg/s" ESC
 SG_ Counter : 56|8@1+ (1,0) [0|255] "" ESC
BO_ 177 ESP_Forces: 8 ESC
 SG_ LatAccel : 0|16@1- (0.001,0) [-32|32] "g" ESC
BO_ 2364540158 Rates: 8 ESC
 SG_ Yaw : 0|16@1- (0.001,0) [-32|32] "rad/s" ESC
 SG_ Roll : 16|16@1- (0.001,0) [-32|32] "rad/s" ESC
 SG_ Pitch : 32|16@1- (0.001,0) [-32|32] "rad/s" ESC
BO_ 179 Odd: 8 ESC
 SG_ YawRate2 : 0|16@1- (0.01,0) [-327|327] "1" ESC
 SG_ Twice : 16|16@1- (0.01,0) [-327|327] "deg/s" ESC
BO_ 180 Odd2: 8 ESC
 SG_ Twice : 16|16@1- (0.01,0) [-327|327] "deg/s" ESC
"""


@pytest.fixture
def dbc(tmp_path: Path) -> Path:
    path = tmp_path / "car.dbc"
    path.write_text(DBC)
    return path


def gyro_at(text: str) -> CanGyro:
    address = address_of(text)
    assert address is not None
    return gyro_of(address)


def bosch(step: int, rate_dps: float) -> list[tuple[int, bytes]]:
    """Frames of one measurement of an MM7.10 at rest on its base, which turns."""
    values = ((0x174, rate_dps, 0.0), (0x178, 1.0, 0.1), (0x17C, 2.0, 1.0))
    return [
        (
            number,
            struct.pack("<HHHH", BOSCH_ZERO + round(rate / 0.005), 0, BOSCH_ZERO + round(force / 0.000127465), step),
        )
        for number, rate, force in values
    ]


def xsens(step: int, z_rads: float) -> list[tuple[int, bytes]]:
    rates, forces = (0.0, 0.25, z_rads), (0.0, 0.5, 9.8125)
    return [
        (0x005, struct.pack(">I", 100 * step)),
        (0x006, struct.pack(">H", step & 0xFFFF)),
        (0x032, struct.pack(">3h", *(round(rate * 512) for rate in rates))),
        (0x034, struct.pack(">3h", *(round(force * 256) for force in forces))),
    ]


def readings_of(text: str, measurements: list[list[tuple[int, bytes]]]) -> list[Reading]:
    """Readings of frames with reception 10 ms apart."""
    gyro = CanReadings(gyro_at(text))
    frames = ((10_000 * step, *frame) for step, frames in enumerate(measurements) for frame in frames)
    return [reading for frame in frames if (reading := gyro.reading(*frame)) is not None]


def test_signals_of_a_second_source_are_values(dbc: Path) -> None:
    """Signals of a car, by the names of a DBC file; other frames are passed by."""
    with bus(interface="virtual", channel="car") as sender:
        port = open_port(f"can:car?dbc={dbc}&signals=YawRate&interface=virtual", 0)
        for number in (177, 176):
            sender.send(can.Message(arbitration_id=number, data=bytes([200, 0, *[0] * 6]), is_extended_id=False))
        (aid,) = SecondSource("car", "YawRate=turn_rate").take(port.read())
        port.close()
    assert (aid.name, aid.kind) == ("car.YawRate", "turn_rate")
    assert aid.value == pytest.approx(2.0)


def test_a_bosch_sensor_has_three_axes() -> None:
    readings = readings_of("can:x?gyro=bosch-mm7.10", [bosch(step, 12.5) for step in range(10)])
    assert [reading.t_us for reading in readings] == [10_000 * step for step in range(1, 10)]
    expected = (1.0, 2.0, 12.5, 0.1 * GRAVITY_MPS2, 0.0, GRAVITY_MPS2)
    assert readings[0].inertial == pytest.approx(expected, abs=2e-3)
    assert readings[0].rate_dps == pytest.approx(12.5)


def test_a_bosch_sensor_without_pitch_rate_has_one_axis() -> None:
    readings = readings_of("can:x?gyro=bosch-mm5.10", [bosch(step, -3.0) for step in range(5)])
    assert [reading.rate_dps for reading in readings] == pytest.approx([-3.0] * 4)
    assert {reading.inertial for reading in readings} == {None}


def test_the_ids_of_a_gyro_can_be_others() -> None:
    frames = [[(new, content) for new, (_, content) in zip((0x70, 0x80, 0x576), bosch(0, 4.0), strict=True)]] * 3
    readings = readings_of("can:x?gyro=bosch-mm5.10&ids=0x70,0x80,0x576", frames)
    assert [reading.rate_dps for reading in readings] == [pytest.approx(4.0)] * 2


def test_xsens_brings_its_clock_and_its_counter() -> None:
    readings = readings_of("can:x?gyro=xsens", [xsens(step, 0.5) for step in range(10)])
    assert [(reading.t_us, reading.seq) for reading in readings] == [(10_000 * step, step) for step in range(1, 10)]
    expected = (0.0, degrees(0.25), degrees(0.5), 0.0, 0.5, 9.8125)
    assert readings[0].inertial == pytest.approx(expected)


def test_a_bus_that_is_joined_within_a_measurement_mixes_nothing() -> None:
    """The rest of the first measurement is dropped."""
    measurements = [xsens(step, 0.5 * step) for step in range(5)]
    measurements[0] = measurements[0][3:]
    readings = readings_of("can:x?gyro=xsens", measurements)
    assert [reading.seq for reading in readings] == [1, 2, 3, 4]
    assert [reading.rate_dps for reading in readings] == pytest.approx([degrees(0.5 * step) for step in range(1, 5)])


def test_a_lost_frame_costs_its_values_alone() -> None:
    measurements = [xsens(step, 0.5) for step in range(12)]
    del measurements[5][3]
    del measurements[8][0]
    readings = readings_of("can:x?gyro=xsens", measurements)
    assert [reading.seq for reading in readings] == [1, 2, 3, 4, 5, 6, 7, 9, 10, 11]
    assert readings[4].inertial is not None
    assert isnan(readings[4].inertial.accel_z_mps2)


def test_an_upside_down_gyro_is_read_with_z_up() -> None:
    readings = readings_of("can:x?gyro=bosch-mm7.10&z=down", [bosch(step, 12.5) for step in range(3)])
    assert readings[0].rate_dps == pytest.approx(-12.5)
    assert readings[0].inertial is not None
    assert readings[0].inertial[:3] == pytest.approx((1.0, -2.0, -12.5))


def test_a_signal_of_a_dbc_file_is_read(dbc: Path) -> None:
    address = f"can:x?dbc={dbc}&signal=YawRate"
    readings = readings_of(address, [[(176, struct.pack("<h6x", 1234))] for _ in range(4)])
    assert [reading.rate_dps for reading in readings] == [pytest.approx(12.34)] * 3
    assert CanReadings(gyro_at(address)).device.device_id == "YawRate"


def test_three_axes_of_a_dbc_file_are_read(dbc: Path) -> None:
    """Radians become degrees; the message has an id of 29 bits."""
    number = (2364540158 & 0x1FFFFFFF) | EXTENDED
    frames = [[(177, struct.pack("<h6x", 500)), (number, struct.pack("<3h2x", 500, 100, 200))] for _ in range(4)]
    readings = readings_of(f"can:x?dbc={dbc}&signal=Rates.Yaw&x=Roll&y=Pitch&ay=LatAccel", frames)
    assert readings[0].inertial is not None
    assert readings[0].inertial[:3] == pytest.approx((degrees(0.1), degrees(0.2), degrees(0.5)))


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ("", r"expected can:CHANNEL\?dbc=FILE&signal=NAME, or can:CHANNEL\?gyro=NAME with bosch-mm5.10"),
        ("?gyro=x", "gyro=x is unknown; there are bosch-mm5.10"),
        ("?dbc={dbc}", r"expected can:CHANNEL\?dbc=FILE&signal=NAME"),
        ("?dbc={dbc}&signal=Gier", "has no signal Gier; some of its signals: YawRate, "),
        ("?dbc={dbc}&signal=Twice", "signal=Twice is ambiguous; write one of Odd.Twice, Odd2.Twice"),
        ("?dbc={dbc}&signal=YawRate2", "YawRate2 has the unit '1' in the DBC file; append unit=dps or unit=mdps"),
        ("?dbc={dbc}&signal=YawRate&unit=turns", "unit=turns is unknown; append unit=dps"),
        ("?dbc={dbc}.x&signal=YawRate", r"cannot read .*car.dbc.x: No such file"),
        ("?gyro=xsens&z=left", "z=left is unknown; expected z=up or z=down"),
        ("?gyro=bosch-mm5.10&ids=1,2", "ids=1,2 has not 3 different ids"),
        ("?gyro=bosch-mm5.10&ids=1,2,x", "'x' is no number from 0 to 0x1fffffff"),
    ],
)
def test_a_wrong_address_is_an_error(dbc: Path, options: str, expected: str) -> None:
    with pytest.raises(UsageError, match=expected):
        Link(LinkOptions(f"can:vcan0{options.format(dbc=dbc)}"), Events())


def test_a_file_that_is_no_database_is_an_error(tmp_path: Path) -> None:
    path = tmp_path / "x.dbc"
    path.write_text("nothing")
    with pytest.raises(UsageError, match=r"x\.dbc is no database of CAN messages"):
        Link(LinkOptions(f"can:vcan0?dbc={path}&signal=YawRate"), Events())


def test_a_unit_that_the_file_lacks_is_given_by_the_address(dbc: Path) -> None:
    measurements = [[(179, struct.pack("<h6x", 100))]] * 3
    readings = readings_of(f"can:x?dbc={dbc}&signal=YawRate2&unit=rads", measurements)
    assert readings[0].rate_dps == pytest.approx(degrees(1.0))


def test_any_content_gives_valid_readings(dbc: Path) -> None:
    """Frames of any length, also those that do not fit the DBC file."""
    random = Random(3)
    for text in ("gyro=xsens", "gyro=bosch-mm7.10", f"dbc={dbc}&signal=YawRate&ay=LatAccel"):
        gyro = gyro_at(f"can:x?{text}")
        readings = CanReadings(gyro)
        for _ in range(2000):
            content = random.randbytes(random.choice((0, 2, 4, 6, 8)))
            reading = readings.reading(0, random.choice(sorted(gyro.ids)), content)
            assert reading is None or is_valid(reading)


@contextmanager
def bus(**settings: Any) -> Iterator[Any]:
    opened = can.Bus(**settings)
    try:
        yield opened
    finally:
        opened.shutdown()


def send(to: Any, first: int, measurements: int, number: int = 0x174) -> None:
    """Measurements 10 ms apart, and a frame of another device."""
    for step in range(first, first + measurements):
        for frame_id, content in bosch(step, 10.0):
            shifted = frame_id - 0x174 + number
            message = can.Message(arbitration_id=shifted, data=content, is_extended_id=False, timestamp=0.01 * step)
            to.send(message)
        to.send(can.Message(arbitration_id=0x300, data=b"other", is_extended_id=False, timestamp=0.01 * step))


def test_a_bus_is_read_and_read_again_after_it_was_lost() -> None:
    events = Events()
    with bus(interface="virtual", channel="gap", preserve_timestamps=True) as sender:
        link = Link(LinkOptions("can:gap?gyro=bosch-mm7.10&interface=virtual"), events)
        send(sender, 0, 100)
        samples = read_until(link, lambda samples: len(samples) == 99)
        assert samples[-1].rate_dps == pytest.approx(10.0)
        assert samples[-1].t_device_s - samples[0].t_device_s == pytest.approx(0.98)
        link.port._bus.shutdown()  # type: ignore[union-attr] # an adapter that is unplugged
        read_until(link, lambda _: link.port is None)
        read_until(link, lambda _: link.port is not None)
        send(sender, 130, 100)
        samples = read_until(link, lambda samples: len(samples) >= 98)
        link.close()
    assert link.counters.reconnects == 1
    assert link.counters.gaps == 1
    assert events.names().count("link_restored") == 1


def test_a_gyro_that_falls_silent_and_returns_leaves_a_gap() -> None:
    with bus(interface="virtual", channel="silent", preserve_timestamps=True) as sender:
        link = Link(LinkOptions("can:silent?gyro=bosch-mm7.10&interface=virtual"), Events())
        send(sender, 0, 50)
        send(sender, 80, 50)
        read_until(link, lambda samples: len(samples) >= 98)
        link.close()
    assert (link.counters.gaps, link.counters.reconnects) == (1, 0)


def test_frames_of_others_are_not_handed_on(tmp_path: Path) -> None:
    """Nor recorded: a bus of a car has many. A recording of raw bytes holds lines that python-can reads."""
    with bus(interface="virtual", channel="busy", preserve_timestamps=True) as sender:
        link = Link(LinkOptions("can:busy?gyro=bosch-mm7.10&interface=virtual"), Events())
        send(sender, 0, 10)
        heard: list[bytes] = []
        link.tap = lambda content, _: heard.append(content)
        read_until(link, lambda samples: len(samples) == 9)
        assert link.decoder is not None
        assert link.decoder.counters.frames == 30
        assert link.counters.bytes == len(b"".join(heard))
        link.close()
    recorded = tmp_path / "raw.log"
    recorded.write_bytes(b"".join(heard))
    messages = list(can.CanutilsLogReader(recorded))
    assert [(message.arbitration_id, bytes(message.data)) for message in messages[:3]] == bosch(0, 10.0)


def test_a_flood_does_not_hold_the_loop() -> None:
    with bus(interface="virtual", channel="flood", preserve_timestamps=True) as sender:
        link = Link(LinkOptions("can:flood?gyro=bosch-mm7.10&interface=virtual"), Events())
        send(sender, 0, 400)
        assert link.decoder is not None
        link.read()
        assert link.decoder.counters.frames == 384
        link.close()


def test_an_error_frame_and_a_request_are_no_values() -> None:
    with bus(interface="virtual", channel="errors", preserve_timestamps=True) as sender:
        link = Link(LinkOptions("can:errors?gyro=bosch-mm7.10&interface=virtual"), Events())
        sender.send(can.Message(arbitration_id=0x174, is_remote_frame=True, dlc=8, is_extended_id=False))
        sender.send(can.Message(arbitration_id=0x174, data=bytes(8), is_extended_id=True))
        send(sender, 0, 3)
        read_until(link, lambda samples: len(samples) == 2)
        assert link.decoder is not None
        assert link.decoder.counters.frames == 9
        link.close()


def test_a_bus_over_multicast_has_a_descriptor_to_wait_on() -> None:
    """Frames come through a socket of the kernel, as from SocketCAN."""
    pytest.importorskip("msgpack", reason="the bus udp_multicast needs msgpack")
    try:
        sender = can.Bus(interface="udp_multicast", channel="239.74.163.2")
    except (OSError, can.CanError) as error:
        pytest.skip(f"no multicast here: {error}")
    with sender, closing(Link(LinkOptions(MULTICAST), Events())) as link:
        assert link.fileno() is not None
        steps = count()

        def has_enough(samples: list[Sample]) -> bool:
            send(sender, next(steps), 1)
            return len(samples) >= 19

        samples = read_until(link, has_enough)
    assert samples[0].rate_dps == pytest.approx(10.0)


def has_socketcan() -> bool:
    try:
        socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW).close()
    except (OSError, AttributeError):
        return False
    return Path("/sys/class/net/vcan0").exists()


@pytest.mark.skipif(not has_socketcan(), reason="vcan0 is not there: sudo ip link add dev vcan0 type vcan")
def test_the_can_of_the_kernel_is_read() -> None:
    with bus(interface="socketcan", channel="vcan0") as sender:
        link = Link(LinkOptions("can:vcan0?gyro=bosch-mm7.10"), Events())
        send(sender, 0, 20)
        samples = read_until(link, lambda samples: len(samples) >= 19)
        assert samples[0].rate_dps == pytest.approx(10.0)
        link.close()


def test_a_channel_that_is_not_there_is_an_error() -> None:
    with pytest.raises(LinkError, match=r"there is no CAN channel can77|this kernel has no CAN"):
        Link(LinkOptions("can:can77?gyro=xsens"), Events())


def test_a_bus_without_the_ids_is_an_error_with_advice() -> None:
    silence = pytest.raises(DeviceSilentError, match="no frame with its ids arrives; check the bit rate")
    with Host("can:none?gyro=xsens&interface=virtual", timeout_s=3.0) as host, silence:
        host.read(3.0)


def test_an_unknown_interface_is_an_error() -> None:
    with pytest.raises(LinkError, match=r"the CAN bus cannot be opened: .*; check interface= and the adapter"):
        Link(LinkOptions("can:x?gyro=xsens&interface=none"), Events())


@pytest.mark.parametrize("kind", ["pipe", "zero", "folder", "none"])
def test_a_dbc_file_is_an_ordinary_file(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "car.dbc"
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "zero":
        path.symlink_to("/dev/zero")
    elif kind == "folder":
        path.mkdir()
    with pytest.raises(UsageError, match=r"cannot read .*car\.dbc: "):
        gyro_at(f"can:x?dbc={path}&signal=YawRate")


def test_a_dbc_file_that_takes_too_long_is_refused(dbc: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    go_on = threading.Event()
    monkeypatch.setattr(can_dbc, "PARSE_S", 0.05)
    monkeypatch.setattr("cantools.database.load_string", lambda *_, **__: go_on.wait())
    with pytest.raises(UsageError, match=r"it takes more than 0\.05 s"):
        gyro_at(f"can:x?dbc={dbc}&signal=YawRate")
    go_on.set()
    for thread in threading.enumerate():
        if thread.name == "read file":
            thread.join()
