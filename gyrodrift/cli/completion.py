"""Print the script that lets a shell complete commands, options and values with the tab key.

Once for the session: eval "$(gyrodrift completion bash)", likewise zsh (behind compinit), or
gyrodrift completion fish | source. For good: put that line into ~/.bashrc, ~/.zshrc or ~/.config/fish/config.fish.
"""

import argparse
import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from gyrodrift.cli import COMMANDS, parser_of
from gyrodrift.cli.help import COLUMNS
from gyrodrift.cli.parser import Parser
from gyrodrift.values.errors import UsageError

EXAMPLES = """\
eval "$(gyrodrift completion bash)"
gyrodrift completion fish > ~/.config/fish/completions/gyrodrift.fish
"""

SHELLS = ("bash", "zsh", "fish")
DEVICES = ("/dev/serial/by-id/*", "/dev/ttyUSB*", "/dev/ttyACM*")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("shell", choices=SHELLS, help="whose script to print")


def run(arguments: argparse.Namespace) -> int:
    """Print the script; returns 0."""
    from argcomplete.shell_integration import shellcode

    print(shellcode(["gyrodrift"], shell=arguments.shell))
    return 0


def complete() -> None:
    """Answer a completion request of a shell, and end the process."""
    from argcomplete.completers import BaseCompleter, DirectoriesCompleter, FilesCompleter
    from argcomplete.finders import CompletionFinder

    class Values(BaseCompleter):
        """Candidates for an argument: known names, or else files."""

        def __call__(
            self,
            *,
            prefix: str,
            action: argparse.Action,
            parser: argparse.ArgumentParser,
            parsed_args: argparse.Namespace,
        ) -> Iterable[str]:
            what = str(action.metavar or action.dest)
            if what in NAMES:
                return NAMES[what]()
            if action.type is not Path:
                return ()
            kind: Any = DirectoriesCompleter if what == "DIR" else FilesCompleter
            return list(kind()(prefix=prefix, action=action, parser=parser, parsed_args=parsed_args))

    CompletionFinder()(_whole_parser(os.environ.get("COMP_LINE", "")), default_completer=Values())


def _whole_parser(line: str) -> argparse.ArgumentParser:
    """Parser of all commands, with the options of the command in the line."""
    parser = argparse.ArgumentParser(prog="gyrodrift", allow_abbrev=False)
    parser.add_argument("--version", action="store_true", help="the version")
    commands = parser.add_subparsers()
    command = line.split()[1:2]
    for name, what in _commands().items():
        parents = _parents(name) if command == [name] else []
        commands.add_parser(name, help=what, parents=parents, add_help=not parents)
    return parser


def _parents(name: str) -> list[Parser]:
    """Parser of a command; none if the package that adds it is broken."""
    try:
        return [parser_of(name)]
    except UsageError:
        return []


def _commands() -> dict[str, str]:
    """Commands with their summaries; those here win over plug-ins with their names."""
    from gyrodrift.cli.plug_ins import summaries

    return dict(summaries(COMMANDS)) | COMMANDS


def _profiles() -> list[str]:
    from firmware_sim.motion.profile import shipped_profiles

    return [*shipped_profiles(), *_files("*.yaml")]


def _effects() -> list[str]:
    from firmware_sim.effects.catalogue import CATALOGUE

    return list(CATALOGUE)


def _rig_effects() -> list[str]:
    from firmware_sim.effects.triaxial.catalogue import TRIAXIAL

    return [*_effects(), *TRIAXIAL]


def _outputs() -> list[str]:
    """Names of the outputs, and each with its keys."""
    from gyrodrift.config.outputs import options_help
    from gyrodrift.outputs.registry import OUTPUTS

    return [word for name in OUTPUTS for word in (name, *(f"{name}:{key}=" for key, _, _ in options_help(name)))]


def _ports() -> list[str]:
    return ["auto", *_plugged()]


def _plugged() -> list[str]:
    return [str(path) for pattern in DEVICES for path in Path("/").glob(pattern.removeprefix("/"))]


def _files(pattern: str) -> list[str]:
    return [path.name for path in Path().glob(pattern)]


NAMES: dict[str, Callable[[], list[str]]] = {
    "PROFILE": _profiles,
    "EFFECT": _effects,
    "NAME[:param=value,...]": _rig_effects,
    "port": _ports,
    "NAME[:KEY=VALUE,...]": _outputs,
    "COMMAND": lambda: [*_commands(), COLUMNS],
}
"""Known names for each kind of argument."""
