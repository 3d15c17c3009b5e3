"""Plug-ins: values that other packages offer under a name, by entry points of groups such as `gyrodrift.outputs`.

An entry point is looked for where a name is none of gyrodrift's, and for a list of all names. So a run without plug-ins
reads no metadata, and a package is imported when its plug-in is used or listed. `importlib.metadata` is not used: its
import alone costs a tenth of the start of `serve`.
"""

import os
import sys
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import redirect_stdout
from dataclasses import dataclass
from importlib import import_module
from operator import attrgetter
from types import ModuleType
from typing import Any, Generic, TypeVar

from gyrodrift.values.errors import UsageError, shortened, visible

API = 1
"""Version of the interface of plug-ins; it grows with each change that breaks them (docs/stability.md)."""

STATED_API = "GYRODRIFT_API"
"""Name in the module of an entry point: the version that the plug-in is written for; 1 without it."""

FOLDERS = (".dist-info", ".egg-info")
"""Metadata of installed packages (PEP 376, and setuptools before it)."""

LONGEST_BYTES = 1 << 20
"""Longest file of entry points that is read. Chosen; known files have some kilobytes."""

LONGEST_REASON = 200
"""Characters of an exception that a message quotes."""

MODULES: dict[str, str] = {}
"""Modules of plug-ins that were loaded, with the words that name the plug-in in a message."""

T = TypeVar("T")


class PlugInError(UsageError):
    """A plug-in that cannot be used; the message names it, its package, the reason and the remedy, on one line."""


@dataclass(frozen=True, slots=True)
class EntryPoint:
    """Name and `module` or `module:NAME` of a plug-in, and the package that offers it, installed in a folder."""

    name: str
    value: str
    package: str
    folder: str

    def load(self) -> tuple[ModuleType, Any]:
        """Module and value; what the package prints meanwhile goes to stderr, as stdout may carry samples."""
        module_name, _, name = self.value.partition(":")
        with redirect_stdout(sys.stderr):
            module = import_module(module_name.strip())
            return module, attrgetter(name.strip())(module) if name else module


def entry_points(group: str) -> dict[str, list[EntryPoint]]:
    """Entry points of a group by name; of a package that is there twice, the first on the path counts."""
    offered: dict[str, list[EntryPoint]] = {}
    packages: set[str] = set()
    for folder in dict.fromkeys(name or os.curdir for name in sys.path):
        for metadata in _metadata_folders(folder):
            package = metadata.rpartition(".")[0].partition("-")[0]
            if package in packages:
                continue
            packages.add(package)
            for name, value in _read(f"{folder}/{metadata}/entry_points.txt", group).items():
                offered.setdefault(name, []).append(EntryPoint(name, value, package, folder))
    return offered


def _metadata_folders(folder: str) -> list[str]:
    """Names of the metadata folders in a folder of the path; none in an archive or a missing folder."""
    try:
        return sorted(name for name in os.listdir(folder) if name.endswith(FOLDERS))  # noqa: PTH208 - three times as fast
    except OSError:
        return []


def _read(path: str, group: str) -> Mapping[str, str]:
    """Names and values of a group in a file of entry points; empty for a file that cannot be read."""
    try:
        with open(path, "rb") as file:  # noqa: PTH123 - likewise
            content = file.read(LONGEST_BYTES)
    except OSError:
        return {}
    if f"[{group}]".encode() not in content:
        return {}
    from configparser import ConfigParser  # noqa: PLC0415 - only where there is a plug-in
    from configparser import Error as ConfigFileError  # noqa: PLC0415

    parser = ConfigParser(delimiters=("=",), interpolation=None, strict=False)
    parser.optionxform = str  # type: ignore[assignment,method-assign]  # names keep their case
    try:
        parser.read_string(content.decode())
    except (ConfigFileError, UnicodeDecodeError):
        return {}
    return dict(parser[group])


class PlugIns(Mapping[str, T], Generic[T]):
    """Values by name: those of gyrodrift and of `register`, and those of plug-ins.

    `in` is true for every offered name. Looking one up raises `PlugInError` if its package is broken. A listing has
    the names that work; `problems` are the others.

    Parameters
    ----------
    what
        Kind of value in messages: `output`.
    accept
        Function that makes a value from that of an entry point, or raises `TypeError` or `ValueError` with the reason.
    reserved
        Names of gyrodrift that are no key of `own`.
    """

    def __init__(
        self, what: str, accept: Callable[[EntryPoint, Any], T], reserved: Collection[str] = (), group: str = ""
    ) -> None:
        self.what, self.group = what, group or f"gyrodrift.{what}s"
        self.own: dict[str, T] = {}
        self._accept, self._reserved = accept, reserved
        self._loaded: dict[EntryPoint, T | PlugInError] = {}

    @property
    def loaded(self) -> Mapping[str, T]:
        """Own values, and those of plug-ins that were looked up before; nothing is looked for."""
        return self.own | {e.name: v for e, v in self._loaded.items() if not isinstance(v, PlugInError)}

    def added(self) -> dict[str, T | PlugInError]:
        """Value of each plug-in by name, or what is wrong with it, in alphabetical order."""
        return {name: self._outcome(name, entries) for name, entries in sorted(entry_points(self.group).items())}

    def problems(self) -> list[str]:
        """A line for each plug-in that cannot be used."""
        return [str(outcome) for outcome in self.added().values() if isinstance(outcome, PlugInError)]

    def __getitem__(self, name: str) -> T:
        if name in self.own:
            return self.own[name]
        outcome = self._outcome(name, entry_points(self.group)[name])
        if isinstance(outcome, PlugInError):
            raise outcome
        return outcome

    def __contains__(self, name: object) -> bool:
        return name in self.own or name in entry_points(self.group)

    def __iter__(self) -> Iterator[str]:
        yield from self.own
        yield from (name for name, outcome in self.added().items() if not isinstance(outcome, PlugInError))

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def _outcome(self, name: str, entries: list[EntryPoint]) -> T | PlugInError:
        """Value of a name; a package is imported once."""
        packages = sorted(entry.package for entry in entries)
        if name in self.own or name in self._reserved:
            adds = f"is {_a(self.what)} of gyrodrift, and {', '.join(packages)} adds another"
            return PlugInError(f"{name}: {adds}; uninstall that")
        if len(entries) > 1:
            return PlugInError(f"{name}: is {_a(self.what)} of {' and of '.join(packages)}; uninstall all but one")
        (entry,) = entries
        if entry not in self._loaded:
            self._loaded[entry] = self._load(entry)
        return self._loaded[entry]

    def _load(self, entry: EntryPoint) -> T | PlugInError:
        subject = f"{entry.name}: the {self.what} of {entry.package}"
        remedy = "install another version of it, or uninstall it"
        try:
            module, value = entry.load()
        except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever the code of another package raises
            reason = shortened(visible(str(error).partition("\n")[0]), LONGEST_REASON)
            return PlugInError(f"{subject} cannot be imported: {type(error).__name__}: {reason}; {remedy}")
        stated = getattr(module, STATED_API, API)
        if stated != API:
            is_newer = isinstance(stated, int) and stated > API
            remedy = f"install an older version of {entry.package}, or a newer gyrodrift" if is_newer else remedy
            return PlugInError(f"{subject} is for version {stated!r} of plug-ins, gyrodrift has {API}; {remedy}")
        MODULES[module.__name__] = f"{entry.name}: the {self.what} of {entry.package}"
        try:
            return self._accept(entry, value)
        except Exception as error:  # noqa: BLE001 - a value of another package may raise anything when it is examined
            reason = shortened(visible(str(error).partition("\n")[0]), LONGEST_REASON)
            return PlugInError(f"{subject} is no {self.what}: {reason}; {remedy}")


def failure_in_plug_in(error: BaseException) -> str:
    """Line about an exception that the code of a plug-in raised while it worked; empty for any other exception."""
    frame = error.__traceback__
    subject, line = "", ""
    while frame is not None:
        subject = MODULES.get(frame.tb_frame.f_globals.get("__name__", ""), subject)
        line = f"{os.path.basename(frame.tb_frame.f_code.co_filename)}:{frame.tb_lineno}"  # noqa: PTH119 - a text
        frame = frame.tb_next
    reason = shortened(visible(str(error).partition("\n")[0]), LONGEST_REASON)
    text = f"{subject} failed: {type(error).__name__}: {reason} ({line}); tell its authors, or go on without it"
    return text if subject else ""


def named_record(kind: type[T], attribute: str = "name") -> Callable[[EntryPoint, Any], T]:
    """Function that accepts a record of a class whose attribute is the name of the entry point."""

    def accept(entry: EntryPoint, value: Any) -> T:
        if not isinstance(value, kind):
            raise TypeError(f"{entry.value} is no {kind.__name__}")
        if getattr(value, attribute) != entry.name:
            raise ValueError(f"its {attribute} is {getattr(value, attribute)!r}")
        return value

    return accept


def subclass_of(kind: type[Any], entry: EntryPoint, value: Any) -> type[Any]:
    """Check that the value of an entry point is a class derived from another.

    Raises
    ------
    TypeError
        It is not.
    """
    if not (isinstance(value, type) and issubclass(value, kind)):
        raise TypeError(f"{entry.value} is no class derived from {kind.__name__}")
    return value


def summary(value: object) -> str:
    """First line of a docstring as a phrase: `print a greeting`."""
    first_line = (value.__doc__ or "").strip().partition("\n")[0].rstrip(".")
    return first_line[:1].lower() + first_line[1:]


def _a(what: str) -> str:
    return f"an {what}" if what[0] in "aeiou" else f"a {what}"
