"""Files of the rig as checked models: all mistakes at once, as `file:line:column key: problem`."""

from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import ErrorDetails

from firmware_sim.plain_value import Key
from firmware_sim.strict_yaml import LONGEST_BYTES, Position, YamlTree, parse

PROBLEMS_MAX, LONGEST_PROBLEM = 20, 600
"""Largest number of reported problems, and largest length of a problem."""

LINES_MAX = 40
"""Largest number of lines of a message."""


class FileError(Exception):
    """Mistakes in a rig or profile, one per line, of limited length."""

    def __init__(self, message: str) -> None:
        super().__init__("\n".join(_shortened(line) for line in message.split("\n")[:LINES_MAX]))


class Checked(BaseModel):
    """Block of a file: unknown keys are mistakes, and numbers must be finite."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True)


Model = TypeVar("Model", bound=Checked)


def load(path: Path, model: type[Model]) -> Model:
    """Read a file into a model.

    Raises
    ------
    FileError
        The file has mistakes; the message lists all of them.
    """
    tree = _tree_of(path)
    problems = [
        (position, f"{_dotted(key)}: {message}" if key else message) for position, key, message in tree.mistakes
    ]
    if tree.value is None and problems:
        raise FileError("\n".join(_lines(path, problems)))
    try:
        checked = model.model_validate(tree.value if tree.value is not None else {})
    except ValidationError as error:
        problems += [
            _located(tree.positions, problem["loc"], _phrase(problem))
            for problem in error.errors(include_url=False)
            if problem["type"] != "too_short" or not problem["input"]  # not a list whose items all failed
        ]
    if problems:
        raise FileError("\n".join(_lines(path, sorted(problems))))
    return checked


def top_keys(path: Path) -> set[str]:
    """Keys of the outermost block of a file; empty if it has none.

    Raises
    ------
    FileError
        The file cannot be read.
    """
    value = _tree_of(path).value
    return set(value) if isinstance(value, dict) else set()


def _located(positions: dict[Key, Position], location: Key, message: str) -> tuple[Position, str]:
    """Problem at its key, or at the nearest block around it.

    Names of variants (the `ramp` in segments.3.ramp.to_dps) are not keys of the file, and are dropped.
    """
    key: Key = ()
    for part in location:
        if (*key, part) in positions:
            key = (*key, part)
    missing = location[-1:] if location and key[-1:] != location[-1:] else ()
    return positions.get(key, (1, 1)) if key else (1, 1), f"{_dotted(key + missing)}: {message}"


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


def _tree_of(path: Path) -> YamlTree:
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise FileError(f"{path}: is not an ordinary file")
    try:
        with path.open("rb") as file:
            content = file.read(LONGEST_BYTES + 1)
    except OSError as error:
        raise FileError(f"{path}: cannot be read: {error.strerror}") from error
    if len(content) > LONGEST_BYTES:
        raise FileError(
            f"{path}: is longer than {LONGEST_BYTES >> 10} thousand characters: this is not a rig or profile"
        )
    return parse(content)


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


def _dotted(key: Key) -> str:
    return ".".join(map(str, key)) or "the file"
