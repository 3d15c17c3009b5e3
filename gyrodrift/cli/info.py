"""Describe recorded sessions: rate, gaps, clocks, temperature, rest, and the noise at rest.

One session is described in full; several become a table with a line for each and a summary. A ! marks values that
deserve a second look. Bias and noise come from the times at rest: by the encoder, or, without one, where the rate is
steady, which a constant spin is as well. Times are s after the first sample. --out and --picture also draw yaw, raw
and corrected by a filter; they need matplotlib.
"""

import argparse
import dataclasses
import json
import os
import shlex
from collections.abc import Iterator, Mapping, Sequence
from enum import Enum
from pathlib import Path
from typing import Any, NamedTuple

from gyrodrift.cli import inputs, options
from gyrodrift.cli.written import samples_text, tell_page, tell_written
from gyrodrift.config.model import Config, load_config
from gyrodrift.describe.listing import listing
from gyrodrift.describe.overview import row_of
from gyrodrift.describe.text import Group, groups_of, impossible_values, lines_of, possible_part
from gyrodrift.describe.yaw import YawHistory, yaw_history_of
from gyrodrift.evaluation.dataset import digest_of
from gyrodrift.facts.session_facts import SessionFacts
from gyrodrift.filters.run import FilterRun
from gyrodrift.io.files import check_inputs_kept, check_writable, whole_file, write_whole
from gyrodrift.io.installation import need_packages
from gyrodrift.io.json_numbers import finite
from gyrodrift.io.progress import Progress
from gyrodrift.report.provenance import Provenance, UsedFile, date_now, set_name
from gyrodrift.session.calibrated import with_config
from gyrodrift.session.checks.examine import examined
from gyrodrift.session.checks.finding import SessionFinding
from gyrodrift.session.checks.stated import session_as_stated
from gyrodrift.session.files import session_paths
from gyrodrift.session.mcap.raw import RawSize, raw_size
from gyrodrift.session.session import Session
from gyrodrift.values.errors import DataError, UsageError, visible
from gyrodrift.values.words import counted

PICTURES = (".png", ".svg", ".pdf")

EXAMPLES = """\
gyrodrift info session.mcap
gyrodrift info sessions
gyrodrift info sessions --out report
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
    parser.add_argument("--json", action="store_true", help="print one JSON object per session, each on one line")
    parser.add_argument("--verbose", action="store_true", help="print the full text of each of several sessions")
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help="folder for report.html, a page of all sessions (default: none)"
    )
    parser.add_argument(
        "--picture", type=Path, metavar="FILE", help="draw the session (.png, .svg or .pdf; default: none)"
    )
    parser.add_argument(
        "--config", type=Path, metavar="FILE", help="YAML with the filter that corrects yaw (default: restlevel)"
    )
    options.add_damage_option(parser)
    options.add_reading_options(parser)


def run(arguments: argparse.Namespace) -> int:
    """Describe the sessions; 0 if all are readable and none contradicts its units.

    Files are written before anything is printed: a reader such as `head` may end early.

    Raises
    ------
    DataError
        After the descriptions, with the sessions that are unreadable or contradict their units.
    """
    with options.progress_of(arguments) as progress:
        progress.report(options.PACKAGES, 0, 0)
        paths = session_paths(arguments.sessions)
        inputs.check_damage(paths, arguments)
        is_table = len(paths) > 1 and not (arguments.verbose or arguments.json)
        drawing = _drawing(arguments, paths, is_table=is_table)
        errors: list[str] = []
        descriptions = _descriptions(arguments, paths, drawing, progress, errors)
        texts = _table(paths, descriptions) if is_table else _texts(arguments, descriptions)
        if drawing is not None:
            texts = iter(list(texts))
            with progress.paused():
                drawing.write(paths)
        for text in texts:
            with progress.paused():
                print(text if arguments.json else visible(text))  # names of files and devices may hold anything
    if errors:
        raise DataError("\n".join(errors))
    return 0


Descriptions = Iterator[tuple["_Description", "YawHistory | None"]]


class _Description(NamedTuple):
    """A session with everything that is said of it; `possible` is without values that no sensor gives."""

    path: Path
    session: Session
    possible: Session
    facts: SessionFacts
    groups: Sequence[Group]
    raw: RawSize | None
    findings: Sequence[SessionFinding]

    def yaw(self, config: Config) -> YawHistory | None:
        """Yaw by the filter of a config."""
        session = with_config(self.possible, config.calibration)
        return yaw_history_of(session, FilterRun(config.chosen, config.params, config.axes, config.mount))


def _descriptions(
    arguments: argparse.Namespace,
    paths: Sequence[Path],
    drawing: "_Drawing | None",
    progress: Progress,
    errors: list[str],
) -> Descriptions:
    """The readable sessions, with yaw if they are drawn or have an encoder; `errors` gets the other ones."""
    config = _config(arguments)
    for index, path in enumerate(paths):
        progress.report("sessions", index, len(paths))
        try:
            description = _described(arguments, path)
        except DataError as error:
            errors.append(str(error))
            continue
        with progress.paused():
            inputs.print_remarks(path, description.session)
            inputs.print_gaps(path, description.possible)
        errors += [f"{path}: {finding}" for finding in description.findings if finding.is_error]
        yaw = None
        if drawing is not None or description.facts.encoder is not None:
            yaw = description.yaw(config)
        if drawing is not None:
            drawing.add(description, yaw)
        yield description, yaw


def _described(arguments: argparse.Namespace, path: Path) -> _Description:
    reading = inputs.reading(arguments)
    loaded = session_as_stated(path, reading, allow_damage=arguments.allow_damage)
    checked = examined(loaded, reading)
    session = checked.session
    raw = raw_size(path, allow_damage=session.damage is not None)
    possible = possible_part(session)
    facts = SessionFacts(possible)
    groups = groups_of(session, facts, raw, checked.findings)
    return _Description(path, session, possible, facts, groups, raw, checked.findings)


def _texts(arguments: argparse.Namespace, descriptions: Descriptions) -> Iterator[str]:
    """The full text of each session, or its JSON line."""
    for index, (described, _) in enumerate(descriptions):
        if arguments.json:
            yield json.dumps(_json(described), allow_nan=False, ensure_ascii=False)
        else:
            yield "\n".join([*[""] * (index > 0), str(described.path), *lines_of(described.groups)])


def _json(described: _Description) -> dict[str, object]:
    session, raw, axes = described.session, described.raw, described.facts.axes
    return {
        "session": str(described.path),
        **_plain(described.facts.published()),
        **({} if axes is None else {"axes": _plain(axes)}),
        "raw": None if raw is None else raw._asdict(),
        "metadata": _plain(session.metadata),
        "impossible": [_plain(value) for value in impossible_values(session)],
        "checks": [_plain(finding) for finding in described.findings],
    }


def _table(paths: Sequence[Path], descriptions: Descriptions) -> Iterator[str]:
    """A line per session, and a summary."""
    names = _names(paths)
    rows = [row_of(names[described.path], described.facts, yaw, described.groups) for described, yaw in descriptions]
    if rows:
        yield from listing(rows)


def _names(paths: Sequence[Path]) -> dict[Path, str]:
    """Paths without the folder that all of them share."""
    shared = os.path.commonpath([path.absolute().parent for path in paths])
    return {path: os.path.relpath(path.absolute(), shared).replace("\n", "\\n") for path in paths}


def _config(arguments: argparse.Namespace) -> Config:
    return load_config(arguments.config) if arguments.config else Config()


def _drawing(arguments: argparse.Namespace, sessions: Sequence[Path], *, is_table: bool) -> "_Drawing | None":
    """The files to be drawn, None for none; mistakes in the options show before any work."""
    if arguments.picture is None and arguments.out is None:
        if arguments.config is not None and not is_table:
            raise UsageError("--config is the filter of --out, --picture and the table of several sessions: add one")
        return None
    if arguments.picture is not None:
        _check_picture(arguments.picture, sessions)
    if arguments.out is not None:
        check_writable(arguments.out)
    return _Drawing(arguments)


def _check_picture(path: Path, sessions: Sequence[Path]) -> None:
    if path.suffix not in PICTURES:
        raise UsageError(f"--picture {path}: expected a name that ends in {', '.join(PICTURES)}")
    if len(sessions) > 1:
        raise UsageError(f"--picture shows one session, {len(sessions)} were given; --out DIR makes a page of all")
    check_inputs_kept([path], sessions)
    need_packages("--picture", "matplotlib")


class _Drawing:
    """The page and the picture of the sessions, whichever is asked for."""

    def __init__(self, arguments: argparse.Namespace) -> None:
        from gyrodrift.describe.report import SessionsPage

        self._arguments = arguments
        self._config = _config(arguments)
        self._page = None if arguments.out is None else SessionsPage()
        self._samples = 0
        self._count = 0

    def add(self, described: _Description, yaw: YawHistory | None) -> None:
        """Draw the next session."""
        from gyrodrift.describe.drawing import DescribedSession

        drawn = DescribedSession(described.possible, described.facts, yaw)
        self._count += 1
        self._samples += described.facts.samples
        if self._page is not None:
            self._page.add(drawn, described.groups)
        picture = self._arguments.picture
        if picture is not None:
            from gyrodrift.describe.picture import draw

            with whole_file(picture) as file:
                draw(drawn, file, picture.suffix.removeprefix("."))

    def write(self, paths: Sequence[Path]) -> None:
        """Write the page, and say which files are there now."""
        written = []
        if self._arguments.picture is not None and self._count:
            written.append(self._arguments.picture)
        if self._page is not None and self._count:
            page = self._arguments.out / "report.html"
            write_whole(page, [self._page.html(_provenance(self._arguments, self._config, paths))])
            written.append(page)
        contents = f"{counted(self._count, 'session')}, {samples_text(self._samples)}"
        for path in written:
            tell_written(path, contents, is_quiet=self._arguments.quiet)
        if self._page is not None and self._count:
            tell_page(written[-1], is_quiet=self._arguments.quiet)


def _provenance(arguments: argparse.Namespace, config: Config, paths: Sequence[Path]) -> Provenance:
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
    """A dataclass or a mapping as JSON, with null for numbers that are not finite."""
    named = value if isinstance(value, Mapping) else {f.name: getattr(value, f.name) for f in dataclasses.fields(value)}
    return {str(name): _plain_value(item) for name, item in named.items()}


def _plain_value(value: object) -> object:
    match value:
        case float():
            return finite(value)
        case None | int() | str():
            return value
        case Enum():
            return value.value
        case tuple() | list():
            return [_plain_value(item) for item in value]
        case _ if hasattr(value, "tolist"):
            return _plain_value(value.tolist())
        case _:
            return _plain(value)
