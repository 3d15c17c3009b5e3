"""Plug-ins of all groups as commands see them: commands that other packages add, and the list of everything added.

An entry point of `gyrodrift.commands` names a module like those of this folder: a docstring whose first line is the
summary, `EXAMPLES`, `add_arguments(parser)` and `run(arguments)`, which returns the exit status.
"""

import sys
from collections.abc import Collection, Iterator, Sequence
from importlib import import_module
from types import ModuleType
from typing import Any

from gyrodrift.cli.parser import unknown
from gyrodrift.io.plug_ins import EntryPoint, PlugInError, PlugIns, entry_points, summary

REGISTRIES = {
    "gyrodrift.outputs": "gyrodrift.outputs.registry:OUTPUTS",
    "gyrodrift.sources": "gyrodrift.link.sources.registry:ADDED",
    "gyrodrift.protocols": "gyrodrift.link.protocols.registry:PROTOCOLS",
    "gyrodrift.filters": "gyrodrift.filters.registry:FILTERS",
    "gyrodrift.effects": "gyrodrift.simulation.effects:EFFECTS",
    "gyrodrift.encoders": "gyrodrift.simulation.effects:ENCODERS",
}
"""Registry of each group of entry points besides commands, as `module:NAME`."""

PARTS = ("EXAMPLES", "add_arguments", "run")
"""Names that the module of a command has."""


def command_named(name: str, own: Collection[str]) -> ModuleType:
    """Module of the plug-in with a name; `own` are the names of the commands here.

    Raises
    ------
    UsageError
        There is none, there are two, or it cannot be imported.
    """
    added = _commands(own)
    if name not in added:
        raise unknown("command", name, [*own, *added.added()])
    return added[name]


def summaries(own: Collection[str]) -> list[tuple[str, str]]:
    """Name and summary of each plug-in; for one that cannot run, the reason."""
    return [(name, _about(name, outcome)) for name, outcome in _commands(own).added().items()]


def listing(*groups: str) -> Iterator[str]:
    """A line for each plug-in that is no command: kind, name and description, or what is wrong with it."""
    for registry in _registries(groups or tuple(REGISTRIES)):
        for name, outcome in registry.added().items():
            yield f"{registry.what} {_about_line(name, outcome)}"


def tell_problems(*groups: str) -> None:
    """Say on stderr which plug-ins of these groups cannot be used, a line for each."""
    for registry in _registries(groups):
        for problem in registry.problems():
            print(f"gyrodrift: {problem}", file=sys.stderr)


def _registries(groups: Sequence[str]) -> Iterator[PlugIns[Any]]:
    """Registries of the groups in which a package offers something; others are not imported."""
    for group in groups:
        if entry_points(group):
            module, _, name = REGISTRIES[group].partition(":")
            yield getattr(import_module(module), name)


def _about_line(name: str, outcome: object) -> str:
    about = str(getattr(outcome, "help", "") or getattr(outcome, "title", "") or getattr(outcome, "meaning", ""))
    return str(outcome) if isinstance(outcome, PlugInError) else f"{name}: {about or summary(outcome)}"


def _commands(own: Collection[str]) -> PlugIns[ModuleType]:
    return PlugIns("command", _accept, own)


def _accept(entry: EntryPoint, value: Any) -> ModuleType:
    missing = [part for part in PARTS if not hasattr(value, part)]
    if missing:
        raise TypeError(f"{entry.value} has no {missing[0]}")
    module: ModuleType = value
    return module


def _about(name: str, outcome: ModuleType | PlugInError) -> str:
    return str(outcome).removeprefix(f"{name}: ") if isinstance(outcome, PlugInError) else summary(outcome)
