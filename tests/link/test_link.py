"""The link: finds baud rate and protocol, survives what happens to cables, and says what happened."""

import struct
import termios
from binascii import crc_hqx
from collections.abc import Iterator
from itertools import islice, pairwise, repeat
from math import radians
from pathlib import Path

import golden_frames as golden
import pytest
from sources_support import Host
from support import speaking_on

from firmware_sim.measure import measure
from firmware_sim.motion.profile import load_profile
from firmware_sim.pty import PtyDevice
from firmware_sim.rig import Rig
from firmware_sim.wire.encoder import Frame
from firmware_sim.wire.registry import ENCODERS
from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.protocols.registry import PROTOCOLS
from gyrodrift.values.errors import DeviceSilentError, UsageError

RIG = Rig()
DETECTED = [name for name in ENCODERS if PROTOCOLS[name].is_detected]


def frames(protocol: str) -> Iterator[Frame]:
    return ENCODERS[protocol].frames(measure(RIG, load_profile("turntable"), 1, block_samples=256), RIG.base)


def spoken(protocol: str) -> Iterator[bytes]:
    return (frame.content for frame in frames(protocol))


@pytest.mark.parametrize("protocol", DETECTED)
def test_protocol_and_baud_are_found_and_told(port: Path, protocol: str) -> None:
    with speaking_on(port) as device, Host(port) as host:
        samples = host.hear(device, islice(spoken(protocol), 150))
        assert ("protocol_found", {"protocol": protocol, "baud": 115200}) in host.told
        measured = sum(frame.rows for frame in islice(frames(protocol), 150))
        assert len(samples) == measured - PROTOCOLS[protocol].sends_angle  # of the first angle no rate can be made
        assert ("no_device_clock" in host.names()) != PROTOCOLS[protocol].has_clock


def test_a_device_tells_who_it_is(port: Path) -> None:
    with speaking_on(port) as device, Host(port) as host:
        host.hear(device, islice(spoken("native"), 350))
        assert host.names() == ["link_open", "protocol_found", "device"]
        assert host.told[-1][1]["device_id"] == "firmware_sim"


def garbled(device: PtyDevice, frame: bytes, baud: int) -> bytes:
    speed = termios.tcgetattr(device.fd)[5]
    return frame if speed == getattr(termios, f"B{baud}") else bytes(byte ^ 0xA5 for byte in frame[::2])


@pytest.mark.parametrize("baud", [9600, 921600])
@pytest.mark.parametrize("protocol", DETECTED)
def test_auto_baud_tries_the_usual_rates_until_one_makes_sense(port: Path, protocol: str, baud: int) -> None:
    """Bytes at the wrong rate are garbage."""
    with speaking_on(port) as device, Host(port, timeout_s=30.0) as host:
        for frame in islice(spoken(protocol), 1000):
            device.send(garbled(device, frame, baud))
            host.now_s += 0.01
            host.link.read()
        assert host.link.baud == baud
        assert host.link.counters.samples > 100


@pytest.mark.promise("Text and units")
@pytest.mark.parametrize(("line", "every_s"), [(b"0.5\r\n", 0.5), (b"12\r\n", 0.9), (b"gz: 0.25\r\n", 1.0)])
def test_a_board_that_prints_slowly_is_not_left_for_another_rate(port: Path, line: bytes, every_s: float) -> None:
    """A board that prints a few bytes a second is not left for another baud rate."""
    with speaking_on(port) as device, Host(port, timeout_s=9.0) as host:

        def print_slowly() -> None:
            for tenth in range(200):
                if not tenth % round(10 * every_s):
                    device.send(line)
                host.now_s += 0.1
                host.link.read()

        with pytest.raises(DeviceSilentError, match="the device prints text, so the baud rate is right"):
            print_slowly()
        assert host.link.baud == 115200


def test_a_given_baud_is_never_second_guessed(port: Path) -> None:
    """Garbage at 115200 stays garbage at 115200, until time is up; the message says what to try."""
    with speaking_on(port) as device, Host(port, baud=115200, timeout_s=5.0) as host:
        garbage = (garbled(device, frame, 9600) for frame in spoken("native"))
        with pytest.raises(
            DeviceSilentError,
            match=r"bytes arrived within 5 s, but no native.* at 115200 baud; the baud rate may be wrong",
        ):
            host.hear(device, islice(garbage, 1000))
        assert host.link.baud == 115200


def test_a_device_that_says_nothing_is_given_up(port: Path) -> None:
    with speaking_on(port), Host(port, timeout_s=3.0) as host:
        host.now_s += 2.9
        assert host.link.read() == []
        host.now_s += 0.2
        with pytest.raises(DeviceSilentError, match="sent nothing within 3 s; check its power"):
            host.link.read()


def test_who_waits_for_ever_is_told_once_what_is_not_understood(port: Path) -> None:
    lines = (f"gx:{i % 3},gy:{i % 5},gz:{i % 7}\n".encode() for i in range(1200))
    with speaking_on(port) as device, Host(port, timeout_s=0.0) as host:
        assert host.hear(device, islice(lines, 1200)) == []
        (reason,) = (fields["reason"] for event, fields in host.told if event == "not_understood")
        assert "looks like gx, gy, gz (label:value pairs)" in reason
        assert host.link.baud == 115200


def test_samples_that_never_say_their_scale_are_explained(port: Path) -> None:
    with speaking_on(port) as device, Host(port, baud=115200, protocol="native", timeout_s=3.0) as host:
        frames = [frame for frame in islice(spoken("native"), 400) if len(frame) == 20]
        with pytest.raises(DeviceSilentError, match="but no HELLO frame"):
            host.hear(device, islice(frames, 400))


def test_unplugging_keeps_time_and_tells_how_long_it_was_gone(port: Path) -> None:
    """The device comes back as another pty under the same name, its clock at zero."""
    with speaking_on(port) as device:
        host = Host(port)
        before = host.hear(device, islice(spoken("native"), 300))
    assert host.link.read() == []
    assert host.link.fileno() is None
    for _ in range(40):
        host.now_s += 0.1
        assert host.link.read() == []
    with speaking_on(port) as device:
        host.now_s += host.link.wake_s() + 0.001
        host.link.read()
        after = host.hear(device, islice(spoken("native"), 50))
    assert host.names() == ["link_open", "protocol_found", "device", "link_lost", "link_restored", "device_reset"]
    gone_s = host.told[4][1]["gone_s"]
    assert 4.0 <= gone_s <= 6.0
    assert host.link.counters.gone_s == pytest.approx(gone_s, abs=1e-3)
    assert after[0].t_device_s - before[-1].t_device_s == pytest.approx(0.01)
    assert len(after) == 49
    host.link.close()


@pytest.mark.promise("Samples")
@pytest.mark.parametrize("is_detected", [True, False])
def test_samples_that_waited_for_a_hello_have_their_own_times(port: Path, is_detected: bool) -> None:  # noqa: FBT001 - a case
    """Samples that waited for a HELLO keep their own times."""
    frames = list(islice(spoken("native"), 250))
    samples = [frame for frame in frames if len(frame) == 20]
    hello = next(frame for frame in frames if len(frame) != 20)
    options = {} if is_detected else {"baud": 115200, "protocol": "native"}
    heard = []
    for order in ([*samples[:3], hello, *samples[3:]], [*samples[:120], hello, *samples[120:]]):
        with speaking_on(port) as device:
            host = Host(port, **options)
            heard.append(host.hear(device, order))
            assert host.link.counted()["before_hello"] == 0
            host.link.close()
    early, late = heard
    assert [x[:2] for x in early] == [x[:2] for x in late]
    assert [x.rate_dps for x in early] == [x.rate_dps for x in late]
    offsets_s = [b.t_host_s - a.t_host_s for a, b in zip(early, late, strict=True)]
    assert max(offsets_s) - min(offsets_s) < 0.0101
    steps_s = [b.t_host_s - a.t_host_s for a, b in pairwise(late)][3 if is_detected else 0 :]
    assert min(steps_s) > 0.0099


def test_after_a_reconnect_samples_wait_for_the_hello_of_their_device(port: Path) -> None:
    frames = list(islice(spoken("native"), 500))
    with speaking_on(port) as device:
        host = Host(port)
        before = host.hear(device, islice(frames, 200))
    host.link.read()
    samples = [frame for frame in frames[300:] if len(frame) == 20]
    with speaking_on(port) as device:
        host.now_s += host.link.wake_s() + 0.001
        host.link.read()
        assert host.hear(device, islice(samples, 60)) == []
        after = host.hear(device, islice(frames, 1)) + host.hear(device, islice(samples[60:], 20))
    assert len(after) == 80
    assert after[0].t_device_s > before[-1].t_device_s
    assert host.names().count("device") == 1
    host.link.close()


@pytest.mark.promise("Recovery")
def test_reopening_is_tried_less_and_less_often(port: Path) -> None:
    """An unplugged port is searched for within 2 s, again and again."""
    with speaking_on(port):
        host = Host(port)
    host.link.read()
    waits = []
    for _ in range(9):
        waits.append(host.link.wake_s())
        host.now_s += host.link.wake_s() + 1e-6
        host.link.read()
    assert waits == pytest.approx([0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 2.0, 2.0, 2.0], abs=1e-3)
    host.link.close()


def test_gaps_are_counted_and_told(port: Path) -> None:
    with speaking_on(port) as device, Host(port) as host:
        frames = list(islice(spoken("native"), 200))
        host.hear(device, frames[:150] + frames[157:])
        assert host.told[-1] == ("gap", {"missing": 7, "seconds": pytest.approx(0.08)})
        assert (host.link.counters.gaps, host.link.counters.missing) == (1, 7)


def test_an_unknown_protocol_is_refused_before_the_port_is_opened() -> None:
    """The port need not even exist."""
    with pytest.raises(UsageError, match="unknown protocol 'nmea2000'"):
        Link(LinkOptions("/dev/ttyNONE", protocol="nmea2000"), lambda *_, **__: None)


@pytest.mark.parametrize(
    ("frame", "protocol", "advice"),
    [
        (golden.VECTORNAV_ANGLES, "vectornav", "turn on AngularRate"),
        (b"$HEROT,0.0,V*3C\r\n", "nmea", "its .*ROT sentences say V"),
    ],
)
def test_a_device_that_sends_no_rate_is_told_what_to_send(port: Path, frame: bytes, protocol: str, advice: str) -> None:
    with speaking_on(port) as device, Host(port, timeout_s=1.0) as host:
        statement = rf"good {protocol} frames arrived within 1 s, but none with a yaw rate; {advice}"
        with pytest.raises(DeviceSilentError, match=statement):
            host.hear(device, islice(repeat(frame), 200))


def test_a_device_whose_frames_have_no_time_is_timed_by_their_arrival(port: Path) -> None:
    rate = b"\x01\x20\x00" + struct.pack("<3f", 0.0, 0.0, -radians(2.0))
    with speaking_on(port) as device, Host(port) as host:
        frame = b"\xfa" + rate + struct.pack(">H", crc_hqx(rate, 0))
        samples = host.hear(device, islice(repeat(frame), 100))
        assert len(samples) == 100
        assert samples[-1].t_device_s == pytest.approx(0.99, abs=0.05)
        assert "no_device_clock" in host.names()
