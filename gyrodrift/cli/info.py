"""Tell what recorded sessions hold: rate, gaps, clocks, temperature, rest and the noise there.

What is worth a second look has a ! in front. Bias and noise are those of the stretches in which the device stood still:
by the encoder, or, without one, where the rate is steady, which a constant spin is as well. Times of stretches are s
after the first sample. --out and --picture draw yaw too, raw and corrected by a filter, and need matplotlib; where it
is missing, the command that installs it is told.
"""

import argparse
import dataclasses
import json
import shlex
from collections.abc import Mapping, Sequence
from enum import Enum
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gyrodrift.cli import options
from gyrodrift.errors import DataError, UsageError, visible
from gyrodrift.files import check_writable, whole_file, write_whole

if TYPE_CHECKING:
    from gyrodrift.config.model import Config
    from gyrodrift.describe.text import Group
    from gyrodrift.describe.values import SessionDescription
    from gyrodrift.html.provenance import Provenance
    from gyrodrift.progress import Progress
    from gyrodrift.session.session import Session

PICTURES = (".png", ".svg", ".pdf")

EXAMPLES = """\
gyrodrift info sessions
gyrodrift info sessions --out report
gyrodrift info sessions --json
"""


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
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help="folder for report.html, a page of all sessions (default: none)"
    )
    parser.add_argument(
        "--picture", type=Path, metavar="FILE", help="draw the session (.png, .svg or .pdf; default: none)"
    )
    parser.add_argument(
        "--config", type=Path, metavar="FILE", help="YAML with the filter that corrects (default: restlevel)"
    )
    options.add_damage_option(parser)
    options.add_columns_option(parser)
    options.add_unit_options(parser)


def run(arguments: argparse.Namespace) -> int:
    """Describe each session; 0 when all are told, and nothing in them contradicts what they are taken for.

    Raises
    ------
    DataError
        When all are told, with what does.
    """
    with options.progress_of(arguments) as progress:
        progress.evaluated(options.PACKAGES, 0, 0)
        from gyrodrift.session.files import session_paths

        paths = session_paths(arguments.sessions)
        options.check_damage(paths, allow_damage=arguments.allow_damage)
        drawing = _drawing(arguments, paths)
        wrong: list[str] = []
        for number, path in enumerate(paths):
            progress.evaluated("sessions", number, len(paths))
            wrong += _tell(arguments, path, drawing, progress, is_first=number == 0)
        if drawing is not None and drawing.page is not None:
            page = drawing.page.html(_provenance(arguments, drawing.config, paths))
            write_whole(arguments.out / "report.html", [page])
    if wrong:
        raise DataError("\n".join(wrong))
    return 0


def _tell(
    arguments: argparse.Namespace, path: Path, drawing: "_Drawing | None", progress: "Progress", *, is_first: bool
) -> list[str]:
    """Tell of one session; gives what contradicts what it is taken for."""
    from gyrodrift.describe.describe import describe
    from gyrodrift.describe.possible import impossible_values, possible_part
    from gyrodrift.describe.text import groups_of, lines_of
    from gyrodrift.session.checks.examine import examined
    from gyrodrift.session.files import load_session
    from gyrodrift.session.mcap.raw import raw_size

    reading = options.reading(arguments)
    whole = load_session(path, reading.columns, allow_damage=arguments.allow_damage)
    checked = examined(reading.applied(whole), reading)
    session = checked.session
    raw = raw_size(path, allow_damage=session.damage is not None)
    possible = possible_part(session)
    description = describe(possible)
    groups = groups_of(session, description, raw, checked.findings)
    with progress.aside():
        options.tell_remarks(path, session)
        if arguments.json:
            kept = None if raw is None else raw._asdict()
            about = {"session": str(path), **_plain(description), "raw": kept, "metadata": _plain(session.metadata)}
            about["impossible"] = [_plain(value) for value in impossible_values(session)]
            about["checks"] = [_plain(finding) for finding in checked.findings]
            print(json.dumps(about, allow_nan=False, ensure_ascii=False))
        else:
            lines = [*[""] * (not is_first), str(path), *lines_of(groups)]
            print(*map(visible, lines), sep="\n")  # names of files, notes and devices may hold anything
    if drawing is not None:
        drawing.take(possible, description, groups)
    return [f"{path}: {finding}" for finding in checked.findings if finding.is_error]


def _drawing(arguments: argparse.Namespace, sessions: list[Path]) -> "_Drawing | None":
    """What draws the sessions; None where nothing is to be drawn. All that could be wrong is found beforehand."""
    if arguments.picture is None and arguments.out is None:
        if arguments.config is not None:
            raise UsageError("--config is the filter that --out and --picture draw; give one of them")
        return None
    if arguments.picture is not None:
        _check_picture(arguments.picture, sessions)
    from gyrodrift.installation import need_packages

    need_packages("--out" if arguments.picture is None else "--picture", "matplotlib")
    if arguments.out is not None:
        check_writable(arguments.out)
    return _Drawing(arguments)


def _check_picture(path: Path, sessions: list[Path]) -> None:
    from gyrodrift.files import check_inputs_kept

    if path.suffix not in PICTURES:
        raise UsageError(f"--picture {path}: expected a name that ends in {', '.join(PICTURES)}")
    if len(sessions) > 1:
        raise UsageError(f"--picture shows one session, {len(sessions)} were given; --out DIR makes a page of all")
    check_inputs_kept([path], sessions)


class _Drawing:
    """Sessions as a picture and as a page, as far as they are asked for."""

    def __init__(self, arguments: argparse.Namespace) -> None:
        from gyrodrift.config.model import Config, load_config
        from gyrodrift.describe.report import SessionsPage

        self.config = load_config(arguments.config) if arguments.config else Config()
        self.page = None if arguments.out is None else SessionsPage()
        self._picture = arguments.picture

    def take(self, session: "Session", description: "SessionDescription", groups: "Sequence[Group]") -> None:
        """The next session."""
        from gyrodrift.describe.panels import Seen
        from gyrodrift.describe.picture import draw
        from gyrodrift.describe.yaw import yaw_history_of
        from gyrodrift.session.calibrated import with_config

        right = with_config(session, self.config.calibration)
        seen = Seen(session, description, yaw_history_of(right, self.config.chosen, self.config.params))
        if self.page is not None:
            self.page.add(seen, groups)
        if self._picture is not None:
            with whole_file(self._picture) as file:
                draw(seen, file, self._picture.suffix.removeprefix("."))


def _provenance(arguments: argparse.Namespace, config: "Config", paths: "Sequence[Path]") -> "Provenance":
    """What the page says of where it comes from."""
    from gyrodrift.evaluation.dataset import digest_of
    from gyrodrift.html.provenance import Provenance, UsedFile, date_now, set_name

    given = arguments.config
    return Provenance(
        set_name=set_name(arguments.sessions),
        command=shlex.join(arguments.command_line),
        date=date_now(),
        sessions=[UsedFile(str(path), digest_of(path)) for path in paths],
        config=f"{config.filter} of {given}" if given else f"{config.filter} at its defaults",
        config_text=config.text,
    )


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
