"""Columns as a person writes them, and lines read by them."""

from math import degrees, isnan

import pytest

from gyrodrift.columns.spec import SELECTED, Column, columns_of, selection, spec_text
from gyrodrift.link.protocols.registry import candidates
from gyrodrift.values.errors import UsageError
from gyrodrift.values.sample import Reading


def read(spec: str, *lines: str) -> list[Reading]:
    (protocol,) = candidates("auto", spec)
    decoder = protocol.decoder()
    readings = decoder.push("".join(f"{line}\n" for line in lines).encode())
    assert decoder.counters.damaged == 0
    return readings


def test_a_spec_says_what_each_column_is() -> None:
    assert columns_of("t_ms, _, gz:lsb/131:-") == (
        Column("t_ms", 1e3),
        Column("_"),
        Column("rate", -1 / 131, unit="lsb/131"),
    )
    assert columns_of("Gyro Z=rate:rads,a=encoder:counts/4096") == (
        Column("rate", degrees(1.0), "Gyro Z", "rads"),
        Column("encoder", 360 / 4096, "a", "counts/4096"),
    )
    assert columns_of("yaw:rad:-, ax:mg, gx, az:lsb/16384") == (
        Column("yaw", -degrees(1.0), unit="rad"),
        Column("ax", 9.80665e-3, unit="mg"),
        Column("gx"),
        Column("az", 9.80665 / 16384, unit="lsb/16384"),
    )


def test_labels_with_commas_and_values_that_are_meanings_stand_in_quotes() -> None:
    """A proposal is read as it was meant."""
    assert columns_of('"Angular Velocity, z"=rate:dps, "a ""b"""=t_s') == (
        Column("rate", 1.0, "Angular Velocity, z", "dps"),
        Column("t_s", 1e6, 'a "b"'),
    )
    text = spec_text(["rate:dps", "_", "t_ms"], ["Angular Velocity, z", "x", "a=b"])
    assert [column.label for column in columns_of(text)] == ["Angular Velocity, z", "a=b"]
    for value in ("B", "2", "rate", "24:6F:28", "a, b"):
        (selected, _) = columns_of(f"{selection('node, id', value)}, gz=rate")
        assert (selected.meaning, selected.label, selected.unit) == (SELECTED, "node, id", value)


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ("t_ms, _", "no column is the rate"),
        ("rate, rate", "rate is given twice"),
        ("rate, yaw", "there are a rate and yaw"),
        ("yaw:dps", "'dps' is not a unit of yaw"),
        ("temp:-, rate", "'-' is not a unit of temp"),
        ("t_ms, t_us, rate", "there are two clocks"),
        ("t_ms, raet", "'raet' is not a column; did you mean rate"),
        ("", "'' is not a column"),
        ("rate:furlongs", "'furlongs' is not a unit of rate"),
        ("rate:lsb/0", "'lsb/0' is not a unit of rate"),
        ("encoder:lsb/4, rate", "'lsb/4' is not a unit of encoder"),
        ("=rate", "'=rate' is not a column"),
        ("gz=rate, t_ms", "either all columns need a label"),
        ("node=raet, gz=rate", 'did you mean rate. to use only the rows with this value, write node="raet"'),
        ("gz=dps, t=t_ms", "did you mean rate:dps"),
        ("node=B, t=t_ms", r"no column is the rate or yaw \(node=B selects rows\)"),
        ("t, rate", "t needs a unit, such as t_ms, t:lsb/32768 or t:days"),
        ("+t_ns, rate", "a column with . is added to a clock: name that one"),
        ("dt_ms, +t_us, rate", "a column with . is added to a clock"),
        ("q.w, q.x, q.z", "a quaternion needs all of q.w, q.x, q.y, q.z"),
        ("delta, rate", "there are a rate and a delta"),
        ("t_ms, t:days, rate", r"there are two clocks; call one of them _, or \+t:days if they are to be added"),
    ],
)
def test_a_wrong_spec_is_told_with_what_is_expected(spec: str, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        columns_of(spec)


def test_columns_belong_to_the_text_protocol() -> None:
    with pytest.raises(UsageError, match="--columns is for --protocol text, not for native"):
        candidates("native", "rate")
    with pytest.raises(UsageError, match="needs --columns"):
        candidates("text")


@pytest.mark.parametrize(
    ("spec", "line", "reading"),
    [
        ("t_ms,_,_,rate:lsb/131", "1234,5,6,-262", Reading(1_234_000, None, -2.0)),
        ("t_us,rate:-", "1234 -1.5", Reading(1234, None, 1.5)),
        ("t_s,rate", "1.25;0,5", Reading(1_250_000, None, 0.5)),
        ("seq,rate,encoder:counts/3600,temp", "70000,1,10,25.5", Reading(None, 70000 & 0xFFFF, 1.0, 1.0, 25.5)),
        ("gz=rate,t=t_ms", "t:4294967297,gz:3", Reading(1000, None, 3.0)),
        ("gyro.2=rate", '{"gyro":[1,2,3]}', Reading(None, None, 3.0)),
        ("_,rate", "$XYROT,1.5*4E", Reading(None, None, 1.5)),
    ],
)
def test_lines_are_read_by_their_columns(spec: str, line: str, reading: Reading) -> None:
    assert [repr(item) for item in read(spec, line, line, line)] == [repr(reading)] * 3


def test_lines_without_the_labels_are_passed_over() -> None:
    """A sketch may print accelerations in between."""
    rotation = "Rotation X: 0.1, Y: 0.2, Z: 1 rad/s"
    readings = read("Rotation Z=rate:rads", *["Acceleration X: 1, Y: 2, Z: 9.8 m/s^2", rotation] * 4)
    assert [item.rate_dps for item in readings] == pytest.approx([degrees(1.0)] * 4)


@pytest.mark.parametrize("line", ["40,1", "40,1,2,3", "40,0,x", "1e99,0,1", "40,0,1e9", "40,,"])
def test_a_line_that_does_not_fit_is_damaged(line: str) -> None:
    """Cut short, merged, no number, or none that can be."""
    (protocol,) = candidates("text", "t_ms,_,rate")
    decoder = protocol.decoder()
    decoder.push(b"10,0,1\n20,0,1\n30,0,1\n")
    assert decoder.push(f"{line}\n50,0,1\n".encode()) == [decoder.push(b"50,0,1\n")[0]]
    assert decoder.counters.damaged == 1


def test_values_in_several_lines_begin_with_that_of_the_sender() -> None:
    """A value of the other sender is never taken, wherever the stream begins."""
    lines = ["gz: 5", "id: 2", "gz: 1", "id: 1", "gz: 9"]
    (protocol,) = candidates("auto", "id=2, gz=rate")
    readings = protocol.decoder().push("".join(f"{line}\n" for line in lines * 4).encode())
    assert {reading.rate_dps for reading in readings} == {1.0}


def test_quaternions_in_counts_are_scaled_and_others_are_damage() -> None:
    spec = ", ".join(f"q.{part}:lsb/16384" for part in "wxyz")
    assert read(spec, *["11585,0,0,11585"] * 3)[0].yaw_deg == pytest.approx(90.0)
    (protocol,) = candidates("auto", "q.w, q.x, q.y, q.z")
    decoder = protocol.decoder()
    assert not decoder.push(b"11585,0,0,11585\n" * 4)
    assert decoder.counters.damaged == 4


def test_without_a_clock_and_without_an_angle_there_is_none() -> None:
    """The link times such samples by their arrival."""
    (protocol,) = candidates("auto", "rate")
    assert not protocol.has_clock
    assert isnan(read("rate", "1", "2", "3")[0].encoder_deg)
