"""Second sources on a link of their own: what each kind of message says."""

import json
from math import isfinite, isnan
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.columns.fields import checksum
from gyrodrift.link.protocols.batch import ReadingBatch
from gyrodrift.link.second_source import SecondSource
from gyrodrift.service.loop import Statements
from gyrodrift.values.aid import Aid
from gyrodrift.values.sample import Sample

KN_MPS = 1852 / 3600


def sentence(body: str) -> bytes:
    return f"${body}*{checksum(body):02X}\r\n".encode()


def said(source: SecondSource, content: bytes) -> list[tuple[str, str, Any]]:
    return [(aid.name, aid.kind, pytest.approx(aid.value)) for aid in source.take(content)]


def test_sentences_of_a_receiver_and_of_a_compass() -> None:
    """A course and a speed of 0 without a valid position are no measurements."""
    gps = SecondSource("gps")
    assert said(gps, sentence("GNVTG,87.0,T,,M,4.0,N,7.4,K,A")[:-3]) == []
    assert said(gps, b"\r\n" + sentence("GPRMC,1,V,,,,,0.0,1.0,,,")) == []
    assert said(gps, sentence("GNVTG,87.0,T,,M,4.0,N,7.4,K,A")) == [
        ("gps.speed", "speed", 4 * KN_MPS),
        ("gps.course", "heading", -87.0),
    ]
    assert said(gps, sentence("HEHDT,270.5,T") + sentence("GPGGA,1,2,3")) == [("gps.heading", "heading", -270.5)]
    assert (gps.messages, gps.understood) == (4, 2)


def test_messages_of_a_robot() -> None:
    """A robot that turns on the spot has a speed of 0, and does not stand; a command only says whether it stands."""
    robot = SecondSource("robot", late_s=0.2)
    for turn_rads, aids in ((0.5, 1), (0.0, 2)):
        twist = {"linear": {"x": 0.0}, "angular": {"z": turn_rads}}
        message = {"op": "publish", "msg": {"header": {"stamp": 1}, "twist": {"twist": twist, "covariance": [0.0]}}}
        batch = ReadingBatch(messages=[json.dumps(message).encode()] * 2)
        assert len(robot.take(batch)) == 2 * aids
    command = SecondSource("robot", late_s=0.2)
    for speed, still in ((0.0, 1.0), (0.3, 0.0)):
        (aid,) = command.take(json.dumps({"linear": {"x": speed}, "angular": {"z": 0.0}}).encode() + b"\n")
        assert aid[:4] == ("robot.command", "standing", still, -0.2)


def test_lines_by_columns_of_the_user() -> None:
    wheels = SecondSource("base", "l=wheel_left:dps, r=wheel_right:dps, brake=rest")
    assert said(wheels, b"noise\nl: 10 r: 12 brake: 0\n") == [
        ("base.wheels", "wheels", 2.0),
        ("base.standing", "standing", 0.0),
    ]
    rows = SecondSource("base", "_, turn_rate:rads")
    assert said(rows, b"1,1\n") == [("base.turn_rate", "turn_rate", 57.29578)]


@given(
    st.lists(
        st.binary(max_size=60)
        | st.sampled_from([b'{"a":' * 900, b'{"linear":{"x":1e999}}\n', b"$GPRMC,,A,,,,,x,y*00\n"])
    )
)
def test_any_bytes_break_nothing(chunks: list[bytes]) -> None:
    sources = [SecondSource("a"), SecondSource("b", "x=speed, y=heading"), SecondSource("c", "speed, rest")]
    for chunk in chunks:
        for source in sources:
            assert all(isfinite(aid.value) for aid in source.take(chunk))


def test_a_measurement_waits_for_the_next_sample(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its time is that of the sample, or lies before it if the gyro was silent meanwhile."""
    now_s = 100.0
    monkeypatch.setattr("time.monotonic", lambda: now_s)
    statements = Statements()
    statements.take(Aid("ctl", "heading", 1.0))
    assert statements.joined([]) == []
    (first, second) = statements.joined([Sample(0, 7.0, 0.0, 0.0), Sample(1, 7.1, 0.0, 0.0)])
    assert (len(first.aids), second.aids) == (1, ())
    assert isnan(first.aids[0].t_s)
    statements.take(Aid("gps", "speed", 1.0, t_s=-0.25))
    now_s = 103.0
    (late,) = statements.joined([Sample(2, 10.0, 0.0, 0.0)])
    assert late.aids[0].t_s == 6.75


def test_messages_of_an_autopilot() -> None:
    common = pytest.importorskip("pymavlink.dialects.v20.common")
    link, vehicle = common.MAVLink(None, 1, 1), SecondSource("fc", is_mavlink=True)

    def wheels(t_us: int, left: float, right: float) -> bytes:
        return bytes(common.MAVLink_wheel_distance_message(t_us, 2, [left, right, *[0.0] * 14]).pack(link))

    position = (0, 3, 0, 0, 0, 100, 100)
    gps = [
        common.MAVLink_gps_raw_int_message(*position, *course, 9).pack(link) for course in ((150, 9000), (65535,) * 2)
    ]
    assert said(vehicle, gps[0]) == [("fc.speed", "speed", 1.5), ("fc.course", "heading", -90.0)]
    assert said(vehicle, gps[1]) == []
    assert said(vehicle, wheels(0, 1.0, 1.0) + wheels(500_000, 1.5, 1.6)) == [("fc.wheels", "wheels", 0.2)]
