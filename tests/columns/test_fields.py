"""Lines of text as fields, in the forms in which sketches print them."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.columns.fields import Fields, Form, Headings, fields_of


@pytest.mark.parametrize(
    ("line", "values"),
    [
        ("100,1,-2.5,.5", ("100", "1", "-2.5", ".5")),
        ("100; 0,5; 1", ("100", "0.5", "1")),
        ("1\t2\t3", ("1", "2", "3")),
        ("1 2   3", ("1", "2", "3")),
        ("1 | 2 | 3", ("1", "2", "3")),
        ("1,2,", ("1", "2")),
        ("1,,3", ("1", "", "3")),
    ],
)
def test_a_row_is_split_at_what_stands_between_its_values(line: str, values: tuple[str, ...]) -> None:
    """Comma, semicolon, tab, bar or space; where it is not a comma, that may be the decimal point."""
    assert fields_of(line) == Fields(Form.ROW, ("",) * len(values), values)


@pytest.mark.parametrize(
    ("line", "labels", "values"),
    [
        ("gz=1.2", ("gz",), ("1.2",)),
        ("t:100,gx:1,gz:-2e-3", ("t", "gx", "gz"), ("100", "1", "-2e-3")),
        ("Rotation X: 0.1, Y: 0.2, Z: 0.3 rad", ("Rotation X", "Rotation Y", "Rotation Z"), ("0.1", "0.2", "0.3")),
        ("\tGyro X: 1 \tY: 2 \tZ: 3 people".strip(), ("Gyro X", "Gyro Y", "Gyro Z"), ("1", "2", "3")),
        ("Gyro:\tx= 1 |\ty= 2 |\tz= 3", ("Gyro x", "Gyro y", "Gyro z"), ("1", "2", "3")),
        ("Yaw, Pitch, Roll: 170.0, 0.18, -178", ("Yaw", "Pitch", "Roll"), ("170.0", "0.18", "-178")),
        ("a(x,y,z) 1 2 3 g(x,y,z) 4 5 6", ("a x", "a y", "a z", "g x", "g y", "g z"), ("1", "2", "3", "4", "5", "6")),
        ("gz::1.5", ("gz",), ("1.5",)),
        (">gz:1.5", ("gz",), ("1.5",)),
        (">gz:5020:0.58|g", ("t_ms", "gz"), ("5020", "0.58")),
    ],
)
def test_labels_name_values(line: str, labels: tuple[str, ...], values: tuple[str, ...]) -> None:
    """A letter alone takes over the words before the first one; Teleplot says the time between name and value."""
    result = fields_of(line)
    assert result is not None
    assert (result.form, result.labels, result.values) == (Form.LABELED, labels, values)


@pytest.mark.parametrize(
    ("line", "units"),
    [
        ("Rotation X: 0.1, Y: 0.2, Z: 0.3 rad/s", ("rad/s",) * 3),
        ("gx: 1 deg/s gy: 2 deg/s gz: 3 deg/s", ("deg/s", "deg/s", "deg/s")),
        ("g(x,y,z) 4 5 6 [dps] o(y,p,r) 1 2 3", ("dps", "dps", "dps", "", "", "")),
        ("rate = 944.27 Hz", ("Hz",)),
        ("Gz: 0.58°/s", ("°/s",)),
        (">gz:0.5§rad/s", ("rad/s",)),
        ("1.5 s, 2 dps, 3", ("s", "dps", "")),
        ("gx: 1 left gy: 2", ()),
    ],
)
def test_a_unit_behind_a_value_is_kept(line: str, units: tuple[str, ...]) -> None:
    result = fields_of(line)
    assert result is not None
    assert result.units == units


@pytest.mark.parametrize(
    ("line", "labels", "values"),
    [
        ("a/g:\t16\t-12\t300\t7", ("", "a/g 1", "a/g 2", "a/g 3", "a/g 4"), ("a/g", "16", "-12", "300", "7")),
        ("gyro 1 2 3", ("", "gyro x", "gyro y", "gyro z"), ("gyro", "1", "2", "3")),
        ("YPRAG=1,2,3,4", ("", "YPRAG 1", "YPRAG 2", "YPRAG 3", "YPRAG 4"), ("YPRAG", "1", "2", "3", "4")),
    ],
)
def test_a_row_behind_a_word_is_read_by_place_and_by_the_word(
    line: str, labels: tuple[str, ...], values: tuple[str, ...]
) -> None:
    assert fields_of(line) == Fields(Form.ROW, labels, values)


@pytest.mark.parametrize("line", ["<1,2,3>", "/*1,2,3*/", "(1, 2, 3)", "[1,2,3]"])
def test_marks_around_a_row_are_taken_off(line: str) -> None:
    assert fields_of(line) == Fields(Form.ROW, ("", "", ""), ("1", "2", "3"))


def test_json_is_read_by_the_way_to_each_number() -> None:
    """Numbers in quotes count, names select lines, and truth values do not count."""
    line = '{"t": 1.5, "gyro": {"x": 1, "z": "-2"}, "list": [7, 8], "name": "mpu", "ok": true}'
    assert fields_of(line) == Fields(
        Form.JSON, ("t", "gyro.x", "gyro.z", "list.0", "list.1", "name"), ("1.5", "1", "-2", "7", "8", "mpu")
    )
    assert fields_of('{"t": 1.5, "gy') is None


def test_a_name_in_json_cannot_say_anything_to_a_terminal_or_a_shell() -> None:
    result = fields_of('{"\\u001b[31mgz$(reboot)`x`,=": 1}')
    assert result is not None
    assert result.labels == ("[31mgz(reboot)x",)


def test_a_sentence_has_to_pass_its_checksum() -> None:
    """Exclusive or of all between $ and *: an example that many manuals of receivers have."""
    sentence = "$GPGLL,5057.970,N,00146.110,E,142451,A*27"
    result = fields_of(sentence)
    assert result is not None
    assert (result.form, result.values[:2]) == (Form.NMEA, ("GPGLL", "5057.970"))
    assert fields_of(sentence.replace("5057", "5058")) is None


@given(st.text(max_size=300))
def test_no_text_is_too_odd(line: str) -> None:
    result = fields_of(line)
    assert result is None or len(result.labels) == len(result.values)


@pytest.mark.parametrize(
    ("line", "labels", "values"),
    [
        ('<imu gx="0.3" gz="-0.8"/>', ("gx", "gz"), ("0.3", "-0.8")),
        ("<imu><gyro><x>1</x><z>0.5</z></gyro></imu>", ("gyro.x", "gyro.z"), ("1", "0.5")),
        ('t="5" gz="0.5"', ("t", "gz"), ("5", "0.5")),
        ("gx 0.1 gy 0.2", ("gx", "gy"), ("0.1", "0.2")),
        ("gx: 0,52; gz: -1,25 dps", ("gx", "gz"), ("0.52", "-1.25")),
        ("gyro { x: 1 y: 2 z: 3 }", ("gyro x", "gyro y", "gyro z"), ("1", "2", "3")),
    ],
)
def test_labels_stand_in_elements_quotes_and_turns(line: str, labels: tuple[str, ...], values: tuple[str, ...]) -> None:
    result = fields_of(line)
    assert result is not None
    assert (result.form, result.labels, result.values) == (Form.LABELED, labels, values)


@pytest.mark.parametrize(
    ("text", "labels"),
    [
        ('{\n"t_ms": 5,\n"gyro": {\n"x": 1,\n"z": 2\n}\n}\n{\n"t_ms": 6', ["t_ms", "gyro.x", "gyro.z", "t_ms"]),
        ("header {\nstamp {\nsec: 1\n}\n}\nangular_velocity {\nz: 1\n}", ["header.stamp.sec", "angular_velocity.z"]),
        ('"gyro": [\n0.1,\n0.2\n],\n"t": 1', ["gyro.0", "gyro.1", "t"]),
        ("<gyro>\n<z>0.5</z>\n</gyro>\n<t>1</t>", ["gyro.z", "t"]),
        ("Gyroscope:\nX1 = 0.1\nZ1 = 0.2", ["Gyroscope X1", "Gyroscope Z1"]),
    ],
)
def test_a_label_has_the_names_of_its_blocks(text: str, labels: list[str]) -> None:
    headings = Headings()
    parsed = [fields for line in text.split("\n") if (fields := headings.fields_of(line)) is not None]
    assert [label for fields in parsed if fields.form is Form.LABELED for label in fields.labels] == labels


def test_hexadecimal_numbers_are_never_read_as_decimal_ones() -> None:
    """After the first of them, nor is a line whose digits may be one."""
    headings = Headings()
    assert headings.fields_of("gx:FF83 gz:0041") is None
    assert headings.fields_of("gx:0042 gz:0041") is None
    assert headings.fields_of("gx:42 gz:41") is not None
    assert [fields_of(line) for line in ("gz:0xFF", "FF83,0041", "0012,00AB")] == [None] * 3
    assert fields_of("1E05,2E05") is not None


numbers = st.from_regex(r"-?(0|[1-9][0-9]{0,3})(\.[0-9]{1,3})?", fullmatch=True)


@given(st.lists(st.lists(numbers, min_size=3, max_size=3), min_size=2, max_size=4))
def test_lines_that_differ_in_numbers_have_the_same_labels(rows: list[list[str]]) -> None:
    for form in ("gx: {} gy: {} gz: {} dps", "x={}, y={}, z={}", "Gyro X:{} Y:{} Z:{}", "[5] gx:{} gy:{} gz:{}"):
        headings = Headings()
        lines = [form.format(*row) for row in rows]
        assert [headings.fields_of(line) for line in lines] == [fields_of(line) for line in lines]
