"""Strict reading of YAML: plain values, the line of every key, and all mistakes that PyYAML accepts silently.

PyYAML follows YAML 1.1. It reads `1e-3` as text, `1:30` as 90, `on` as true and `017` as 15, and takes the last of two
equal keys. Here numbers have their usual meaning, and the other cases are reported.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from gyrodrift.io.files import UnreadableError, read_ordinary
from gyrodrift.values.errors import shortened, visible
from gyrodrift.values.secret import shown_key, without_secrets

LONGEST_BYTES = 128 << 10
"""A config with a few hundred training sessions in its provenance takes a tenth of this."""

DEEPEST = 32
"""Nesting of blocks; the parser calls itself for each level and would exhaust the stack."""

TOO_NESTED = f"is nested more than {DEEPEST} times"

TOO_DEEP = "maximum nesting depth"
"""Message of parsers with a limit of their own."""

MOST_PROBLEMS = 20
"""Problems that are listed; the search for the nearest key takes time for each."""

LONGEST_PROBLEM = 400
"""Characters of a problem."""

WHOLE_DIGITS = 18
"""Digits of a whole number; longer numbers become floats."""

NUMBER = re.compile(r"[-+]?(?:\d++(?:\.\d*+)?+|\.\d++)(?:[eE][-+]?\d++)?+")
INTEGER = re.compile(r"[-+]?(?:0|[1-9]\d*+)")
NOT_FINITE = re.compile(r"[-+]?\.(?:inf|nan)", re.IGNORECASE)
QUOTED = re.compile(r"'[^']*+'")
QUOTED_MARK = 3
"""Longest quotation of the parser that is shown. Longer quotations are names of anchors and tags, maybe passwords."""

WORDS = {"true": True, "True": True, "false": False, "False": False, "null": None, "~": None, "": None}

LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

Key = tuple[str | int, ...]
"""Path from the top of the file to a value: ("hdr", "tau_s")."""


@dataclass(slots=True)
class YamlFile:
    """A file as text and as plain values, with line and column of each key, and with its problems.

    `nodes` holds the blocks and lists read so far; it serves to find aliases. `prefix` is the key of a block that is
    read like a file of its own.
    """

    path: Path
    text: str = ""
    mode: int = 0o666
    value: Any = None
    positions: dict[Key, tuple[int, int]] = field(default_factory=dict)
    nodes: set[int] = field(default_factory=set)
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
        return YamlFile(self.path, self.text, self.mode, value, positions, self.nodes, key, self._problems)


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
    content, read.mode = ordinary.content, ordinary.mode
    try:
        text = read.text = content.decode("utf-8-sig")
        too_deep = _too_deep(text)
        if too_deep is not None:
            read.report_at(*too_deep, TOO_NESTED)
            return read
        node = yaml.compose(text, Loader=LOADER)
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        read.report_at(line, 1, f"is not text: byte 0x{content[error.start]:02x} is not UTF-8")
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
        problem = QUOTED.sub(
            lambda match: match[0] if len(match[0]) <= QUOTED_MARK else "…", error.problem or error.context or ""
        )
        message = TOO_NESTED if TOO_DEEP in problem else f"is not YAML: {problem}"
        read.report_at(line, column, message)
    except yaml.YAMLError as error:
        read.report((), f"is not YAML: {str(error).splitlines()[0]}")
    else:
        if node is not None:
            read.value = _value(read, (), node)
    return read


def _too_deep(text: str) -> tuple[int, int] | None:
    """Position where the nesting exceeds DEEPEST; the parser of events does not recurse."""
    depth = 0
    for event in yaml.parse(text, Loader=LOADER):
        if isinstance(event, yaml.CollectionStartEvent):
            depth += 1
            if depth > DEEPEST:
                mark = event.start_mark
                return (mark.line + 1, mark.column + 1) if mark else (1, 1)
        elif isinstance(event, yaml.CollectionEndEvent):
            depth -= 1
    return None


def _value(read: YamlFile, key: Key, node: yaml.Node) -> Any:
    read.positions.setdefault(key, _position(node))
    if isinstance(node, yaml.CollectionNode):
        if id(node) in read.nodes:
            read.report(key, "is an alias (*), which may never end; write it out")
            return None
        read.nodes.add(id(node))
    if isinstance(node, yaml.MappingNode):
        return _mapping(read, key, node)
    if isinstance(node, yaml.SequenceNode):
        return [_value(read, (*key, i), item) for i, item in enumerate(node.value)]
    return _scalar(node)


def _mapping(read: YamlFile, key: Key, node: yaml.MappingNode) -> dict[str, Any]:
    values: dict[str, Any] = {}
    for name_node, value_node in node.value:
        if not isinstance(name_node, yaml.ScalarNode):
            read.report_at(*_position(name_node), "a key has to be a word")
            continue
        name = str(name_node.value)
        child = (*key, name)
        if name in values:
            first, _ = read.positions[child]
            read.report_at(
                *_position(name_node),
                f"{'.'.join(shown_key(str(part)) for part in child)}: is given twice, first in line {first}; keep one",
            )
            continue
        read.positions[child] = _position(name_node)
        values[name] = _value(read, child, value_node)
    return values


def _scalar(node: yaml.Node) -> Any:
    text = str(node.value)
    if node.tag == "tag:yaml.org,2002:str" and getattr(node, "style", None) in ("'", '"', "|", ">"):
        return text
    return plain_value(text)


def plain_value(text: str) -> Any:
    """Value of a word without quotes: a number, a truth value, None, or the text."""
    if text in WORDS:
        return WORDS[text]
    if INTEGER.fullmatch(text) and len(text) <= WHOLE_DIGITS:
        return int(text)
    if NUMBER.fullmatch(text) and not re.match(r"[-+]?0\d", text):
        return float(text)
    return float(text.replace(".", "", 1)) if NOT_FINITE.fullmatch(text) else text


def _position(node: yaml.Node) -> tuple[int, int]:
    return node.start_mark.line + 1, node.start_mark.column + 1
