"""Steps that backtracking takes for a regular expression, counted by a small matcher that goes back like `re` does."""

import importlib
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

parser: Any = importlib.import_module("re._parser")
compiler: Any = importlib.import_module("re._compiler")

BUDGET = 200_000
"""Steps for a text of some hundred characters; exponential growth takes more."""

FEW_REPEATS = 4
"""Most optional repeats that are tried as often as the pattern says."""

ONE_STEP = ("LITERAL", "NOT_LITERAL", "IN", "ANY", "AT", "ASSERT", "ASSERT_NOT")

Marks = tuple[int, ...]
"""Places in the text that a match remembers: beginnings and ends of groups, then beginnings of loops."""

Part = Callable[[str, int, Marks], int | None]
"""End of a part at a place of a text; None if the part does not match."""


class TooManyStepsError(Exception):
    """The budget is used up."""


@dataclass
class Step:
    """Instruction of a program; a choice goes on at `first`, and at `second` when it has to go back."""

    kind: str
    value: Any = None
    first: int = 0
    second: int = 0


class Backtracking:
    """Matcher of a pattern: a program of steps, with a stack of the choices that are still open.

    An upper bound above FEW_REPEATS is FEW_REPEATS if `has_bounds`, so that a short text shows it; else there is none.
    """

    def __init__(self, pattern: re.Pattern[Any], *, has_bounds: bool) -> None:
        is_bytes = isinstance(pattern.pattern, bytes)
        text = pattern.pattern.decode("latin-1") if is_bytes else pattern.pattern
        tree = parser.parse(text, pattern.flags & ~re.UNICODE | (re.ASCII if is_bytes else 0))
        self._state = tree.state
        self._has_bounds = has_bounds
        self._marks = 2 * tree.state.groups
        self._steps = 0
        self._program = self._program_of(tree, tree.state.flags)

    def fullmatch(self, text: str) -> bool:
        """Whether the pattern matches all of the text."""
        self._steps = 0
        return self._end(self._program, text, 0, (-1,) * self._marks, is_full=True) is not None

    def steps(self, text: str, *, is_searched: bool) -> int:
        """Steps to match all of the text, or to find each match within it."""
        if not is_searched:
            self.fullmatch(text)
            return self._steps
        self._steps = position = 0
        while position <= len(text):
            end = self._end(self._program, text, position, (-1,) * self._marks)
            position = position + 1 if end is None else max(end, position + 1)
        return self._steps

    def _end(self, program: list[Step], text: str, index: int, marks: Marks, *, is_full: bool = False) -> int | None:
        """End of the first match at a place; None without a match."""
        choices: list[tuple[int, int | None, Marks]] = [(0, index, marks)]
        while choices:
            index, position, marks = choices.pop()
            while position is not None:
                self._steps += 1
                if self._steps > BUDGET:
                    raise TooManyStepsError
                step = program[index]
                index += 1
                match step.kind:
                    case "end":
                        if not is_full or position == len(text):
                            return position
                        break
                    case "part":
                        position = step.value(text, position, marks)
                    case "choice":
                        choices.append((step.second, position, marks))
                        index = step.first
                    case "go":
                        index = step.first
                    case "mark":
                        marks = (*marks[: step.value], position, *marks[step.value + 1 :])
        return None

    def _program_of(self, nodes: Any, flags: int) -> list[Step]:
        program: list[Step] = []
        self._add(program, nodes, flags)
        program.append(Step("end"))
        return program

    def _add(self, program: list[Step], nodes: Any, flags: int) -> None:
        for op, value in nodes:
            match str(op):
                case "MAX_REPEAT" | "MIN_REPEAT":
                    self._add_repeat(program, value, flags, is_greedy=str(op) == "MAX_REPEAT")
                case "SUBPATTERN":
                    group, added, removed, body = value
                    marks = [] if group is None else [Step("mark", 2 * group), Step("mark", 2 * group + 1)]
                    program += marks[:1]
                    self._add(program, body, (flags | added) & ~removed)
                    program += marks[1:]
                case "BRANCH":
                    self._add_branches(program, value[1], flags)
                case _:
                    program.append(Step("part", self._part((op, value), flags)))

    def _part(self, node: Any, flags: int) -> Part:
        """Part that a match does not go back into."""
        kind, value = str(node[0]), node[1]
        match kind:
            case "POSSESSIVE_REPEAT":
                return self._atomic([(parser.MAX_REPEAT, value)], flags)
            case "ATOMIC_GROUP":
                return self._atomic(value, flags)
            case "ASSERT" | "ASSERT_NOT" if value[0] > 0:
                ahead, expected = self._atomic(value[1], flags), kind == "ASSERT"
                return lambda text, position, marks: (
                    position if (ahead(text, position, marks) is not None) == expected else None
                )
            case "GROUPREF":
                return partial(_again, value)
            case _:  # looking back takes one step: its length is fixed
                assert kind in ONE_STEP, kind
                return partial(_one_step, compiler.compile(parser.SubPattern(self._state, [node]), flags))

    def _atomic(self, nodes: Any, flags: int) -> Part:
        return partial(self._end, self._program_of(nodes, flags))

    def _add_branches(self, program: list[Step], branches: Any, flags: int) -> None:
        ways_out = []
        for branch in branches[:-1]:
            choice = Step("choice", first=len(program) + 1)
            program.append(choice)
            self._add(program, branch, flags)
            ways_out.append(Step("go"))
            program.append(ways_out[-1])
            choice.second = len(program)
        self._add(program, branches[-1], flags)
        for way_out in ways_out:
            way_out.first = len(program)

    def _add_repeat(self, program: list[Step], repeat: Any, flags: int, *, is_greedy: bool) -> None:
        least, most, body = repeat
        for _ in range(least):
            self._add(program, body, flags)
        if most == least:
            return
        if most is parser.MAXREPEAT or not (self._has_bounds or most - least <= FEW_REPEATS):
            self._add_loop(program, body, flags, is_greedy=is_greedy)
            return
        choices = []
        for _ in range(min(most - least, FEW_REPEATS)):
            choices.append(Step("choice"))
            program.append(choices[-1])
            choices[-1].first = len(program)
            self._add(program, body, flags)
        for choice in choices:
            choice.second = len(program)
            _order(choice, is_greedy=is_greedy)

    def _add_loop(self, program: list[Step], body: Any, flags: int, *, is_greedy: bool) -> None:
        begin, mark = len(program), self._marks
        self._marks += 1
        choice = Step("choice", first=begin + 1)
        program += [choice, Step("mark", mark)]
        self._add(program, body, flags)
        program += [Step("part", partial(_has_moved, mark)), Step("go", first=begin)]
        choice.second = len(program)
        _order(choice, is_greedy=is_greedy)


def _order(choice: Step, *, is_greedy: bool) -> None:
    """Try another repeat first, or the end of the repeats."""
    if not is_greedy:
        choice.first, choice.second = choice.second, choice.first


def _one_step(pattern: re.Pattern[str], text: str, index: int, _marks: Marks) -> int | None:
    """End of what `re` itself matches."""
    result = pattern.match(text, index)
    return result and result.end()


def _again(group: int, text: str, index: int, marks: Marks) -> int | None:
    """End of the text that a group has matched, if it comes again."""
    result = text[marks[2 * group] : marks[2 * group + 1]]
    return index + len(result) if text.startswith(result, index) else None


def _has_moved(mark: int, _text: str, index: int, marks: Marks) -> int | None:
    """The place, if it lies behind a mark: a loop that does not move ends."""
    return index if index > marks[mark] else None
