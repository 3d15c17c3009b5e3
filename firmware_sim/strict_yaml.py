"""Strict YAML: plain values, the position of every key, and all mistakes that PyYAML accepts silently.

PyYAML follows YAML 1.1. It reads `1e-3` as text, `1:30` as 90, `on` as true and `017` as 15, and takes the last of two
equal keys. Here numbers have their usual meaning, and the other cases are mistakes.

Configs of the host and files of the rig are read by this module. It imports nothing of either.
"""

import re
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import yaml

from firmware_sim.plain_value import Key, plain_value

LONGEST_BYTES = 128 << 10
"""Largest file. A config with hundreds of sessions in its provenance has a tenth of it, a long profile half."""

DEEPEST = 32
"""Nesting of blocks; the parser calls itself for each level and would exhaust the stack."""

TOO_NESTED = f"is nested more than {DEEPEST} times"
TOO_DEEP = "maximum nesting depth"
"""Message of parsers with a limit of their own."""

QUOTED = re.compile(r"'[^']*+'")
QUOTED_MARK = 3
"""Longest quotation of the parser that is shown. Longer quotations are names of anchors and tags, maybe passwords."""

LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
"""The C parser is about ten times as fast; some builds of PyYAML lack it."""

Position = tuple[int, int]
"""Line and column, from 1."""


class Mistake(NamedTuple):
    """A mistake at a position; the key is empty if there is none."""

    position: Position
    key: Key
    message: str


@dataclass(slots=True)
class YamlTree:
    """Plain values of a text, the position of each key, and the mistakes. `value` is None if nothing can be read."""

    value: Any = None
    positions: dict[Key, Position] = field(default_factory=dict)
    mistakes: list[Mistake] = field(default_factory=list)


def parse(content: bytes) -> YamlTree:
    """Read a file of UTF-8."""
    tree = YamlTree()
    try:
        text = content.decode("utf-8-sig")
        too_deep = _too_deep(text)
        if too_deep is not None:
            tree.mistakes.append(Mistake(too_deep, (), TOO_NESTED))
            return tree
        node = yaml.compose(text, Loader=LOADER)
    except UnicodeDecodeError as error:
        position = (content[: error.start].count(b"\n") + 1, 1)
        tree.mistakes.append(Mistake(position, (), f"is not text: byte 0x{content[error.start]:02x} is not UTF-8"))
    except yaml.YAMLError as error:
        tree.mistakes.append(_syntax_mistake(error))
    else:
        if node is not None:
            tree.value = _TreeBuilder(tree).value((), node)
    return tree


def _syntax_mistake(error: yaml.YAMLError) -> Mistake:
    if not isinstance(error, yaml.MarkedYAMLError):
        return Mistake((1, 1), (), f"is not YAML: {str(error).splitlines()[0]}")
    mark = error.problem_mark or error.context_mark
    position = (mark.line + 1, mark.column + 1) if mark else (1, 1)
    problem = QUOTED.sub(
        lambda match: match[0] if len(match[0]) <= QUOTED_MARK else "…", error.problem or error.context or ""
    )
    return Mistake(position, (), TOO_NESTED if TOO_DEEP in problem else f"is not YAML: {problem}")


def _too_deep(text: str) -> Position | None:
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


class _TreeBuilder:
    """Convert nodes to plain values."""

    def __init__(self, tree: YamlTree) -> None:
        self._tree = tree
        self._blocks: set[int] = set()

    def value(self, key: Key, node: yaml.Node) -> Any:
        self._tree.positions.setdefault(key, _position(node))
        if isinstance(node, yaml.CollectionNode):
            if id(node) in self._blocks:
                message = "is an alias (*), which may never end; write it out"
                self._tree.mistakes.append(Mistake(self._tree.positions[key], key, message))
                return None
            self._blocks.add(id(node))
        if isinstance(node, yaml.MappingNode):
            return self._mapping(key, node)
        if isinstance(node, yaml.SequenceNode):
            return [self.value((*key, index), item) for index, item in enumerate(node.value)]
        return _scalar(node)

    def _mapping(self, key: Key, node: yaml.MappingNode) -> dict[str, Any]:
        values: dict[str, Any] = {}
        for name_node, value_node in node.value:
            position = _position(name_node)
            if not isinstance(name_node, yaml.ScalarNode):
                self._tree.mistakes.append(Mistake(position, key, "a key has to be a word"))
                continue
            name = str(name_node.value)
            child = (*key, name)
            if name in values:
                message = f"is given twice, first in line {self._tree.positions[child][0]}; keep one"
                self._tree.mistakes.append(Mistake(position, child, message))
                continue
            self._tree.positions[child] = position
            values[name] = self.value(child, value_node)
        return values


def _scalar(node: yaml.Node) -> Any:
    text = str(node.value)
    return text if getattr(node, "style", None) in ("'", '"', "|", ">") else plain_value(text)


def _position(node: yaml.Node) -> Position:
    return node.start_mark.line + 1, node.start_mark.column + 1
