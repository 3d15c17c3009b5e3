"""Regular expressions on text from elsewhere: each takes time that grows with the length of the text alone.

Every pattern of the package gets the texts that make backtracking worst: what its own parts match, repeated, behind a
beginning that it matches, with an end that it does not. `Backtracking` counts the steps; no clock is read.
"""

import ast
import importlib
import itertools
import pkgutil
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from pattern_steps import Backtracking, TooManyStepsError

import gyrodrift

SOURCE = "\n".join(path.read_text() for path in Path(gyrodrift.__file__).parent.rglob("*.py"))
OURS = (
    "gyrodrift.report.",
    "gyrodrift.demo.",
    "gyrodrift.simulation.",
    "gyrodrift.columns.fields",
    "gyrodrift.columns.blocks",
)
"""Packages whose patterns see what this program wrote, or single lines of a device, whose length is bounded."""

REPETITIONS = (8, 16, 32)
"""Repetitions of a unit. Linear steps grow twice as much from one pair to the next, quadratic steps four times."""

MOST_RATIO = 2.25

MOST_CHARACTERS = 3
"""Characters of a pattern that are taken in pairs."""

CALLS = {f"re.{name}" for name in ("match", "fullmatch", "search", "sub", "split", "findall", "finditer")}
parser: Any = importlib.import_module("re._parser")


def modules() -> Iterator[str]:
    """All of the package that can be imported without running."""
    for package in pkgutil.walk_packages(gyrodrift.__path__, "gyrodrift."):
        if not package.name.endswith("__main__") and not package.name.startswith(OURS):
            yield package.name


def within(value: Any) -> Iterator[re.Pattern[Any]]:
    """Patterns of a value and of what it holds."""
    match value:
        case re.Pattern():
            yield value
        case dict():
            yield from itertools.chain.from_iterable(map(within, value.values()))
        case tuple() | list() | set() | frozenset():
            yield from itertools.chain.from_iterable(map(within, value))


def written_in(path: Path) -> Iterator[re.Pattern[Any]]:
    """Patterns that stand in calls such as `re.sub("...", ...)`."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Call) and ast.unparse(node.func) in CALLS and node.args:
            word = node.args[0]
            if isinstance(word, ast.Constant) and isinstance(word.value, str | bytes):
                flags = re.DOTALL if "DOTALL" in ast.unparse(node) else 0
                yield re.compile(word.value, flags)


def patterns() -> dict[str, tuple[re.Pattern[Any], bool]]:
    """Each once, by a name and itself, and whether texts are searched for it."""
    result: dict[Any, tuple[str, re.Pattern[Any], bool]] = {}
    for name in modules():
        try:
            module = importlib.import_module(name)
        except ImportError:  # its packages are not there
            continue
        assert module.__file__ is not None
        for attribute, value in vars(module).items():
            for item in within(value):
                searched = is_looked_for(attribute if item is value else "")
                result.setdefault((item.pattern, item.flags), (name, item, searched))
        for item in written_in(Path(module.__file__)):
            result.setdefault((item.pattern, item.flags), (name, item, True))
    return {f"{name}:{item.pattern!r}": (item, searched) for name, item, searched in result.values()}


def characters(node: Any) -> list[str]:
    """Some that a class or a category matches."""
    categories = {"DIGIT": "7", "SPACE": " ", "WORD": "a", "NOT_DIGIT": "a", "NOT_SPACE": "a", "NOT_WORD": "-"}
    some: list[str] = []
    for op, value in node:
        match str(op):
            case "NEGATE":
                excluded = {chr(value) for op, value in node if str(op) == "LITERAL"}
                return [item for item in "a7 -:,\\x'\"<[" if item not in excluded][:4]
            case "LITERAL":
                some.append(chr(value))
            case "RANGE":
                some.append(chr(value[0]))
            case "CATEGORY":
                some.append(categories[str(value).removeprefix("CATEGORY_")])
    return some


class Texts:
    """Texts that parts of a pattern match: `units` of its repeats, each with a beginning that leads to it."""

    def __init__(self, pattern: re.Pattern[Any]) -> None:
        text = pattern.pattern if isinstance(pattern.pattern, str) else pattern.pattern.decode("latin-1")
        self.characters: dict[str, None] = {}
        self.units: dict[tuple[str, str], None] = {}
        whole = self._sample(parser.parse(text, pattern.flags & ~re.UNICODE), "")
        self.units["", whole] = self.units["", whole[:-1]] = None

    def all(self) -> Iterator[tuple[str, str]]:
        """Beginnings and what is repeated behind them."""
        some = list(self.characters)[:MOST_CHARACTERS]
        pairs = ["".join(pair) for pair in itertools.permutations(some, 2)]
        begun = {before for before, _ in self.units}
        yield from self.units
        yield from itertools.product(begun, [*self.characters, *pairs])

    def _sample(self, nodes: Any, before: str) -> str:
        made = ""
        for op, value in nodes:
            made += self._of(str(op), value, before + made)
        return made

    def _of(self, op: str, value: Any, before: str) -> str:  # noqa: PLR0911 - one for each kind of part
        match op:
            case "LITERAL":
                self.characters[chr(value)] = None
                return chr(value)
            case "NOT_LITERAL":
                self.characters |= dict.fromkeys([chr(value), "a"])
                return "a" if chr(value) != "a" else "b"
            case "IN":
                some = characters(value)
                self.characters |= dict.fromkeys(some)
                return some[0] if some else "a"
            case "ANY":
                self.characters["a"] = None
                return "a"
            case "MAX_REPEAT" | "MIN_REPEAT" | "POSSESSIVE_REPEAT":
                least, most, body = value
                unit = self._sample(body, before)
                self.units[before, unit] = None
                return unit * int(max(least, min(1, int(most))))
            case "SUBPATTERN":
                return self._sample(value[-1], before)
            case "ATOMIC_GROUP":
                return self._sample(value, before)
            case "BRANCH":
                return next(self._sample(branch, before) for branch in value[1])
            case _:  # what matches nothing: anchors, looks ahead and back
                return ""


def is_linear(matcher: Backtracking, before: str, unit: str, *, is_searched: bool) -> bool:
    """Whether twice the repetitions take about twice the steps."""
    try:
        counts = (matcher.steps(before + unit * count + "\0", is_searched=is_searched) for count in REPETITIONS)
        few, some = next(counts), next(counts)
        return few == some or next(counts) - some <= MOST_RATIO * (some - few)
    except TooManyStepsError:
        return False


def is_looked_for(name: str) -> bool:
    """Whether a pattern with this name is searched for in a text anywhere, not compared with its beginning alone."""
    return not name or re.search(rf"\b{name}\.(?:search|sub|subn|finditer|findall|split)\b", SOURCE) is not None


def slow_text(pattern: re.Pattern[Any], *, is_searched: bool = True) -> str:
    """A text whose steps grow faster than its length; empty if there is none.

    A search is a match at each place, so a bound in a pattern bounds what a place costs. One match has no such excuse.
    """
    matchers = [(Backtracking(pattern, has_bounds=False), False)]
    if is_searched:
        matchers.append((Backtracking(pattern, has_bounds=True), True))
    for before, unit in Texts(pattern).all():
        for matcher, searched in matchers:
            if unit and not is_linear(matcher, before, unit, is_searched=searched):
                return f"{before!r} + {unit!r}*n"
    return ""


@pytest.mark.promise(
    "Configs and commands",
    "the time of a regular expression grows with the length of the text only (except those for single "
    "lines of a device)",
)
def test_every_pattern_takes_time_that_grows_with_the_length_alone() -> None:
    """A text of a device, a client, a file or a config cannot hold up anybody."""
    result = patterns()
    assert len(result) > 50
    slow = {name: text for name, (item, looked) in result.items() if (text := slow_text(item, is_searched=looked))}
    assert slow == {}


@pytest.mark.parametrize(
    "pattern", [r"(a+)+b", r"\d+\d+x", r"(?:x*)*y", r"\s*\n\s*;", r"<[^>]*>", r"a.*?b.*?c", r"(?:a|a)*b", r"a*(?=a*b)a"]
)
def test_a_pattern_that_goes_back_is_found(pattern: str) -> None:
    """Nested repeats, two that match the same, and a beginning that is looked for over and over."""
    assert slow_text(re.compile(pattern))


@pytest.mark.parametrize("pattern", [r"(a++)+b", r"(?>\d+)x", r"a*b", r"<[^>]*>", r"(a)(?!\1)b?", r"(?<=a)b*+|c"])
def test_a_pattern_that_does_not_go_back_passes(pattern: str) -> None:
    assert not slow_text(re.compile(pattern), is_searched=False)


@pytest.mark.parametrize(
    "pattern",
    [
        r"(a+)+b",
        r"(?:a*)*b?",
        r"(?:ab|a)(?:b,)?+",
        r"(?>a|ab)b",
        r"(?:a|ab)b",
        r"a*?b{2,3}",
        r"a*+a",
        r"(a|b)\1,?",
        r"(?:(?=ab).|,)*+b",
        r"(?:a(?!b)|b(?<=ab))+",
        r"(?i:A)[^a]*$",
        r"\b[ab]+\b,?",
        r"(?:a??b){1,2}",
    ],
)
def test_the_matcher_that_counts_finds_what_re_finds(pattern: str) -> None:
    matcher, compiled = Backtracking(re.compile(pattern), has_bounds=True), re.compile(pattern)
    for length in range(6):
        for text in map("".join, itertools.product("ab,", repeat=length)):
            assert matcher.fullmatch(text) == bool(compiled.fullmatch(text)), text
