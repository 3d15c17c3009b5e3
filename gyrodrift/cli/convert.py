"""Convert a recorded session to .mcap, .csv, .json, .jsonl or .parquet, by the ending of OUT; every digit is kept.

An .mcap IN may hold samples of this program, sensor_msgs/msg/Imu (rad/s become deg/s) or JSON objects with t_device_s
and rate_dps. It may be chunked, compressed or cut off. A line on stderr names everything that OUT cannot hold: raw
bytes, link events and other channels; in .csv also metadata; with --as imu also encoder angle, temperature, counter and
the device's own yaw.
"""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

from gyrodrift.cli import inputs, options
from gyrodrift.cli.written import samples_text, tell_written
from gyrodrift.facts.session_facts import SessionFacts
from gyrodrift.io.files import check_kept
from gyrodrift.io.progress import OnProgress, counted
from gyrodrift.session.checks.examine import reading_findings
from gyrodrift.session.checks.restarts import one_clock
from gyrodrift.session.files import write_session
from gyrodrift.session.foreign.export import write_imu, write_json
from gyrodrift.session.foreign.read import read_foreign
from gyrodrift.session.foreign.reference import with_reference
from gyrodrift.session.left_out import left_out
from gyrodrift.session.logs.bag import read_bag
from gyrodrift.session.session import Session
from gyrodrift.session.tables.write import PIECE, session_table, write_rows, written_ending
from gyrodrift.values.errors import UsageError, visible
from gyrodrift.values.words import listed

BAGS = (".bag", ".db3")
FORMS = ("sample", "imu", "json")

EXAMPLES = """\
gyrodrift convert session.mcap session.csv
gyrodrift convert session.csv session.mcap
gyrodrift convert session.mcap for-ros.mcap --as imu
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("source", type=Path, metavar="IN", help="recorded session (.mcap) or table (.csv and others)")
    parser.add_argument(
        "target", type=Path, metavar="OUT", help="file to write (.mcap, .csv, .json, .jsonl or .parquet)"
    )
    parser.add_argument(
        "--topic",
        metavar="NAME",
        help="channel of an .mcap IN, or topic of a bag, with the samples (default: /gyro, or the only suitable one)",
    )
    parser.add_argument(
        "--as",
        dest="form",
        choices=FORMS,
        help="message type of an .mcap OUT: sample (default; the own type), imu (sensor_msgs/msg/Imu, rad/s), json",
    )
    options.add_force_option(parser)
    options.add_damage_option(parser)
    options.add_reading_options(parser)


def run(arguments: argparse.Namespace) -> int:
    """Convert; 0 when OUT is written."""
    source, target, topic, form = arguments.source, arguments.target, arguments.topic, arguments.form
    if form is not None and target.suffix != ".mcap":
        raise UsageError(f"--as {form}: needs an .mcap file as OUT, {target} is none")
    if topic is not None and source.suffix not in (".mcap", *BAGS) and not source.is_dir():
        raise UsageError(f"--topic {topic}: needs an .mcap file or a bag as IN, {source} is none")

    check_kept([target], [source], force=arguments.force)
    written_ending(target, "OUT")
    with options.progress_of(arguments) as progress:
        progress.report(f"{source.name} read", 0, 0)
        session = _loaded(source, topic, arguments)
        _tell_left_out(arguments, session)
        for finding in reading_findings(SessionFacts(session).readings):
            inputs.print_warning(f"{source}: {finding}; {target} keeps them")
        inputs.print_gaps(source, one_clock(session).session)
        _write(target, form, session, in_pieces(session, progress.report))
    tell_written(target, samples_text(len(session.t_device_s)), is_quiet=arguments.quiet)
    return 0


def in_pieces(session: Session, progress: OnProgress) -> Iterator[Session]:
    """The session in consecutive pieces, each counted in the progress."""
    samples = len(session.t_device_s)
    pieces = (session.part(first, first + PIECE) for first in range(0, samples, PIECE))
    return counted("samples written", pieces, samples, progress, lambda piece: len(piece.t_device_s))


def _loaded(source: Path, topic: str | None, arguments: argparse.Namespace) -> Session:
    if topic is None:
        return inputs.read_session(source, inputs.reading(arguments), allow_damage=arguments.allow_damage)
    reading = inputs.reading(arguments)
    session = _of_topic(source, topic)
    if reading.reference:
        session = with_reference(session, source, reading.reference)
    return reading.applied(session)


def _of_topic(source: Path, topic: str) -> Session:
    if source.suffix in BAGS or source.is_dir():
        return read_bag(source, topic)

    return read_foreign(source, topic)


def _tell_left_out(arguments: argparse.Namespace, session: Session) -> None:
    """Name everything that OUT will not hold."""
    form = arguments.form or "sample" if arguments.target.suffix.lower() == ".mcap" else "csv"
    holds_aids = arguments.target.suffix.lower() in (".csv", ".mcap")
    without = left_out(arguments.source, session, arguments.topic, form, holds_aids=holds_aids)
    notes = ["rate in rad/s (sensor_msgs/msg/Imu)"] if form == "imu" else []
    notes += [f"left out: {listed(without)}"] if without else []
    if notes:
        print(visible(f"gyrodrift: {arguments.target}: {'; '.join(notes)}"), file=sys.stderr)


def _write(target: Path, form: str | None, session: Session, pieces: Iterator[Session]) -> None:
    if form == "imu":
        write_imu(target, pieces)
    elif form == "json":
        write_json(target, pieces)
    elif written_ending(target, "OUT") not in (".csv", ".mcap"):
        write_rows(target, *session_table(pieces))
    else:
        metadata = {name: dict(table) for name, table in session.metadata.items()}
        write_session(target, pieces, metadata)
