"""Objects in braces: JSON, and dictionaries as Python and MicroPython print them."""

import json

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from gyrodrift.columns.fields import fields_of
from gyrodrift.columns.guess import guess
from gyrodrift.columns.objects import BRACKETS_MAX, LONGEST_CHARACTERS, leaves_of
from gyrodrift.columns.spec import columns_of
from gyrodrift.link.text_decoder import TextDecoder

ODD = (
    "{[]: 1}",
    "{[1], 2}",
    "{{}: 1}",
    "{{}}",
    "{1, 2}",
    "{'a': 1}['a']",
    "{'a': __import__('os')}",
    "{'a': 1 + 2j}",
    "{'a' 'b': 1}",
    "{'a': 1,, 'b': 2}",
    "{*[]}",
    "{**{}}",
    "{'a': 1",
    "{'a': '\\x00'",
    "{'a': \\",
)

PIECES = (
    *("{", "}", "[", "]", "(", ")", ",", ":", '"', "'", "\\", " ", "\t", "=", "*", "$", "#", "+", "-", ".", "e", "_"),
    *("gz", "'gz'", '"gz"', "t_ms", "1", "0", "1.5", "-2e3", "1e400", "9" * 50, "9" * 5000, "0x1f", "²", "٣", "1_0"),
    *("nan", "NaN", "inf", "Infinity", "None", "True", "null", "true", "b'x'", "f'{x}'", "lambda", "\ud800", "\0"),
)
LINES = st.one_of(
    st.text(max_size=300),
    st.binary(max_size=300).map(lambda content: content.decode("utf-8", "replace")),
    st.lists(st.sampled_from(PIECES), max_size=60).map("".join),
    st.lists(st.sampled_from(PIECES), max_size=60).map(lambda pieces: "{" + "".join(pieces) + "}"),
)


@pytest.mark.parametrize(
    ("line", "leaves"),
    [
        ("{'gz': 1.2}", {"gz": "1.2"}),
        ("{'t': 100, 'gyro': {'x': -1, 'z': 2e-05}}", {"t": "100", "gyro.x": "-1", "gyro.z": "2e-05"}),
        ("{'gyro': (1, 2.5), 'one': (4,)}", {"gyro.0": "1", "gyro.1": "2.5", "one.0": "4"}),
        ("{'ok': True, 'no': None, 'gz': nan}", {"gz": "nan"}),
        ("{1: 2, 'id': b'mpu'}", {"1": "2", "id": "mpu"}),
        ("{}", {}),
    ],
)
def test_a_dictionary_that_a_board_prints_is_read(line: str, leaves: dict[str, str]) -> None:
    """Single quotes, tuples, and the words that Python has for what JSON calls null, true and false."""
    result = leaves_of(line)
    assert result is not None
    assert {".".join(path): text for path, text in result} == leaves


@pytest.mark.parametrize("line", ODD)
def test_what_only_a_parser_of_python_would_make_something_of_is_damaged(line: str) -> None:
    """Sets, objects as names, expressions: nobody reads a measurement from one."""
    assert leaves_of(line) is None


def test_a_number_of_any_size_stays_the_text_it_is() -> None:
    """Python refuses to convert a whole number of more than 4300 digits."""
    digits = "9" * 4000
    assert leaves_of(f'{{"n": {digits}}}') == leaves_of(f"{{'n': {digits}}}") == [(("n",), digits)]
    assert leaves_of('{"n": 1e400}') == [(("n",), "1e400")]
    assert leaves_of('{"a": NaN, "b": -Infinity}') == [(("a",), "nan"), (("b",), "-inf")]


@pytest.mark.parametrize("line", ['{"gz": 1, "gz": 2}', "{'gz': 1, 'gz': 2}", '{"a": {"b": 1, "b": 1}}'])
def test_an_object_that_says_a_name_twice_is_damaged(line: str) -> None:
    assert leaves_of(line) is None


@pytest.mark.parametrize("opening", ['{"a":', '["', "{'a':", "[", "("])
def test_an_object_is_as_deep_and_as_long_as_it_may_be(opening: str) -> None:
    """A parser that calls itself is never asked for more levels than the interpreter has."""
    assert leaves_of("{'a':" + opening * 100_000) is None
    assert leaves_of("{" + " " * LONGEST_CHARACTERS + "}") is None
    assert leaves_of('{"a":' + "[" * (BRACKETS_MAX - 1) + "]" * (BRACKETS_MAX - 1) + "}") == []


@given(st.dictionaries(st.text("abcxyz_", min_size=1), st.floats() | st.integers()))
def test_a_printed_dictionary_and_its_json_say_the_same(values: dict[str, float]) -> None:
    assert leaves_of(repr(values)) == leaves_of(json.dumps(values)) is not None


@pytest.mark.promise("Recovery")
@given(LINES)
@example("{[]: 1}")
@example("{[1], 2}")
def test_no_line_is_too_odd(line: str) -> None:
    """No line breaks a text decoder."""
    result = fields_of(line.strip())
    assert result is None or len(result.labels) == len(result.values)
    for spec in ("t_ms, rate", "gz=rate, t=t_us", "seq, rate:lsb/131, encoder:counts/4096, temp"):
        decoder = TextDecoder(columns_of(spec))
        decoder.push(f"{line}\n{line}\n1, 2, 3, 4\n".encode("utf-8", "replace") * 2)


@given(st.lists(LINES, max_size=6), st.sampled_from([None, 0.0, 1.0, 100.0, 1e9]))
def test_no_text_is_too_odd_to_be_looked_at(lines: list[str], lines_per_s: float | None) -> None:
    """A guess comes of it, or none; what it proposes is understood."""
    result = guess(lines * 3, lines_per_s)
    assert result is None or result.spec is None or columns_of(result.spec)
