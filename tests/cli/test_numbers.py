"""Numbers on a command line: whatever stands there for one, a mistake is one line and status 2."""

import argparse

import pytest

from gyrodrift.cli import COMMANDS, main, numbers, parser_of
from gyrodrift.values.errors import UsageError

NO_NUMBERS = (
    *("", " ", "x", "²", "٣", "\uff11\uff12", "1_000", "0x10", "1e", "1,5", "1 2", "\x00"),
    *("nan", "NaN", "inf", "-inf", "infinity", "1e400", "-1e400", "-1", "9" * 5000, "9" * 400, "1" + "0" * 39),
)
NUMERIC = (
    *("--timeout", "--jobs", "--iterations", "--seed", "--seeds", "--turns", "--repeats", "--spread", "--rest"),
    *("--temperature", "--duration", "--seconds", "--sessions", "--minutes", "--speed", "--lsb", "--rate", "--turn-at"),
    *("--count", "--sample-rate"),
)


def numeric_options() -> list[tuple[str, str]]:
    result = []
    for command in (*COMMANDS, "gyrogap"):
        for action in parser_of(command)._actions:
            name = next((name for name in action.option_strings if name in NUMERIC), None)
            if name is not None:
                result.append((command, name))
    return result


def test_the_options_that_are_numbers_are_known() -> None:
    for command in (*COMMANDS, "gyrogap"):
        for action in parser_of(command)._actions:
            if not isinstance(action.type, argparse.FileType) and action.type is not None:
                assert action.type not in (int, float), (command, action.option_strings)
                is_number = getattr(action.type, "__module__", "") == numbers.__name__
                assert not is_number or set(action.option_strings) & set(NUMERIC), (command, action.option_strings)


@pytest.mark.promise("Configs and commands")
@pytest.mark.parametrize(("command", "option"), numeric_options())
def test_what_is_no_number_is_one_line(command: str, option: str) -> None:
    """An invalid number on the command line gives one line."""
    parser = parser_of(command)
    for value in NO_NUMBERS:
        with pytest.raises(UsageError) as report:
            parser.read([f"{option}={value}"])
        message = str(report.value)
        assert message.startswith(f"{option} ")
        assert "expected" in message
        assert "\n" not in message
        assert len(message) < 200


@pytest.mark.parametrize("value", [*NO_NUMBERS, "0", "1.5", "-9600"], ids=lambda value: repr(value[:12]))
def test_what_is_no_line_rate_is_one_line(value: str) -> None:
    with pytest.raises(UsageError, match=r"--baud .*: expected a rate in baud") as report:
        numbers.baud(value)
    assert len(str(report.value)) < 200


@pytest.mark.promise("Configs and commands")
@pytest.mark.parametrize(
    "words",
    [
        ["serve", "--port", "/dev/null", "--baud", "²"],
        ["serve", "--port", "/dev/null", "--baud", "9" * 5000],
        ["record", "--port", "/dev/null", "--out", "sessions", "--baud", "²"],
        ["record", "--port", "/dev/null", "--out", "sessions", "--rotate", "9" * 400 + "h"],
        ["serve", "--port", "/dev/null", "--record", "sessions", "--rotate", "9" * 400 + "GB"],
        ["calibrate", "--port", "/dev/null", "--baud", "9" * 5000],
        ["doctor", "--port", "/dev/null", "--baud", "²"],
        ["replay", "x.csv", "--link", "y", "--speed", "9" * 5000],
    ],
    ids=lambda words: f"{words[0]} {words[-2]}",
)
def test_commands_end_with_2_and_one_line(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    """A number outside the range of its option gives status 2 and one line."""
    assert main(words) == 2
    report = capsys.readouterr().err
    assert report.startswith(f"gyrodrift: {words[-2]} ")
    assert report.count("\n") == 1
    assert len(report) < 200


@pytest.mark.parametrize("unit", ["", "h", "GB", " min", "kB", "parsecs"])
@pytest.mark.parametrize("value", [*NO_NUMBERS, "0", "0.0"], ids=lambda value: repr(value[:12]))
def test_what_is_no_rotation_is_refused(value: str, unit: str) -> None:
    with pytest.raises(UsageError, match=r"--rotate .*: expected a size such as") as report:
        numbers.rotation(value + unit)
    assert len(str(report.value)) < 200


@pytest.mark.parametrize(
    ("text", "expected"),
    [("100MB", (100_000_000, None)), ("0.5kB", (500, None)), ("1.5h", (None, 5400.0)), ("90 s", (None, 90.0))],
)
def test_sizes_and_times_are_read(text: str, expected: tuple[int | None, float | None]) -> None:
    assert numbers.rotation(text) == expected


def test_a_number_beyond_what_an_option_can_mean_is_told_with_the_most(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["simulate", "--out", "x", "--minutes", "1e9"]) == 2
    assert capsys.readouterr().err == "gyrodrift: --minutes 1e9: expected a number above 0, 1000000 at most\n"
