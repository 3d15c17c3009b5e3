"""Commands that other packages add: entry points of the group `gyrodrift.commands`.

An entry point names a module like those of this folder: a docstring whose first line is the summary, `EXAMPLES`,
`add_arguments(parser)` and `run(arguments)`, which returns the exit status.
"""

from collections.abc import Collection
from importlib.metadata import EntryPoint, entry_points
from types import ModuleType

from gyrodrift.cli.parser import unknown
from gyrodrift.values.errors import UsageError

GROUP = "gyrodrift.commands"
PARTS = ("EXAMPLES", "add_arguments", "run")
"""Names that the module of a command has."""


def command_named(name: str, own: Collection[str]) -> ModuleType:
    """Module of the plug-in with a name; `own` are the names of the commands here.

    Raises
    ------
    UsageError
        There is none, there are two, or it cannot be imported.
    """
    added = _entries()
    if name not in added:
        raise unknown("command", name, [*own, *added])
    return _loaded(name, added[name], own)


def summaries(own: Collection[str]) -> list[tuple[str, str]]:
    """Name and summary of each plug-in; for one that cannot run, the reason."""
    return [(name, _summary(name, entries, own)) for name, entries in sorted(_entries().items())]


def _entries() -> dict[str, list[EntryPoint]]:
    added: dict[str, list[EntryPoint]] = {}
    for entry in entry_points(group=GROUP):
        added.setdefault(entry.name, []).append(entry)
    return added


def _summary(name: str, entries: list[EntryPoint], own: Collection[str]) -> str:
    try:
        first_line = (_loaded(name, entries, own).__doc__ or "").partition("\n")[0].rstrip(".")
    except UsageError as error:
        return str(error).removeprefix(f"{name}: ")
    return first_line[:1].lower() + first_line[1:]


def _loaded(name: str, entries: list[EntryPoint], own: Collection[str]) -> ModuleType:
    packages = sorted(_package(entry) for entry in entries)
    if name in own:
        raise UsageError(f"{name}: is a command of gyrodrift, and {', '.join(packages)} adds another; uninstall that")
    if len(entries) > 1:
        raise UsageError(f"{name}: is a command of {' and of '.join(packages)}; uninstall all but one")
    try:
        module: ModuleType = entries[0].load()
        missing = [part for part in PARTS if not hasattr(module, part)]
    except Exception as error:  # noqa: BLE001 - whatever the code of another package raises
        first_line = str(error).partition("\n")[0]
        reason = f"cannot be imported: {type(error).__name__}: {first_line}"
    else:
        if not missing:
            return module
        reason = f"is no command: {entries[0].value} has no {missing[0]}"
    raise UsageError(f"{name}: the command of {packages[0]} {reason}; install another version of it, or uninstall it")


def _package(entry: EntryPoint) -> str:
    return entry.dist.name if entry.dist else entry.value
