"""The filters for microcontrollers as one C header, joined from the parts in `files/c/filters`."""

import re
from collections.abc import Iterator

from gyrodrift.firmware.parameters import FILTERS_FOLDER

ROOT_PART = "gyrodrift.h"
"""Part that includes all others, with the comment at the head of the result."""

GUARD = re.compile(r"#ifndef (GD_\w+_H|GYRODRIFT_H)\n#define \1\n(.*)#endif\n\Z", re.DOTALL)

INCLUDE = re.compile(r'^#include "(\w+\.h)"\n', re.MULTILINE)


def gyrodrift_h() -> str:
    """Text of `gyrodrift.h` for users."""
    return joined(ROOT_PART)


def joined(part: str) -> str:
    """One header of a part and all parts that it includes, each once and in the order of need."""
    head, body = _head_and_body(part)
    guard = part.upper().replace(".", "_")
    needed = [name for name in _in_order(part, set()) if name != part]
    texts = [_text_alone(name) for name in needed] + [INCLUDE.sub("", body).strip()]
    inner = "\n\n".join(text for text in texts if text)
    return f"{head}#ifndef {guard}\n#define {guard}\n\n{inner}\n\n#endif\n"


def _in_order(part: str, visited: set[str]) -> Iterator[str]:
    """Names of a part and of those that it needs, which come first; `visited` is changed."""
    visited.add(part)
    for name in INCLUDE.findall(_head_and_body(part)[1]):
        if name not in visited:
            yield from _in_order(name, visited)
    yield part


def _text_alone(part: str) -> str:
    """Text of a part without its guard and its includes."""
    head, body = _head_and_body(part)
    return head + INCLUDE.sub("", body).strip()


def _head_and_body(part: str) -> tuple[str, str]:
    """Comment at the head of a part, and its text within the include guard."""
    text = (FILTERS_FOLDER / part).read_text(encoding="utf-8")
    match = GUARD.search(text)
    if match is None:
        raise ValueError(f"{part} has no include guard of the form GD_..._H")
    return text[: match.start()], match[2]
