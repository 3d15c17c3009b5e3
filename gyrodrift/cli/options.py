"""Options that several commands share, and checks of their values."""

import argparse
import sys
from collections.abc import Callable, Mapping
from inspect import signature
from pathlib import Path
from typing import Any, TypeVar

from gyrodrift.cli import numbers
from gyrodrift.cli.parser import Choices, Parser, unknown
from gyrodrift.columns.spec import (
    ACCELERATION,
    ACCELERATION_MPS2,
    CLOCK,
    CLOCK_UNITS_US,
    RATE,
    RATE_DPS,
    Quantity,
    scale_of,
)
from gyrodrift.filters.registry import DEFAULT, FILTERS
from gyrodrift.filters.run import AXES
from gyrodrift.io.progress import Progress
from gyrodrift.io.system import processor_count

Record = TypeVar("Record")

AUTO_PORT = "auto"
PACKAGES = "packages"
"""First phase of a progress line: the import of packages."""

COLUMNS_HELP = """\
Which column of a text or a table is what. serve, record, doctor and all commands that read files take these options.

SPEC is a comma list, one entry for each column from the left:

  _                                          ignored
  t_s, t_ms, t_us, t_ns, t:lsb/N             clock; lsb/N: N ticks in a second
  dt_ms, +t_ns                               time since the last line; added to a clock of another column
  seq                                        number of the sample
  rate[:dps|:mdps|:rads|:mrads|:lsb/N][:-]   yaw rate; :- turns the sign
  gx, gy, gz, ax, ay, az                     three axes: rates as rate, accelerations [:mps2|:g|:mg|:lsb/N]
  delta[:deg|:rad][:-]                       angle since the last line
  yaw[:deg|:rad][:-], q.w, q.x, q.y, q.z     angle of the device's own filter, or quaternion
  encoder[:deg|:rad|:counts/N], temp         reference angle, temperature in °C

With labels, LABEL=rate:rads instead; LABEL=VALUE takes the lines with this value only.
"""

COLUMNS_EXAMPLES = """\
examples:
  gyrodrift serve --port auto --columns 't_ms, _, _, rate:lsb/131'
  gyrodrift info drive.csv --columns 'time=t_s, gyro_z=rate:rads' --flip
  gyrodrift convert log.txt log.mcap --columns rate:dps --sample-rate 100

gyrodrift doctor --port PORT --turn finds them by a quarter turn.
"""

ITERATIONS = 3000
"""Default number of evaluations of a search, the same in all commands that tune."""


def add_link_options(
    parser: argparse.ArgumentParser, default_port: str | None = None, *, needs_port: bool = True
) -> None:
    """Options of commands that read a device; --port is required without a default, unless the config may have it."""
    from gyrodrift.link.protocols.registry import AUTO, PROTOCOLS

    parser.add_argument(
        "--port",
        required=default_port is None and needs_port,
        default=default_port,
        help="serial port of the device, such as /dev/ttyUSB0, or auto for the only gyro that is plugged in; or a "
        "source, such as tcp://HOST:PORT or udp://:PORT",
    )
    parser.add_argument(
        "--baud",
        default="auto",
        help="line rate in baud, or auto to find it (default); a given rate is not changed",
    )
    protocols = ", ".join(f"{protocol.name} ({protocol.help})" for protocol in PROTOCOLS.own.values())
    parser.add_argument(
        "--protocol",
        default=AUTO,
        choices=Choices(PROTOCOLS, AUTO),
        metavar="NAME",
        help=f"auto to find it (default), {protocols}",
    )
    parser.add_argument(
        "--columns",
        metavar="SPEC",
        help="read lines of text with these columns, such as 't_ms, _, _, rate:lsb/131'; gyrodrift help columns "
        "explains them (default: none)",
    )
    parser.add_argument(
        "--timeout",
        type=numbers.number(numbers.MOST_SECONDS, "seconds, 0 or more", least=0.0),
        default=10.0,
        metavar="S",
        help="end if nothing was decoded within S seconds of the start; 0 waits for ever (default 10)",
    )
    add_send_option(parser)


def add_send_option(parser: argparse.ArgumentParser) -> None:
    """Option of commands that open a port."""
    parser.add_argument(
        "--send",
        type=bytes_to_send,
        metavar="TEXT",
        help=r"send TEXT to the device after the port was opened, and again after a silence, until samples come; for "
        r"boards that wait for a key or a command, such as '\r\n' or 'start\r\n'; escapes as in Python (default: none)",
    )


def bytes_to_send(text: str) -> bytes:
    """Bytes of an argument of `--send`."""
    from gyrodrift.link.opening import bytes_to_send

    try:
        return bytes_to_send(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def load_effects() -> None:
    """Make the effects of plug-ins known to rig files and to the options of a command; name those that are broken."""
    from gyrodrift.cli.plug_ins import tell_problems
    from gyrodrift.simulation.effects import load

    load()
    tell_problems("gyrodrift.effects")


def load_encoders() -> None:
    """Make the encoders of plug-ins known to `--protocol` of a simulated device; name those that are broken."""
    from gyrodrift.cli.plug_ins import tell_problems
    from gyrodrift.simulation.effects import load_encoders as load

    load()
    tell_problems("gyrodrift.encoders")


def add_reading_options(parser: argparse.ArgumentParser) -> None:
    """Options of commands that read tables and other sessions."""
    parser.add_argument(
        "--columns",
        metavar="SPEC",
        help="columns of a table (.csv .tsv .txt .log .json .jsonl); gyrodrift help columns explains them and the "
        "options for units (default: from the header)",
    )
    add_unit_options(parser)


def columns_parser() -> Parser:
    """Parser whose help explains the columns of lines and tables, and the options for their units."""
    parser = Parser("COMMAND", description=COLUMNS_HELP, add_help=False, epilog=COLUMNS_EXAMPLES)
    parser.add_argument(
        "--columns",
        metavar="SPEC",
        help="columns of the lines at a port, or of a table, as above (default: from labels)",
    )
    add_unit_options(parser)
    return parser


def add_unit_options(parser: argparse.ArgumentParser) -> None:
    """Options of commands that read sessions, for headers with a wrong unit or sign, and for bags with a reference."""
    parser.add_argument(
        "--rate-unit",
        type=rate_unit,
        metavar="UNIT",
        help="unit of the rates, instead of the header: dps, mdps, rads, mrads or lsb/N (default: from the header)",
    )
    parser.add_argument(
        "--time-unit",
        type=time_unit,
        metavar="UNIT",
        help="unit of the device times, instead of the header: s, ms, us, ns, min, days, lsb/N for N ticks per second, "
        "hms for HHMMSS.ss, or s.ms, s.us, s.ns for a fraction without leading zeros (default: from the header)",
    )
    parser.add_argument(
        "--sample-rate",
        dest="sample_rate_hz",
        type=numbers.number(1e6, "a rate in Hz above 0"),
        default=0.0,
        metavar="HZ",
        help="time of the samples by their rate, in place of a clock; with the column seq, lost samples take their "
        "time (default: by the clock)",
    )
    parser.add_argument(
        "--accel-unit",
        type=accel_unit,
        metavar="UNIT",
        help="unit of the accelerations, instead of the header: mps2, g, mg or lsb/N (default: from the header)",
    )
    parser.add_argument(
        "--flip",
        action="store_true",
        help="change the sign of the rates; with three axes of y and z, for a sensor that is upside down",
    )
    parser.add_argument(
        "--reference",
        metavar="TOPIC",
        help="topic of a ROS bag or .mcap with the reference angle: Odometry, PoseStamped, TransformStamped, or "
        "JointState as TOPIC:JOINT (default: none)",
    )


def accel_unit(text: str) -> str:
    """Check an argument of `--accel-unit`."""
    return _unit(ACCELERATION, text, f"{', '.join(ACCELERATION_MPS2)} or lsb/N, N counts for 1 g")


def rate_unit(text: str) -> str:
    """Check an argument of `--rate-unit`."""
    return _unit(RATE, text, f"{', '.join(RATE_DPS)} or lsb/N, N counts for one deg/s")


def time_unit(text: str) -> str:
    """Check an argument of `--time-unit`."""
    return _unit(CLOCK, text, f"{', '.join(CLOCK_UNITS_US)} or lsb/N, N ticks for one second")


def _unit(quantity: Quantity, text: str, expected: str) -> str:
    if scale_of(quantity, text) is None:
        raise argparse.ArgumentTypeError(f"expected {expected}")
    return text


def add_log_options(parser: argparse.ArgumentParser) -> None:
    """Options of commands that log."""
    parser.add_argument(
        "--log-level",
        choices=("debug", "info", "warning", "error"),
        help="minimum log level (default: info, with --quiet warning)",
    )
    parser.add_argument(
        "--log-format",
        default="auto",
        choices=("auto", "text", "json"),
        help="text is key=value; auto is text, and easier to read on a terminal (default auto)",
    )


def log_level(arguments: argparse.Namespace) -> str:
    """Minimum log level."""
    level: str = arguments.log_level or ("warning" if arguments.quiet else "info")
    return level


def add_still_option(parser: argparse.ArgumentParser) -> None:
    """Declare --still."""
    parser.add_argument(
        "--still",
        dest="stills",
        type=Path,
        action="append",
        default=[],
        metavar="PATH",
        help="session in which the device did not move (repeatable; default: none)",
    )


def add_duration_option(parser: argparse.ArgumentParser, default: float | None, about: str, *, older: str = "") -> None:
    """Option of commands that end after a time; `older`, `seconds` or `minutes`, is an option for the same number."""
    group = parser.add_mutually_exclusive_group() if older else parser
    read = numbers.minutes if older == "minutes" else numbers.duration
    group.add_argument("--duration", dest=older or "duration", type=read, default=default, metavar="TIME", help=about)
    if older:
        plain = numbers.number(1e6) if older == "minutes" else numbers.duration
        letter, same = older[0].upper(), f"the same in {older} (default: --duration)"
        group.add_argument(f"--{older}", type=plain, default=default, metavar=letter, help=same)


def add_jobs_option(parser: argparse.ArgumentParser) -> None:
    """Option of commands that use several processors."""
    parser.add_argument(
        "--jobs",
        type=numbers.whole(numbers.MOST_JOBS),
        metavar="N",
        help="processes at once (default: number of processors)",
    )


def add_iterations_option(parser: argparse.ArgumentParser, of_what: str) -> None:
    """Option of commands that search."""
    parser.add_argument("--iterations", type=numbers.whole(10**9), default=ITERATIONS, metavar="N", help=of_what)


def add_cluster_option(parser: argparse.ArgumentParser, work: str) -> None:
    """Option of commands that can use a cluster."""
    parser.add_argument(
        "--cluster", metavar="ADDRESS", help=f"{work} on a Dask cluster, such as tcp://host:8786 (default: here)"
    )


def add_recording_options(parser: argparse.ArgumentParser) -> None:
    """Options of commands that record."""
    parser.add_argument(
        "--profile", default="", metavar="NAME", help="name of the motion, for the file name (default: none)"
    )
    parser.add_argument("--note", default="", metavar="TEXT", help="note for the metadata of the file (default: none)")
    parser.add_argument(
        "--rotate",
        metavar="SIZE|TIME",
        help="begin a new file at a size (100MB, 2GB) or after a time (90s, 30min, 1h; default: one file)",
    )
    parser.add_argument("--raw", action="store_true", help="also keep the bytes of the link, each read with its time")


def add_force_option(parser: argparse.ArgumentParser) -> None:
    """Option of commands that could overwrite a session."""
    parser.add_argument("--force", action="store_true", help="replace existing sessions")


def add_damage_option(parser: argparse.ArgumentParser) -> None:
    """Option of commands that read sessions."""
    parser.add_argument(
        "--allow-damage",
        action="store_true",
        help="continue with the undamaged part of a damaged recording (default: end with status 4)",
    )


def profile(text: str) -> str:
    """Check an argument of `--profile`, the name of a shipped motion or a file.

    Raises
    ------
    UsageError
        If it looks like a name and there is no such profile.
    """
    from firmware_sim.motion.profile import shipped_profiles

    is_path = Path(text).suffix or Path(text).name != text or Path(text).is_file()
    if text not in shipped_profiles() and not is_path:
        raise unknown("profile or file", f"--profile {text}", shipped_profiles())
    return text


def progress_of(arguments: argparse.Namespace, shares: Mapping[str, float] | None = None) -> Progress:
    """Progress on stderr, shown on a terminal."""
    return Progress(sys.stderr, shares, is_quiet=arguments.quiet)


def add_filter_options(parser: argparse.ArgumentParser, config_help: str) -> None:
    """Options of commands that run a filter sample by sample."""
    group = parser.add_mutually_exclusive_group()
    group.add_argument("--config", type=Path, metavar="FILE", help=f"{config_help} (default: none)")
    group.add_argument(
        "--filter",
        choices=Choices(FILTERS),
        metavar=f"{{{','.join(FILTERS.own)}}}",
        help=f"run this filter at its defaults, without a file (default: {DEFAULT.name})",
    )
    parser.add_argument(
        "--axes",
        choices=AXES,
        help="axes of the gyro that the filter uses: 1 takes z as the yaw rate, 3 accounts for the tilt, auto takes 3 "
        "where the device sends three rates and accelerations (default: auto, or axes: of the config)",
    )


def record_of(record: Callable[..., Record], arguments: argparse.Namespace, **changes: Any) -> Record:
    """Record of the options that have the names of its fields, and of changes to them."""
    given = vars(arguments)
    return record(**{name: given[name] for name in signature(record).parameters if name in given} | changes)


def processes(jobs: int | None) -> int:
    """Number of processes of `--jobs`; by default the number of processors."""
    return jobs or processor_count()
