"""Strict YAML for a checked model: all mistakes at once, as `file:line:column key: problem`.

PyYAML reads `1e-3` as text, `on` as true, and accepts duplicate keys. Here a number is a number, and a duplicate key is
a mistake.
"""

import re
from pathlib import Path
from typing import Any, TypeVar

import yaml
from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import ErrorDetails

NUMBER = re.compile(r"[-+]?(?:(?:0|[1-9]\d*+)(?:\.\d*+)?+|\.\d++)(?:[eE][-+]?\d++)?+")
WORDS = {"true": True, "false": False, "null": None, "~": None, "": None}

LONGEST = 1 << 17
"""Largest size of a file, in characters; a profile of a thousand segments has half of it."""

PROBLEMS_MAX, LONGEST_PROBLEM = 20, 600
"""Largest number of reported problems, and largest length of a problem."""

WHOLE_DIGITS = 300
"""Largest number of digits of a whole number; longer ones exceed all floats."""

DEEPEST = 32
"""Largest depth of nested blocks; a recursive parser takes seconds for deeper ones."""

LINES_MAX = 40
"""Largest number of lines of a message."""

TOO_DEEP = "maximum nesting depth"
"""Message of the C parser."""

LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
"""The C parser is about ten times as fast; some builds of PyYAML lack it."""

Key = tuple[str | int, ...]
Position = tuple[int, int]


class FileError(Exception):
    """Mistakes in a rig or profile, one per line, of limited length."""

    def __init__(self, message: str) -> None:
        super().__init__("\n".join(_shortened(line) for line in message.split("\n")[:LINES_MAX]))


class Checked(BaseModel):
    """Block of a file: unknown keys are mistakes, and numbers must be finite."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True)


Model = TypeVar("Model", bound=Checked)


class _Reader:
    """Convert nodes to plain values, and keep their positions."""

    def __init__(self) -> None:
        self.positions: dict[Key, Position] = {(): (1, 1)}
        self.problems: list[tuple[Position, str]] = []
        self._read: set[int] = set()

    def value(self, key: Key, node: yaml.Node | None) -> Any:
        if isinstance(node, yaml.CollectionNode):
            if id(node) in self._read:
                self.problems.append((_position(node), f"{_dotted(key)}: is an alias (*); write the value"))
                return None
            self._read.add(id(node))
        if isinstance(node, yaml.MappingNode):
            return self._mapping(key, node)
        if isinstance(node, yaml.SequenceNode):
            for index, item in enumerate(node.value):
                self.positions[*key, index] = _position(item)
            return [self.value((*key, index), item) for index, item in enumerate(node.value)]
        return None if node is None else _scalar(node)

    def _mapping(self, key: Key, node: yaml.MappingNode) -> dict[str, Any]:
        values: dict[str, Any] = {}
        for name_node, value_node in node.value:
            if not isinstance(name_node, yaml.ScalarNode):
                self.problems.append((_position(name_node), f"{_dotted(key)}: a key must be a word"))
                continue
            name = str(name_node.value)
            if name in values:
                self.problems.append((_position(name_node), f"{_dotted((*key, name))}: is given twice"))
                continue
            self.positions[*key, name] = _position(name_node)
            values[name] = self.value((*key, name), value_node)
        return values

    def note(self, location: Key, message: str) -> None:
        """Add a problem at its key, or at the nearest block around it.

        Names of variants (the `ramp` in segments.3.ramp.to_dps) are not keys of the file, and are dropped.
        """
        key: Key = ()
        for part in location:
            if (*key, part) in self.positions:
                key = (*key, part)
        missing = location[-1:] if location and key[-1:] != location[-1:] else ()
        self.problems.append((self.positions[key], f"{_dotted(key + missing)}: {message}"))


def load(path: Path, model: type[Model]) -> Model:
    """Read a file into a model.

    Raises
    ------
    FileError
        The file has mistakes; the message lists all of them.
    """
    reader = _Reader()
    value = reader.value((), _compose(path))
    try:
        checked = model.model_validate(value if value is not None else {})
    except ValidationError as error:
        for problem in error.errors(include_url=False):
            if problem["type"] != "too_short" or not problem["input"]:  # not a list whose items all failed
                reader.note(problem["loc"], _phrase(problem))
    if reader.problems:
        raise FileError("\n".join(_lines(path, sorted(reader.problems))))
    return checked


def top_keys(path: Path) -> set[str]:
    """Keys of the outermost block of a file; empty if it has none.

    Raises
    ------
    FileError
        The file is not YAML, or cannot be read.
    """
    node = _compose(path)
    return {str(key.value) for key, _ in node.value} if isinstance(node, yaml.MappingNode) else set()


def _lines(path: Path, problems: list[tuple[Position, str]]) -> list[str]:
    """Lines for the first problems."""
    lines = [f"{path}:{line}:{column} {_shortened(text)}" for (line, column), text in problems[:PROBLEMS_MAX]]
    further = len(problems) - len(lines)
    return [*lines, f"{path}: {further} more mistakes"] if further else lines


def _shortened(text: str) -> str:
    return text if len(text) <= LONGEST_PROBLEM else f"{text[: LONGEST_PROBLEM // 2]} … {text[-LONGEST_PROBLEM // 4 :]}"


def problems_of(error: ValidationError) -> list[str]:
    """Problems of a block that is not from a file: `key problem`."""
    return [f"{_dotted(problem['loc'])} {_phrase(problem)}" for problem in error.errors(include_url=False)]


def _compose(path: Path) -> yaml.Node | None:
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise FileError(f"{path}: is not an ordinary file")
    try:
        with path.open(encoding="utf-8") as file:
            text = file.read(LONGEST + 1)
        if len(text) > LONGEST:
            raise FileError(f"{path}: is longer than {LONGEST >> 10} thousand characters: this is not a rig or profile")
        _check_depth(path, text)
        node: yaml.Node | None = yaml.compose(text, Loader=LOADER)
    except OSError as error:
        raise FileError(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise FileError(f"{path}: is not text") from error
    except yaml.MarkedYAMLError as error:
        if TOO_DEEP in str(error.problem):
            raise FileError(f"{path}: has too many nested blocks") from error
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        raise FileError(f"{path}:{line}:1 is not YAML: {error.problem}") from error
    except yaml.YAMLError as error:
        raise FileError(f"{path}:1:1 is not YAML: {str(error).splitlines()[0]}") from error
    return node


def _check_depth(path: Path, text: str) -> None:
    """Refuse deeply nested blocks; the event parser does not recurse."""
    depth = 0
    for event in yaml.parse(text, Loader=LOADER):
        depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
        if depth > DEEPEST:
            raise FileError(f"{path}: has too many nested blocks")


def _scalar(node: yaml.Node) -> Any:
    text = str(node.value)
    if getattr(node, "style", None) in ("'", '"', "|", ">"):
        return text
    if text.lower() in WORDS:
        return WORDS[text.lower()]
    if NUMBER.fullmatch(text):
        return int(text) if text.lstrip("+-").isdigit() and len(text) <= WHOLE_DIGITS else float(text)
    return text


def _phrase(problem: ErrorDetails) -> str:
    """Problem in terms of YAML."""
    given, limits = problem["input"], problem.get("ctx", {})
    match problem["type"]:
        case "extra_forbidden":
            return "is not known here"
        case "missing" | "union_tag_not_found":
            return f"{limits.get('discriminator', '')} is missing".strip()
        case "union_tag_invalid":
            return f"{limits['tag']!r} is not known; there are {limits['expected_tags']}"
        case "model_type" | "model_attributes_type" | "dict_type":
            return f"is {given!r}; expected a block of keys"
        case "tuple_type" | "list_type":
            return f"is {given!r}; expected a list"
        case _:
            return f"is {given!r}; {problem['msg'][0].lower()}{problem['msg'][1:]}"


def _position(node: yaml.Node) -> Position:
    return node.start_mark.line + 1, node.start_mark.column + 1


def _dotted(key: Key) -> str:
    return ".".join(map(str, key)) or "the file"
