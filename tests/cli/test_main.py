"""The command line as a whole: help, mistakes, exit statuses."""

import platform
import sys
from pathlib import Path

import pytest
from support import Command

import gyrodrift
from gyrodrift.cli import COMMANDS, main


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help_with_units_and_exit_statuses(command: str) -> None:
    """On stdout, and it ends with 0."""
    with Command(command, "--help") as run:
        assert run.end() == 0
    assert f"usage: gyrodrift {command}" in run.out
    assert "rates deg/s, times s" in run.out
    assert "130 interrupted" in run.out


def test_help_lists_the_commands() -> None:
    """Each with a line."""
    with Command("--help") as run:
        assert run.end() == 0
    assert all(f"  {command}" in run.out for command in COMMANDS)


def test_the_version_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    """And which copy of the program that is, run by which Python."""
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
        (["serv"], "gyrodrift: 'serv' is not a command; did you mean serve?"),
        (["xyz"], "gyrodrift: 'xyz' is not a command; commands are "),
        ([], "usage: gyrodrift COMMAND"),
        (["--verbose", "serve"], "gyrodrift: 'serve' stands behind options"),
    ],
)
def test_what_is_no_command_ends_with_2_and_a_hint(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """The nearest one, or all there are."""
    assert main(arguments) == 2
    assert capsys.readouterr().err.startswith(message)
