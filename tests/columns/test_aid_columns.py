"""Second sources in the lines of a port: names, units, empty cells, and lines of their own."""

from math import isnan

import pytest
from columns.test_spec import read

from gyrodrift.columns.spec import columns_of
from gyrodrift.values.errors import UsageError

ROW = "t_ms, rate, heading:compass:sigma/2:late/0.2, speed:kn, wheel_left, wheel_right, rest"
LABELED = "t=t_ms, gz=rate, course=heading:mod/90, v=speed:mps"


def test_cells_of_slow_sources_may_be_empty_and_a_heading_that_stands_counts_once() -> None:
    readings = read(ROW, "0,.1,87,2,,,", "10,.2,87,,1,1.5,0", "20,.2,nan,,1,,1", "30,.2,,,,,")
    speed_mps = pytest.approx(2 * 1852 / 3600)
    assert [(aid.name, aid.value) for aid in readings[0].aids] == [("speed", speed_mps), ("heading", -87.0)]
    assert readings[0].aids[1][3:6] == (-0.2, 2.0, 360.0)
    assert readings[0].aids[1].speed == speed_mps
    assert [(aid.kind, aid.value, aid.speed) for aid in readings[1].aids] == [("wheels", 0.5, 1.25)]
    assert [reading.aids for reading in readings[2:]] == [(), ()]
    assert [reading.still for reading in readings[1:3]] == [0.0, 1.0]
    assert isnan(readings[3].still)


def test_a_line_without_a_rate_joins_the_next_one() -> None:
    lines = ('{"t":0,"gz":1,"course":5}', '{"course":6,"v":1.5}', '{"t":10,"gz":1}', '{"t":20,"gz":1,"v":null}')
    readings = read(LABELED, *lines)
    assert [len(reading.aids) for reading in readings] == [1, 2, 0]
    assert readings[0].aids[0][:3] == ("course", "heading", 5.0)
    assert readings[0].aids[0].period_deg == 90.0
    assert [aid.name for aid in readings[1].aids] == ["v", "course"]


def test_lines_with_a_clock_of_their_own_join_the_next_rate() -> None:
    lines = ('{"t":0,"gz":1}', '{"t":5,"course":90}', '{"t":10,"gz":1}', '{"t":15,"course":91}', '{"t":20,"gz":1}')
    readings = read(LABELED, *lines)
    assert [reading.t_us for reading in readings] == [0, 10_000, 20_000]
    assert [[aid.value for aid in reading.aids] for reading in readings] == [[], [90.0], [91.0]]
    in_parts = read("t=t_ms, gz=rate, v=speed", *(line for i in range(4) for line in (f"t:{i} v:{i}.5", "gz:1")))
    assert [(reading.t_us, reading.aids[0].value) for reading in in_parts] == [(1000 * i, i + 0.5) for i in range(4)]


def test_a_row_without_a_rate_joins_the_next_one() -> None:
    readings = read("t_ms, rate, heading", "0,1,", "5,,90", "10,1,", "15,nan,91", "20,1,")
    assert [[aid.value for aid in reading.aids] for reading in readings] == [[], [90.0], [91.0]]


def test_entries_are_written_as_they_are_read() -> None:
    spec = "rate, heading:rad:-:sigma/0.1:late/0.2:mod/90, speed:kmh:sigma/2, turn_rate:rads, wheel_left, wheel_right"
    columns = columns_of(spec)
    assert ", ".join(column.entry for column in columns) == spec
    for words, scale in (("compass", -1.0), ("cw", -1.0), ("ccw", 1.0), ("deg", 1.0), ("compass:-", 1.0)):
        assert columns_of(f"rate, heading:{words}")[1].scale == scale


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ("rate, wheel_left", "wheel_left alone"),
        ("rate, heading:mod/70", "part of 360"),
        ("rate, speed:sigma/0", "deviation of 0"),
        ("heading, speed", "no column is the rate"),
    ],
)
def test_mistakes_are_explained(spec: str, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        columns_of(spec)
