"""JSON of clients: values come through, everything else is one kind of error."""

from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.outputs.net.json_input import DEEPEST, NotJsonError, parse_json, parse_json_at


@pytest.mark.parametrize(
    "text",
    [
        "",
        " ",
        "{",
        "{} {}",
        "nul",
        "NaN",
        "-Infinity",
        "1" * 5000,
        "[" * 100_000,
        '{"a":' * 100_000,
        "[" * (DEEPEST + 1) + "]" * (DEEPEST + 1),
        "\ufeff{}",
        b"\xff",
        b'"\xed\xa0\x80"',
        "{'a': 1}",
    ],
)
def test_what_is_no_json_is_one_kind_of_error(text: str | bytes) -> None:
    with pytest.raises(NotJsonError):
        parse_json(text)


def test_as_deep_as_the_limit_is_taken() -> None:
    """Brackets in texts do not count."""
    deepest = "[" * DEEPEST + "]" * DEEPEST
    assert parse_json(f" {deepest}\r\n") is not None
    assert parse_json('["' + "[" * 1000 + '"]') == ["[" * 1000]
    assert parse_json_at(f"?={deepest};", 2)[1] == 2 + len(deepest)


@pytest.mark.promise("Clients of outputs")
@given(st.binary(max_size=200) | st.text(max_size=200) | st.text('[]{}",:0 \\u', max_size=80))
def test_any_bytes_are_a_value_or_one_kind_of_error(text: str | bytes) -> None:
    """Any bytes of a client are a JSON value or one kind of error."""
    with suppress(NotJsonError):
        assert isinstance(parse_json(text), dict | list | str | int | float | None)
