"""Regular expressions on text that came from elsewhere: each takes time that grows with the length alone.

Every pattern of the package is given what makes backtracking worst: the texts that its own parts match, over and over,
behind a beginning that it likes, with an end that it does not.
"""

import ast
import importlib
import itertools
import pkgutil
import re
import signal
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import FrameType
from typing import Any

import pytest

import gyrodrift

SOURCE = "\n".join(path.read_text() for path in Path(gyrodrift.__file__).parent.rglob("*.py"))
OURS = ("gyrodrift.report.", "gyrodrift.demo.", "gyrodrift.simulation.", "gyrodrift.link.text.")
"""Rooms whose patterns see what this program wrote, or single lines of a device, whose length is bounded."""

SHORT, LONG = 8192, 32768
MOST_RATIO = 10.0
"""Of the times for the two lengths: 4 where they are linear, 16 where they are quadratic."""

QUICK_S = 0.02
"""Who is done with LONG by then is not quadratic: that would be 500 million steps."""

PATIENCE_S = 0.3
"""Processor time for one text; what takes longer is not linear."""

MOST_CHARACTERS = 3
"""Of a pattern, that are taken in pairs."""

CALLS = {f"re.{name}" for name in ("match", "fullmatch", "search", "sub", "split", "findall", "finditer")}
parser: Any = importlib.import_module("re._parser")


class TooLongError(Exception):
    """A pattern was not done in time."""


def modules() -> Iterator[str]:
    """All of the package that can be imported without running."""
    for each in pkgutil.walk_packages(gyrodrift.__path__, "gyrodrift."):
        if not each.name.endswith("__main__") and not each.name.startswith(OURS):
            yield each.name


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
    found: dict[Any, tuple[str, re.Pattern[Any], bool]] = {}
    for name in modules():
        try:
            module = importlib.import_module(name)
        except ImportError:  # its packages are not there
            continue
        assert module.__file__ is not None
        for attribute, value in vars(module).items():
            for each in within(value):
                searched = is_looked_for(attribute if each is value else "")
                found.setdefault((each.pattern, each.flags), (name, each, searched))
        for each in written_in(Path(module.__file__)):
            found.setdefault((each.pattern, each.flags), (name, each, True))
    return {f"{name}:{each.pattern!r}": (each, searched) for name, each, searched in found.values()}


def characters(node: Any) -> list[str]:
    """Some that a class or a category matches."""
    categories = {"DIGIT": "7", "SPACE": " ", "WORD": "a", "NOT_DIGIT": "a", "NOT_SPACE": "a", "NOT_WORD": "-"}
    some: list[str] = []
    for op, value in node:
        match str(op):
            case "NEGATE":
                excluded = {chr(value) for op, value in node if str(op) == "LITERAL"}
                return [each for each in "a7 -:,\\x'\"<[" if each not in excluded][:4]
            case "LITERAL":
                some.append(chr(value))
            case "RANGE":
                some.append(chr(value[0]))
            case "CATEGORY":
                some.append(categories[str(value).removeprefix("CATEGORY_")])
    return some


class Texts:
    """What the parts of a pattern match: `units` of its repeats, each with a beginning that leads to it."""

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


def time_s(call: Callable[[Any], object], text: str | bytes) -> float:
    """Processor time; TooLongError behind PATIENCE_S."""
    begun_s = time.process_time()
    signal.setitimer(signal.ITIMER_VIRTUAL, PATIENCE_S)
    try:
        call(text)
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
    return time.process_time() - begun_s


def is_linear(call: Callable[[Any], object], text_of: Callable[[int], str | bytes]) -> bool:
    """Whether four times the text takes about four times as long."""
    try:
        long_s = time_s(call, text_of(LONG))
        if long_s < QUICK_S:
            return True
        ratios = [
            time_s(call, text_of(LONG)) / max(min(time_s(call, text_of(SHORT)) for _ in range(3)), 1e-9)
            for _ in range(3)
        ]
    except TooLongError:
        return False
    return min(ratios) < MOST_RATIO


def is_looked_for(name: str) -> bool:
    """Whether a pattern with this name is searched for in a text anywhere, not compared with its beginning alone."""
    return not name or re.search(rf"\b{name}\.(?:search|sub|subn|finditer|findall|split)\b", SOURCE) is not None


def slow_text(pattern: re.Pattern[Any], *, is_searched: bool = True) -> str:
    """One that it takes too long for; empty where there is none."""
    calls: list[Callable[[Any], object]] = [pattern.fullmatch]
    if is_searched:
        calls.append(lambda text: sum(1 for _ in pattern.finditer(text)))
    is_bytes = isinstance(pattern.pattern, bytes)
    for before, unit in Texts(pattern).all():

        def text_of(length: int, before: str = before, unit: str = unit) -> str | bytes:
            text = before + unit * (length // max(1, len(unit))) + "\0"
            return text.encode("latin-1", "replace") if is_bytes else text

        for call in calls:
            if unit and not is_linear(call, text_of):
                return f"{before!r} + {unit!r}*n"
    return ""


@pytest.fixture(autouse=True)
def alarm() -> Iterator[None]:
    def end(_number: int, _frame: FrameType | None) -> None:
        raise TooLongError

    before = signal.signal(signal.SIGVTALRM, end)
    yield
    signal.signal(signal.SIGVTALRM, before)


def test_every_pattern_takes_time_that_grows_with_the_length_alone() -> None:
    """A text of a device, a client, a file or a config cannot hold up anybody."""
    found = patterns()
    assert len(found) > 50
    slow = {name: text for name, (each, looked) in found.items() if (text := slow_text(each, is_searched=looked))}
    assert slow == {}


@pytest.mark.parametrize("pattern", [r"(a+)+b", r"\d+\d+x", r"(?:x*)*y", r"\s*\n\s*;", r"<[^>]*>", r"a.*?b.*?c"])
def test_a_pattern_that_goes_back_is_found(pattern: str) -> None:
    """Nested repeats, two that match the same, and a beginning that is looked for over and over."""
    assert slow_text(re.compile(pattern))
