"""Commands that other packages add: they run, are listed and completed, and a broken one harms nothing else."""

import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from plug_in_support import Site

from gyrodrift.cli import COMMANDS, command_of, main, parser_of

SOURCE = '''"""Print a greeting."""

EXAMPLES = "gyrodrift hello"

def add_arguments(parser):
    parser.add_argument("--name", default="you", help="who is greeted")

def run(arguments):
    print(f"hello {arguments.name}")
    return 0
'''

Install = Callable[..., None]


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Install]:
    """Install a package with a command."""
    monkeypatch.syspath_prepend(tmp_path)

    def installed(package: str, command: str, source: str = SOURCE) -> None:
        Site(tmp_path).install(package, "gyrodrift.commands", command, package, source)

    yield installed
    for path in tmp_path.glob("*.py"):
        sys.modules.pop(path.stem, None)


def test_a_command_of_another_package_runs(install: Install, capsys: pytest.CaptureFixture[str]) -> None:
    install("greeting", "hello")
    assert main(["hello", "--name", "gyro", "--quiet"]) == 0
    assert capsys.readouterr().out == "hello gyro\n"
    assert "gyrodrift hello" in parser_of("hello").format_help()


def test_it_is_listed_and_suggested(install: Install, capsys: pytest.CaptureFixture[str]) -> None:
    """The first line of its docstring is its summary."""
    install("greeting", "hello")
    assert main(["help"]) == 0
    assert "  hello             print a greeting\n" in capsys.readouterr().out
    assert main(["helo"]) == 2
    assert "did you mean hello" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("source", "reason"),
    [
        ("import not_there\n", "cannot be imported: ModuleNotFoundError: No module named 'not_there'"),
        ('"""Nothing."""\n', "is no command: greeting has no EXAMPLES"),
    ],
)
def test_a_broken_package_is_one_line(
    source: str, reason: str, install: Install, capsys: pytest.CaptureFixture[str]
) -> None:
    """The line names command, package, reason and remedy; all other commands are listed."""
    install("greeting", "hello", source)
    line = f"the command of greeting {reason}; install another version of it, or uninstall it\n"
    assert main(["hello"]) == 2
    assert capsys.readouterr().err == f"gyrodrift: hello: {line}"
    assert main(["help"]) == 0
    listed = capsys.readouterr().out
    assert f"  hello             {line}" in listed
    assert all(f"  {command} " in listed for command in COMMANDS)


def test_two_packages_with_one_name_are_an_error(install: Install, capsys: pytest.CaptureFixture[str]) -> None:
    install("greeting", "hello")
    install("salute", "hello")
    assert main(["hello"]) == 2
    statement = capsys.readouterr().err
    assert statement == "gyrodrift: hello: is a command of greeting and of salute; uninstall all but one\n"


def test_a_name_of_ours_stays_ours(install: Install, capsys: pytest.CaptureFixture[str]) -> None:
    """The list names the package that adds it again."""
    install("greeting", "info")
    assert command_of("info").__name__ == "gyrodrift.cli.info"
    assert main(["help"]) == 0
    line = "  info              is a command of gyrodrift, and greeting adds another; uninstall that\n"
    assert line in capsys.readouterr().out
