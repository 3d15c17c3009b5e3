"""Lines of text as fields, in the forms in which sketches print them."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.link.text.fields import Fields, Form, fields_of


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
        ("a/g:\t16000\t-12\t300\t7", ("a/g:", "16000", "-12", "300", "7")),
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
        ("Rotation X: 0.1, Y: 0.2, Z: 0.3 rad/s", ("Rotation X", "Rotation Y", "Rotation Z"), ("0.1", "0.2", "0.3")),
        ("\tGyro X: 1 \tY: 2 \tZ: 3 radians/s".strip(), ("Gyro X", "Gyro Y", "Gyro Z"), ("1", "2", "3")),
    ],
)
def test_labels_name_values(line: str, labels: tuple[str, ...], values: tuple[str, ...]) -> None:
    """A letter alone takes over the word before the first one; units are passed over."""
    assert fields_of(line) == Fields(Form.LABELLED, labels, values)


def test_json_is_read_by_the_way_to_each_number() -> None:
    """Numbers in quotes count, names and truth values do not."""
    line = '{"t": 1.5, "gyro": {"x": 1, "z": "-2"}, "list": [7, 8], "name": "mpu", "ok": true}'
    assert fields_of(line) == Fields(
        Form.JSON, ("t", "gyro.x", "gyro.z", "list.0", "list.1"), ("1.5", "1", "-2", "7", "8")
    )
    assert fields_of('{"t": 1.5, "gy') is None


def test_a_name_in_json_cannot_say_anything_to_a_terminal_or_a_shell() -> None:
    """It ends up in messages that are pasted."""
    found = fields_of('{"\\u001b[31mgz$(reboot)`x`,=": 1}')
    assert found is not None
    assert found.labels == ("[31mgz(reboot)x",)


def test_a_sentence_has_to_pass_its_checksum() -> None:
    """Exclusive or of all between $ and *: an example that many manuals of receivers have."""
    sentence = "$GPGLL,5057.970,N,00146.110,E,142451,A*27"
    found = fields_of(sentence)
    assert found is not None
    assert (found.form, found.values[:2]) == (Form.NMEA, ("GPGLL", "5057.970"))
    assert fields_of(sentence.replace("5057", "5058")) is None


@given(st.text(max_size=300))
def test_no_text_is_too_odd(line: str) -> None:
    """Whatever it is, a line has as many labels as values, or is damaged."""
    found = fields_of(line)
    assert found is None or len(found.labels) == len(found.values)
