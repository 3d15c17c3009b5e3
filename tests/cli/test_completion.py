"""Completion in real shells: what the tabulator key makes of a line."""

import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

import pytest
from support import Command, Terminal, quick

from gyrodrift.cli import completion

BIN = Path(sys.executable).parent


def environment() -> Mapping[str, str]:
    """Our program first; no history, nothing of the person who runs this."""
    return {"PATH": f"{BIN}:/usr/bin:/bin", "HISTFILE": "/dev/null", "PS1": "$ ", "HOME": "/nonexistent"}


LINES = [
    ("gyrodrift di", "gyrodrift diagnose "),
    ("gyrodrift tune --me", "gyrodrift tune --method "),
    ("gyrodrift tune --filter re", "gyrodrift tune --filter restlevel "),
    ("gyrodrift simulate --effect scale_f", "gyrodrift simulate --effect scale_factor "),
    ("gyrodrift help conv", "gyrodrift help convert "),
    ("gyrodrift help col", "gyrodrift help columns "),
    ("gyrodrift serve --port au", "gyrodrift serve --port auto "),
    ("gyrodrift convert my-ses", "gyrodrift convert my-session.csv "),
]
SOME = (LINES[0], LINES[2], LINES[-1])
"""A command, a value and a file: every shell asks the same program."""

BASH = (["bash", "--norc", "--noprofile", "-i"], 'eval "$(gyrodrift completion bash)"')
ZSH = (["zsh", "-f", "-i"], 'autoload -U compinit; compinit -D -u; eval "$(gyrodrift completion zsh)"')


@pytest.mark.parametrize(
    ("shell", "start", "lines"), quick([(*BASH, LINES), (*BASH, SOME), (*ZSH, SOME)], (*BASH, SOME), (*ZSH, SOME))
)
def test_the_tabulator_key_goes_on_with_a_line(
    shell: list[str], start: str, lines: Sequence[tuple[str, str]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Commands, options, their values, names that the program knows, and files."""
    if shutil.which(shell[0]) is None:
        pytest.skip(f"there is no {shell[0]} here")
    (tmp_path / "my-session.csv").touch()
    monkeypatch.chdir(tmp_path)
    with Terminal(*shell, environment=environment(), rows=50) as terminal:
        terminal.keys(f"{start}; echo re''ady\n")
        terminal.until(lambda shown: "\nready" in shown.text, "shell that is ready")
        for typed, expected in lines:
            terminal.keys(f"{typed}\t#\n")  # the mark shows where the line went on
            terminal.until(partial(shows, f"{expected}#"), expected)
        assert terminal.process.poll() is None, "the shell goes on"


def shows(line: str, terminal: Terminal) -> bool:
    return line in terminal.text


def test_fish_goes_on_with_a_line() -> None:
    fish = shutil.which("fish")
    if fish is None:
        pytest.skip("there is no fish here")
    request = "; ".join(f"complete -C '{typed}'" for typed, _ in SOME[:-1])
    script = f"gyrodrift completion fish | source; {request}"
    done = subprocess.run(
        [fish, "--no-config", "-c", script], env=environment(), capture_output=True, text=True, check=True
    )
    words = [line.partition("\t")[0].strip() for line in done.stdout.splitlines()]
    for _, expected in SOME[:-1]:
        assert expected.split()[-1] in words


def test_an_unknown_shell_is_told_which_there_are() -> None:
    with Command("completion", "bsh") as run:
        assert run.end() == 2
    assert run.log == "gyrodrift: shell bsh: did you mean bash or zsh?\n"


def test_the_outputs_and_their_keys_are_known() -> None:
    """`--output` goes on with a name, and with a key behind the colon."""
    words = completion.NAMES["NAME[:KEY=VALUE,...]"]()
    assert {"web", "web:port=", "mqtt:topic="} <= set(words)
