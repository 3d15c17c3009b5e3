"""Strict YAML files of the host: mistakes with file, line, column and key, without secrets."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from firmware_sim.plain_value import Key
from firmware_sim.strict_yaml import LONGEST_BYTES, parse
from gyrodrift.io.files import UnreadableError, read_ordinary
from gyrodrift.values.errors import shortened, visible
from gyrodrift.values.secret import shown_key, without_secrets

MOST_PROBLEMS = 20
"""Problems that are listed; the search for the nearest key takes time for each."""

LONGEST_PROBLEM = 400
"""Characters of a problem."""


@dataclass(slots=True)
class YamlFile:
    """A file as text and as plain values, with line and column of each key, and with its problems.

    `prefix` is the key of a block that is read like a file of its own.
    """

    path: Path
    text: str = ""
    mode: int = 0o666
    value: Any = None
    positions: dict[Key, tuple[int, int]] = field(default_factory=dict)
    prefix: Key = ()
    _problems: list[tuple[int, int, str]] = field(default_factory=list)

    @property
    def problems(self) -> list[str]:
        """Lines `file:line:column key: problem; expected value`, in the order of the file.

        At most MOST_PROBLEMS, and a line with the number of the others.
        """
        shown = sorted(self._problems)[:MOST_PROBLEMS]
        lines = [
            f"{self.path}:{line}:{column} {shortened(visible(text), LONGEST_PROBLEM)}" for line, column, text in shown
        ]
        hidden = len(self._problems) - len(shown)
        return [*lines, f"{self.path}: {hidden} more mistakes"] if hidden else lines

    def report(self, key: Key, message: str) -> None:
        """Add a problem at the line of a key, or of its block if the key is missing."""
        line, column = self.positions.get(key) or self.positions.get(key[:-1]) or (1, 1)
        name = ".".join(shown_key(str(part)) for part in (*self.prefix, *key))
        self.report_at(line, column, f"{name}: {message}" if name else message)

    def report_at(self, line: int, column: int, message: str) -> None:
        """Add a problem at a position of the file."""
        self._problems.append((line, column, without_secrets(message)))

    def block(self, key: Key) -> "YamlFile":
        """A block inside, like a file of its own; its problems are also those of this file."""
        value, depth = self.value, len(key)
        for part in key:
            value = value.get(part) if isinstance(value, dict) else None
        positions = {name[depth:]: spot for name, spot in self.positions.items() if name[:depth] == key}
        return YamlFile(self.path, self.text, self.mode, value, positions, key, self._problems)


def read_yaml(path: Path) -> YamlFile:
    """Read a file. Mistakes are in `problems`; `value` is None if nothing can be read."""
    read = YamlFile(path)
    try:
        ordinary = read_ordinary(path, LONGEST_BYTES)
    except FileNotFoundError as error:
        read.report((), f"cannot be read: {error.strerror}")
        return read
    except UnreadableError as error:
        no_config = "" if str(error).startswith("cannot") else ": this is no config file"
        read.report((), f"{error}{no_config}")
        return read
    tree = parse(ordinary.content)
    read.mode, read.text = ordinary.mode, ordinary.content.decode("utf-8-sig", "replace")
    read.value, read.positions = tree.value, tree.positions
    for (line, column), key, message in tree.mistakes:
        name = ".".join(shown_key(str(part)) for part in key)
        read.report_at(line, column, f"{name}: {message}" if name else message)
    return read
