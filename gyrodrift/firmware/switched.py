"""The switches of `gyrodrift.h`, its contents, and the marks of internal parts, added when the parts are joined.

A file that includes the header gets functions of its own. Where several files of a program use a filter, one of them
defines `GYRODRIFT_IMPLEMENTATION` and gets the only copy; the others define `GYRODRIFT_SHARED` and get declarations.
"""

import re
import textwrap
from collections.abc import Iterable, Iterator

FILTERS = ("hdr", "restlevel", "attitude")
PUBLIC = re.compile(
    rf"gd_(?:{'|'.join(FILTERS)})_(?:init|zero|remember|gap|restarted|work|heading|turn_rate|speed|update(?:_us)?(?:_with)?)"
    r"|gd_roll_deg|gd_pitch_deg|gd_calibrated_dps|gd_calibrate_axes"
)
"""Functions that users call; the others are internal."""

FOR_USERS = ("real.h", "parameters.h", "wrappers.h")
"""Parts without such functions that users need."""

FUNCTION = re.compile(
    r"^static inline (?P<head>[^;{}]*?\b(?P<name>gd_\w+)\([^;{}]*\)) \{$(?P<body>.*?)^\}$", re.MULTILINE | re.DOTALL
)
"""A function of more than one line, as the formatter lays it out."""

SWITCH = """\
#if defined(GYRODRIFT_IMPLEMENTATION) && defined(GYRODRIFT_SHARED)
#error "define GYRODRIFT_IMPLEMENTATION in one file, and GYRODRIFT_SHARED in the others"
#endif
#if !defined(GYRODRIFT_IMPLEMENTATION) && !defined(GYRODRIFT_SHARED)
#define GD_API static inline
#elif defined(__cplusplus)
#define GD_API extern "C"
#else
#define GD_API extern
#endif
"""


WIDTH, INDENT = 110, "     "


def mark(part: str, text: str) -> str:
    """Comment before a part in the joined header, which says whether the part is internal."""
    return f"/* ---- {part}{'' if public_names(text) or part in FOR_USERS else ': internal'} ---- */\n"


def switched(text: str) -> str:
    """Text of the joined header in which each public function has its body only where the switches say so."""
    return FUNCTION.sub(_switched, text)


def public_names(text: str) -> list[str]:
    """Functions that users call, in the order of the header."""
    return [match["name"] for match in FUNCTION.finditer(text) if PUBLIC.fullmatch(match["name"])]


def contents(parts: Iterable[str], text: str) -> str:
    """Comment with the public functions, the parts in their order, and the switches."""
    return "\n".join(["/* Contents", "", *_contents(public_names(text), parts), "*/"])


def _contents(names: Iterable[str], parts: Iterable[str]) -> Iterator[str]:
    yield "   Functions for users:"
    yield from (f"     {name}" for name in names)
    yield "   with their records gd_..._params, the states gd_hdr, gd_restlevel, gd_attitude, and gd_calibration."
    yield ""
    yield "   internal: all other functions, and the members of states below a part that is marked so. They may"
    yield "   change in any release. The parts in their order:"
    yield from textwrap.wrap(", ".join(parts), WIDTH, initial_indent=INDENT, subsequent_indent=INDENT)
    yield ""
    yield "   Each file that includes this header has functions of its own. If several files of a program use it,"
    yield "   define GYRODRIFT_IMPLEMENTATION before the include in one of them, and GYRODRIFT_SHARED in the others."
    yield "   All need the same GD_REAL and sizes."


def _switched(match: re.Match[str]) -> str:
    if not PUBLIC.fullmatch(match["name"]):
        return match[0]
    head = f"GD_API {match['head']}"
    return f"{head};\n#ifndef GYRODRIFT_SHARED\n{head} {{{match['body']}}}\n#endif"
