"""Tell what recorded sessions hold: rate, gaps, clocks, temperature, rest and the noise there.

What is worth a second look has a ! in front. Bias and noise are those of the stretches in which the device stood still:
by the encoder, or, without one, where the rate is steady, which a constant spin is as well. Times of stretches are s
after the first sample. --picture needs matplotlib; where it is missing, the command that installs it is told.
"""

import argparse
import dataclasses
import json
from collections.abc import Mapping
from enum import Enum
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gyrodrift.errors import UsageError

if TYPE_CHECKING:
    from gyrodrift.describe.values import SessionDescription
    from gyrodrift.session.session import Session

PICTURES = (".png", ".svg", ".pdf")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "sessions",
        type=Path,
        nargs="+",
        metavar="SESSION",
        help="recorded session (.mcap or .csv), or a folder of them",
    )
    parser.add_argument("--json", action="store_true", help="a JSON object a session instead, on one line")
    parser.add_argument("--picture", type=Path, metavar="FILE", help="draw the session (.png, .svg or .pdf)")


def run(arguments: argparse.Namespace) -> int:
    """Describe each session; 0 when all are told."""
    from gyrodrift.describe.describe import describe
    from gyrodrift.describe.text import text_of
    from gyrodrift.session.files import load_session, session_paths

    paths = session_paths(arguments.sessions)
    if arguments.picture is not None:
        _check_picture(arguments.picture, paths)
    for number, path in enumerate(paths):
        session = load_session(path)
        description = describe(session)
        if arguments.json:
            about = {"session": str(path), **_plain(description), "metadata": _plain(session.metadata)}
            print(json.dumps(about, allow_nan=False, ensure_ascii=False))
        else:
            print(*[""] * (number > 0), path, *text_of(session, description), sep="\n")
        if arguments.picture is not None:
            _draw(session, description, arguments.picture)
    return 0


def _check_picture(path: Path, sessions: list[Path]) -> None:
    from gyrodrift.files import check_inputs_kept

    if path.suffix not in PICTURES:
        raise UsageError(f"--picture {path}: expected a name that ends in {', '.join(PICTURES)}")
    if len(sessions) > 1:
        raise UsageError(f"--picture shows one session, {len(sessions)} were given")
    check_inputs_kept([path], sessions)
    try:
        import matplotlib as mpl  # noqa: F401 - asked for before the session is read
    except ImportError as error:
        from gyrodrift.installation import extra_command

        raise UsageError(f"--picture needs the package matplotlib: {extra_command('lab')}") from error


def _draw(session: "Session", description: "SessionDescription", path: Path) -> None:
    from gyrodrift.describe.picture import draw
    from gyrodrift.files import whole_file

    with whole_file(path) as file:
        draw(session, description, file, path.suffix.removeprefix("."))


def _plain(value: Any) -> dict[str, object]:
    """A dataclass or a mapping as JSON has it: null for what is no finite number."""
    named = value if isinstance(value, Mapping) else {f.name: getattr(value, f.name) for f in dataclasses.fields(value)}
    return {str(name): _plain_value(one) for name, one in named.items()}


def _plain_value(value: object) -> object:
    match value:
        case float():
            return value if isfinite(value) else None
        case None | int() | str():
            return value
        case Enum():
            return value.value
        case tuple() | list():
            return [_plain_value(one) for one in value]
        case _ if hasattr(value, "tolist"):
            return _plain_value(value.tolist())
        case _:
            return _plain(value)
