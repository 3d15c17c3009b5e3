"""YAML read strictly: plain values, the line of every key, and all that PyYAML would let pass in silence.

PyYAML follows YAML 1.1: it reads `1e-3` as text, `1:30` as 90, `on` as true and `017` as 15, and of a key given
twice the last one wins. Here numbers are what a person means by them, and everything else is reported.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from gyrodrift.errors import shortened, visible
from gyrodrift.files import UnreadableError, read_ordinary
from gyrodrift.secret import shown_key, without_secrets

LONGEST_BYTES = 128 << 10
"""A config of a few hundred training sessions is a tenth of it."""

DEEPEST = 32
"""Blocks within blocks; the parser underneath calls itself for each, until the process dies."""

TOO_NESTED = f"is nested more than {DEEPEST} times"

TOO_DEEP = "maximum nesting depth"
"""Said by parsers that read ahead, and have a limit of their own."""

MOST_PROBLEMS = 20
"""That are told one by one; finding the key that was meant takes a while for each."""

LONGEST_PROBLEM = 400
"""Characters of a problem."""

WHOLE_DIGITS = 18
"""Of a whole number; longer ones are no exact counts of anything."""

NUMBER = re.compile(r"[-+]?(?:\d++(?:\.\d*+)?+|\.\d++)(?:[eE][-+]?\d++)?+")
INTEGER = re.compile(r"[-+]?(?:0|[1-9]\d*+)")
NOT_FINITE = re.compile(r"[-+]?\.(?:inf|nan)", re.IGNORECASE)
QUOTED = re.compile(r"'[^']*+'")
QUOTED_MARK = 3
"""The parser quotes marks of three characters, and names of anchors and tags: these may be passwords."""

WORDS = {"true": True, "True": True, "false": False, "False": False, "null": None, "~": None, "": None}

LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

Key = tuple[str | int, ...]
"""The way from the top of the file to a value: ("hdr", "tau_s")."""


@dataclass(slots=True)
class YamlFile:
    """A file as text and as plain values, with the line and column of each key, and what is wrong with it.

    `nodes` are the blocks and lists read so far, by which aliases are told.
    """

    path: Path
    text: str = ""
    mode: int = 0o666
    value: Any = None
    places: dict[Key, tuple[int, int]] = field(default_factory=dict)
    nodes: set[int] = field(default_factory=set)
    _problems: list[tuple[int, int, str]] = field(default_factory=list)

    @property
    def problems(self) -> list[str]:
        """One line each, in the order of the file: `file:line:column key: what is wrong and what is expected`.

        The first MOST_PROBLEMS, and how many more there are.
        """
        told = sorted(self._problems)[:MOST_PROBLEMS]
        lines = [
            f"{self.path}:{line}:{column} {shortened(visible(text), LONGEST_PROBLEM)}" for line, column, text in told
        ]
        more = len(self._problems) - len(told)
        return [*lines, f"{self.path}: {more} mistakes more"] if more else lines

    def report(self, key: Key, message: str) -> None:
        """Note a problem where the key stands, or where the block stands that it is missing from."""
        line, column = self.places.get(key) or self.places.get(key[:-1]) or (1, 1)
        name = ".".join(shown_key(str(part)) for part in key)
        self.report_at(line, column, f"{name}: {message}" if name else message)

    def report_at(self, line: int, column: int, message: str) -> None:
        """Note a problem at a place of the file."""
        self._problems.append((line, column, without_secrets(message)))


def read_yaml(path: Path) -> YamlFile:
    """Read a file; whatever is wrong with it is in `problems`, and `value` is None where nothing can be read."""
    read = YamlFile(path)
    try:
        found = read_ordinary(path, LONGEST_BYTES)
    except FileNotFoundError as error:
        read.report((), f"cannot be read: {error.strerror}")
        return read
    except UnreadableError as error:
        no_config = "" if str(error).startswith("cannot") else ": this is no config file"
        read.report((), f"{error}{no_config}")
        return read
    content, read.mode = found.content, found.mode
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
            lambda found: found[0] if len(found[0]) <= QUOTED_MARK else "…", error.problem or error.context or ""
        )
        said = TOO_NESTED if TOO_DEEP in problem else f"is not YAML: {problem}"
        read.report_at(line, column, said)
    except yaml.YAMLError as error:
        read.report((), f"is not YAML: {str(error).splitlines()[0]}")
    else:
        if node is not None:
            read.value = _value(read, (), node)
    return read


def _too_deep(text: str) -> tuple[int, int] | None:
    """Line and column where blocks within blocks are more than DEEPEST; events are parsed without going into any."""
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
    read.places.setdefault(key, _place(node))
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
            read.report_at(*_place(name_node), "a key has to be a word")
            continue
        name = str(name_node.value)
        child = (*key, name)
        if name in values:
            first, _ = read.places[child]
            read.report_at(
                *_place(name_node),
                f"{'.'.join(shown_key(str(part)) for part in child)}: is given twice, first in line {first}; keep one",
            )
            continue
        read.places[child] = _place(name_node)
        values[name] = _value(read, child, value_node)
    return values


def _scalar(node: yaml.Node) -> Any:
    text = str(node.value)
    if node.tag == "tag:yaml.org,2002:str" and getattr(node, "style", None) in ("'", '"', "|", ">"):
        return text
    return plain_value(text)


def plain_value(text: str) -> Any:
    """What a word without quotes is: a number, a truth value, nothing, or itself."""
    if text in WORDS:
        return WORDS[text]
    if INTEGER.fullmatch(text) and len(text) <= WHOLE_DIGITS:
        return int(text)
    if NUMBER.fullmatch(text) and not re.match(r"[-+]?0\d", text):
        return float(text)
    return float(text.replace(".", "", 1)) if NOT_FINITE.fullmatch(text) else text


def _place(node: yaml.Node) -> tuple[int, int]:
    return node.start_mark.line + 1, node.start_mark.column + 1
