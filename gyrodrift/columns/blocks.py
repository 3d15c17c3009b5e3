"""Blocks over several lines, as of pretty-printed JSON and protobuf text, and elements in angle brackets on a line."""

import re

NAME = r"[A-Za-z_][\w .-]{0,40}?"
OPENING = re.compile(rf"(?:[\"']?({NAME})[\"']?\s*+[:=]?\s*+)?([{{\[(])|<([A-Za-z_][\w.:-]{{0,40}})>")
CLOSING = re.compile(r"(?:[}\])]{1,4}|</[\w.:-]{1,40}>)\s*+[,;]?+\s*+([{\[]?)")
ITEM = re.compile(r"([-+]?[.0-9][^\s,]{0,30}),?")
DEEPEST = 8
CONTAINER = re.compile(r"imu\d?|data|raw|sensors?|sample|root|record|row|log|entry|msg|message|packet", re.IGNORECASE)
"""Elements that name no quantity."""

MARKUP = re.compile(r"<[A-Za-z_][^<>]*=\s*[\"']|<([A-Za-z_][\w.:-]*)[^<>]*>.*</\1>")
ELEMENT = re.compile(r"<(/?)([A-Za-z_][\w.:-]{0,40})([^<>]*?)(/?)>|([^<>]+)")
ATTRIBUTE = re.compile(r"([A-Za-z_][\w.-]{0,40})\s*=\s*([\"'])([^\"']*)\2")


class Blocks:
    """Names of the blocks that are open."""

    def __init__(self) -> None:
        self._names: list[str] = []
        self._items = 0

    def __bool__(self) -> bool:
        """Whether a block is open."""
        return bool(self._names)

    def take(self, line: str) -> bool:
        """Whether a line only begins or ends a block."""
        if line[-1:] not in "{[(>}]),;":
            return False
        if opening := OPENING.fullmatch(line):
            self._open(opening[1] or opening[3] or "")
            return True
        if closing := CLOSING.fullmatch(line):
            if self._names:
                self._names.pop()
            if closing[1]:
                self._open("")
            return True
        return False

    def _open(self, name: str) -> None:
        if (not name and "" in self._names) or len(self._names) >= DEEPEST:
            self._names = []  # an end was lost
        self._names.append("" if CONTAINER.fullmatch(name) else name)
        self._items = 0

    def item(self, line: str) -> tuple[str, str] | None:
        """Index and text of a number that stands alone in a block; None for another line."""
        item = ITEM.fullmatch(line) if self._names and self._names[-1] else None
        if item is None:
            return None
        self._items += 1
        return str(self._items - 1), item[1]

    def label(self, label: str) -> str:
        """Label with the names of its blocks, as in a JSON object on a single line."""
        return ".".join([*filter(None, self._names), label])


def flat_markup(line: str) -> str:
    """Values of elements as `label=value` pairs; the same line if it has no elements with values."""
    if not (line.startswith("<") and MARKUP.match(line)):
        return line
    names: list[str] = []
    pairs: list[str] = []
    for end, name, attributes, is_empty, text in ELEMENT.findall(line):
        if end:
            del names[-1:]
        elif name:
            names.append(name)
            pairs += [_pair([*names, key], value) for key, _, value in ATTRIBUTE.findall(attributes)]
            if is_empty:
                names.pop()
        elif text.strip():
            pairs.append(_pair(names, text.strip()))
    return ", ".join(pairs)


def _pair(names: list[str], value: str) -> str:
    return f"{'.'.join(name for name in names if not CONTAINER.fullmatch(name))}={value}"
