"""The command line as a whole: help, mistakes, exit statuses."""

import platform
import re
import shlex
import sys
from pathlib import Path

import pytest
from support import Command

import gyrodrift
from gyrodrift.cli import COMMANDS, command_of, main, parser_of
from gyrodrift.cli.parser import COLUMN_OPTIONS

NAMES = [*COMMANDS, "gyrogap"]
"""Commands here, and that of the package in benchmark/, which `make test` installs."""


@pytest.mark.parametrize("command", NAMES)
def test_every_command_has_help_with_units_and_exit_statuses(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main([command, "--help"])
    assert ended.value.code == 0
    shown = capsys.readouterr().out
    usage, purpose, *_ = shown.split("\n\n")
    assert usage.startswith(f"usage: gyrodrift {command}")
    assert re.fullmatch(r"[A-Z][^\n]{20,}[.:]", purpose)
    assert "rates deg/s, times s" in shown
    assert "130 interrupted" in shown
    assert main(["help", command]) == 0
    assert capsys.readouterr().out == shown


@pytest.mark.parametrize("command", NAMES)
def test_the_examples_of_every_command_are_understood(command: str) -> None:
    """Two or three, of that command, and shown."""
    examples = command_of(command).EXAMPLES.splitlines()
    assert 2 <= len(examples) <= 3
    for line in examples:
        assert line in parser_of(command).format_help()
        _, name, *words = shlex.split(re.sub(r'^eval "\$\((.*)\)"$', r"\1", line.partition("   ")[0]))
        ends = [words.index(mark) for mark in ("|", ">") if mark in words]
        parser_of(name).read(words[: min(ends, default=None)])


@pytest.mark.parametrize("command", NAMES)
def test_every_option_tells_its_default(command: str) -> None:
    text = " ".join(parser_of(command).format_help().partition("\noptions:\n")[2].split())
    for option in re.split(r" (?=--[a-z-]+ [A-Z{])", text):
        if re.match(r"--[a-z-]+ [A-Z{]", option) and not option.startswith(("--port", "--link", "--out")):
            assert "default" in option, option


def test_help_lists_the_commands() -> None:
    with Command("help") as run:
        assert run.end() == 0
    assert all(f"  {command}" in run.out for command in NAMES)
    assert "examples:\n  gyrodrift demo" in run.out


def test_the_version_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["--version"])
    assert ended.value.code == 0
    package = Path(gyrodrift.__file__).parent
    expected = (
        f"gyrodrift {gyrodrift.__version__} from {package} (Python {platform.python_version()}, {sys.executable})"
    )
    assert capsys.readouterr().out == f"{expected}\n"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["serv"], "gyrodrift: serv: there is no such command; did you mean serve?"),
        (["xyz"], "gyrodrift: xyz: there is no such command; there are serve, ctl"),
        ([], "usage: gyrodrift COMMAND"),
        (["--verbose", "serve"], "gyrodrift: 'serve' stands behind options"),
        (["help", "tun"], "gyrodrift: tun: there is no such command; did you mean tune?"),
    ],
)
def test_what_is_no_command_ends_with_2_and_a_hint(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """The nearest one, or all there are."""
    assert main(arguments) == 2
    assert capsys.readouterr().err.startswith(message)


@pytest.mark.promise("Configs and commands")
@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("serve --prt /dev/ttyUSB0", "--prt: serve has no such option; did you mean --port"),
        ("serve --protocol nativ", "--protocol nativ: did you mean native?"),
        ("serve --log-level warn", "--log-level warn: did you mean warning?"),
        ("record -o sessions", "-o: record has no such option; did you mean --out?"),
        ("tune --filter=restlevl", "--filter restlevl: did you mean restlevel?"),
        ("compare --sed 3 x", "--sed: compare has no such option; did you mean --seed?"),
        ("serve --port x --prot native", "--prot: serve has no such option; did you mean --protocol?"),
        ("compare --iteration=5 x", "--iteration: compare has no such option; did you mean --iterations?"),
        ("--vers", "--vers: gyrodrift has no such option; did you mean --version?"),
        ("diagnose --withhold scale_facto", "--withhold scale_facto: there is no such effect; did you mean scale_fac"),
        ("simulate --effect warmpu", "--effect warmpu: there is no effect 'warmpu'; did you mean warmup?"),
        ("simulate --profile turntabel", "--profile turntabel: there is no such profile or file; did you mean turn"),
        ("simulate --format cvs", "--format cvs: did you mean csv?"),
        ("convert --as imuu", "--as imuu: did you mean imu?"),
        ("replay --protocol csvv", "--protocol csvv: did you mean csv?"),
        ("--verison", "--verison: gyrodrift has no such option; did you mean --version?"),
    ],
)
def test_what_is_unknown_gets_the_nearest_before_anything_else_is_said(
    line: str, expected: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """An abbreviated option is refused, and its full name is suggested."""
    assert main(line.split()) == 2
    assert capsys.readouterr().err.startswith(f"gyrodrift: {expected}")


@pytest.mark.parametrize(
    ("words", "shown"),
    [
        (["info", "a\nb.csv"], "a\\x0ab.csv: there is no such session or folder"),
        (["record", "--out", "s", "--port=no\nport"], "no\\x0aport: there is no such port; "),
        (["serve", "--port", "x", "--protocol", "a\nb"], "--protocol a\\x0ab: there are auto, "),
    ],
)
def test_a_line_feed_in_an_argument_keeps_the_message_on_one_line(
    words: list[str], shown: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words) in (2, 3, 4)
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"gyrodrift: {shown}")


def test_every_unknown_option_is_told_at_once(capsys: pytest.CaptureFixture[str]) -> None:
    """A line each; what stands behind -- and negative numbers are none."""
    assert main(["filter", "--otu", "a", "--configg", "b", "--", "--session"]) == 2
    first, second = capsys.readouterr().err.splitlines()
    assert first.endswith("did you mean --out?")
    assert second.endswith("did you mean --config?")
    assert main(["simulate", "--out", "x", "--seed", "-1"]) == 2
    assert capsys.readouterr().err == "gyrodrift: --seed -1: expected a whole number from 0\n"


@pytest.mark.parametrize("command", ["serve", "tune", "doctor"])
def test_the_help_of_a_long_command_has_the_common_options_and_help_all_has_all(
    command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """At most 14 options are in the first help, --help-all has each of them."""
    assert main(["help", command]) == 0
    short = re.findall(r"^  (-[\w-]+)", capsys.readouterr().out, re.MULTILINE)
    assert len(short) <= 14
    assert "--help-all" in short
    with pytest.raises(SystemExit):
        main([command, "--help-all"])
    full = re.findall(r"^  (-[\w-]+)", capsys.readouterr().out, re.MULTILINE)
    assert len(full) == len(short) + int(re.findall(r"show (\d+) more", parser_of(command).format_help())[0])


def test_the_columns_have_a_page_of_their_own(capsys: pytest.CaptureFixture[str]) -> None:
    """`help columns` has all seven options, and other helps name it."""
    assert main(["help", "columns"]) == 0
    out = capsys.readouterr().out
    assert all(option in out for option in {"--columns", *COLUMN_OPTIONS})
    assert main(["help", "info"]) == 0
    out = capsys.readouterr().out
    assert "gyrodrift help columns" in " ".join(out.split())
    assert "--rate-unit" not in out
