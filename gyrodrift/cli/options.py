"""Options that several commands share, and how their values are read."""

import argparse
import os
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from gyrodrift.cli import numbers
from gyrodrift.cli.parser import unknown
from gyrodrift.errors import UsageError, visible
from gyrodrift.filters.registry import DEFAULT, FILTERS
from gyrodrift.system import processor_count

if TYPE_CHECKING:
    from firmware_sim.effects.effect import Effect
    from gyrodrift.config.model import Config
    from gyrodrift.link.link import EventHandler, LinkOptions
    from gyrodrift.link.port import Port
    from gyrodrift.progress import Progress
    from gyrodrift.session.checks.stated import ReadingOptions
    from gyrodrift.session.session import Session

AUTO_PORT = "auto"
PACKAGES = "packages"
"""The first thing that is waited for."""

ITERATIONS = 3000
"""Evaluations of a search where nothing is said: the same budget wherever methods are tuned."""


def add_link_options(parser: argparse.ArgumentParser, default_port: str | None = None) -> None:
    """The options of every command that reads a device; the port has to be given where it has no default."""
    from gyrodrift.link.protocols.registry import AUTO, PROTOCOLS

    parser.add_argument(
        "--port",
        required=default_port is None,
        default=default_port,
        help="serial port of the device, such as /dev/ttyUSB0, or auto for the one gyro that is plugged in",
    )
    parser.add_argument(
        "--baud",
        default="auto",
        help="line rate in baud, or auto to find it (default); a rate that is given is kept to",
    )
    protocols = ", ".join(f"{protocol.name} ({protocol.help})" for protocol in PROTOCOLS.values())
    parser.add_argument(
        "--protocol",
        default=AUTO,
        choices=(AUTO, *PROTOCOLS),
        metavar="NAME",
        help=f"auto to find it (default), {protocols}",
    )
    parser.add_argument(
        "--columns",
        metavar="SPEC",
        help="read lines of text with these columns, one entry each: _ (ignored), t_us, t_ms, t_s, seq, "
        "rate[:dps|:mdps|:rads|:mrads|:lsb/N][:-], encoder[:deg|:counts/N], temp, such as "
        "'t_ms, _, _, rate:lsb/131'; of labelled values and JSON, LABEL=rate (default: none)",
    )
    parser.add_argument(
        "--timeout",
        type=numbers.number(numbers.MOST_SECONDS, "seconds, 0 or more", least=0.0),
        default=10.0,
        metavar="S",
        help="give up where nothing decodable came within S seconds of the start; 0 waits for ever (default 10)",
    )
    add_send_option(parser)


def add_send_option(parser: argparse.ArgumentParser) -> None:
    """The option of every command that opens a port."""
    parser.add_argument(
        "--send",
        type=bytes_to_send,
        metavar="TEXT",
        help=r"send TEXT after the port was opened, and again after a silence, until samples come: to a board that "
        r"waits for a key or a command, such as '\r\n' or 'start\r\n'; escapes as in Python (default: nothing)",
    )


def bytes_to_send(text: str) -> bytes:
    """Of `--send`."""
    from gyrodrift.link.opening import bytes_to_send

    try:
        return bytes_to_send(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def add_columns_option(parser: argparse.ArgumentParser) -> None:
    """The option of every command that reads tables."""
    parser.add_argument(
        "--columns",
        metavar="SPEC",
        help="columns of a table (.csv .tsv .txt .log .json .jsonl), one entry each: _ (ignored), t_s, t_ms, t_us, "
        "t_ns, rate[:dps|:mdps|:rads|:mrads|:lsb/N][:-], yaw[:deg|:rad][:-], encoder, temp, seq, such as "
        "'t_ms, _, _, rate:rads'; by label, LABEL=rate:rads (default: as its header says)",
    )


def add_unit_options(parser: argparse.ArgumentParser) -> None:
    """The options of every command that reads sessions whose header may say another unit than their numbers have."""
    parser.add_argument(
        "--rate-unit",
        type=rate_unit,
        metavar="UNIT",
        help="unit of the rates whatever the header says: dps, mdps, rads, mrads or lsb/N (default: as it says)",
    )
    parser.add_argument(
        "--time-unit",
        choices=("s", "ms", "us", "ns"),
        help="unit of the device's times whatever the header says (default: as it says)",
    )
    parser.add_argument("--flip", action="store_true", help="take the rates with the other sign")


def rate_unit(text: str) -> str:
    """Of `--rate-unit`."""
    from gyrodrift.columns.spec import RATE, RATE_DPS, scale_of

    if scale_of(RATE, text) is None:
        raise argparse.ArgumentTypeError(f"expected {', '.join(RATE_DPS)} or lsb/N, N counts for one deg/s")
    return text


def reading(arguments: argparse.Namespace) -> "ReadingOptions":
    """What the options say of how sessions are to be read."""
    from gyrodrift.columns.spec import columns_of
    from gyrodrift.session.checks.stated import ReadingOptions

    columns = None if arguments.columns is None else columns_of(arguments.columns)
    return ReadingOptions(columns, arguments.rate_unit or "", arguments.time_unit or "", arguments.flip)


def tell_remarks(path: Path, session: "Session") -> None:
    """What a person is to be told of how a session was read."""
    if session.remarks:
        print(visible(f"gyrodrift: {path}: {'; '.join(session.remarks)}"), file=sys.stderr)


def reads_columns_of_config(arguments: argparse.Namespace) -> bool:
    """Whether it is left to the config how lines of text are read."""
    return arguments.columns is None and arguments.protocol in ("auto", "text")


def link_target(
    arguments: argparse.Namespace,
    baud: int | None,
    on_event: "EventHandler",
    columns: str | None = None,
    send: bytes = b"",
) -> "tuple[LinkOptions, Port | None]":
    """What the options of a command say of its link; with `--port auto` that of the one gyro, its port open already.

    `columns` are those of the config, which count where the options name neither others nor another protocol, and so is
    `send` where the options send nothing.
    """
    from gyrodrift.link.link import LinkOptions

    named = columns if reads_columns_of_config(arguments) else arguments.columns
    asked = LinkOptions(arguments.port, baud, arguments.protocol, arguments.timeout, named, arguments.send or send)
    if asked.port != AUTO_PORT:
        return asked, None
    from gyrodrift.link.port import serial_ports
    from gyrodrift.link.search import find_gyro

    return find_gyro(serial_ports(), asked, on_event)


def add_log_options(parser: argparse.ArgumentParser) -> None:
    """The options of every command that logs."""
    parser.add_argument(
        "--log-level",
        choices=("debug", "info", "warning", "error"),
        help="the least that is logged (default: info, with --quiet warning)",
    )
    parser.add_argument(
        "--log-format",
        default="auto",
        choices=("auto", "text", "json"),
        help="text: key=value; auto: that, but for people on a terminal (default auto)",
    )


def log_level(arguments: argparse.Namespace) -> str:
    """The least that is logged."""
    level: str = arguments.log_level or ("warning" if arguments.quiet else "info")
    return level


def add_jobs_option(parser: argparse.ArgumentParser) -> None:
    """The option of every command that keeps several processors busy."""
    parser.add_argument(
        "--jobs",
        type=numbers.whole(numbers.MOST_JOBS),
        metavar="N",
        help="at once (default: as many as there are processors)",
    )


def add_iterations_option(parser: argparse.ArgumentParser, of_what: str) -> None:
    """The option of every command that searches."""
    parser.add_argument("--iterations", type=numbers.whole(10**9), default=ITERATIONS, metavar="N", help=of_what)


def add_cluster_option(parser: argparse.ArgumentParser, what: str) -> None:
    """The option of every command that others may work for."""
    parser.add_argument(
        "--cluster", metavar="ADDRESS", help=f"{what} on a Dask cluster, such as tcp://host:8786 (default: here)"
    )


def add_recording_options(parser: argparse.ArgumentParser) -> None:
    """The options of every command that records."""
    parser.add_argument(
        "--profile", default="", metavar="NAME", help="what is being done; goes into the file's name (default: none)"
    )
    parser.add_argument("--note", default="", metavar="TEXT", help="a note that is kept in the file (default: none)")
    parser.add_argument(
        "--rotate",
        metavar="SIZE|TIME",
        help="begin a new file at a size (100MB, 2GB) or after a time (90s, 30min, 1h; default: one file)",
    )
    parser.add_argument("--raw", action="store_true", help="keep the bytes of the link too, each read with its time")


def add_force_option(parser: argparse.ArgumentParser) -> None:
    """The option of every command that could write over a session."""
    parser.add_argument("--force", action="store_true", help="replace sessions that are there already")


def add_damage_option(parser: argparse.ArgumentParser) -> None:
    """The option of every command that reads sessions."""
    parser.add_argument(
        "--allow-damage",
        action="store_true",
        help="go on with what is whole of a damaged recording (default: end with status 4)",
    )


def read_session(path: Path, stated: "ReadingOptions | None" = None, *, allow_damage: bool) -> "Session":
    """A session by the units that are stated; what there is to say of it is told, with what is missing.

    Raises
    ------
    DamagedError
        Where it is damaged and that is not allowed.
    """
    from gyrodrift.session.files import load_session

    session = load_session(path, stated.columns if stated else None, allow_damage=allow_damage)
    tell_remarks(path, session)
    if session.damage is not None:
        _tell_damage(path, str(session.damage))
    return stated.applied(session) if stated else session


def checked_session(path: Path, arguments: argparse.Namespace) -> "Session":
    """A session by the units that are stated, on one clock; what the checks warn of is told.

    Raises
    ------
    DamagedError
        Where it is damaged and that is not allowed.
    DataError
        Where its numbers contradict what they are taken for.
    """
    from gyrodrift.session.checks.examine import examined

    stated = reading(arguments)
    found = examined(read_session(path, stated, allow_damage=arguments.allow_damage), stated)
    for warning in found.warnings:
        print(visible(f"gyrodrift: warning: {path}: {warning}"), file=sys.stderr)
    found.refuse_errors(str(path))
    return found.session


def check_damage(paths: Iterable[Path], *, allow_damage: bool) -> None:
    """Look for damage before hours of work; where it is allowed, what is missing is told.

    Raises
    ------
    DamagedError
        With every recording that is damaged, where that is not allowed.
    """
    from gyrodrift.session.damage import DamagedError
    from gyrodrift.session.files import damages_of

    damages = damages_of(paths)
    if damages and not allow_damage:
        raise DamagedError(damages)
    for path, damage in damages:
        _tell_damage(path, str(damage))


def _tell_damage(path: Path, damage: str) -> None:
    print(visible(f"gyrodrift: warning: {path}: is damaged: {damage}"), file=sys.stderr)


def withheld(text: str) -> str:
    """The name of an effect.

    Raises
    ------
    UsageError
        Where there is none of that name.
    """
    hold_product_threads()
    from firmware_sim.effects.catalogue import CATALOGUE

    if text not in CATALOGUE:
        raise unknown("effect", f"--withhold {text}", CATALOGUE)
    return text


def effect(text: str) -> "Effect":
    """An effect with its parameters, or of typical size.

    Raises
    ------
    UsageError
        Where there is no such effect or parameter, or a value is none or out of range.
    """
    hold_product_threads()
    from firmware_sim.rig import parse_effect
    from firmware_sim.yaml_file import FileError

    try:
        return parse_effect(text)
    except FileError as error:
        raise UsageError(str(error)) from error


def profile(text: str) -> str:
    """The name of a shipped motion, or of a file.

    Raises
    ------
    UsageError
        Where it looks like a name, and there is none.
    """
    hold_product_threads()
    from firmware_sim.motion.profile import shipped_profiles

    is_path = Path(text).suffix or Path(text).name != text or Path(text).is_file()
    if text not in shipped_profiles() and not is_path:
        raise unknown("profile or file", f"--profile {text}", shipped_profiles())
    return text


def progress_of(arguments: argparse.Namespace, shares: "Mapping[str, float] | None" = None) -> "Progress":
    """Bars on stderr, unless nobody looks on."""
    from gyrodrift.progress import Progress

    return Progress(sys.stderr, shares, is_quiet=arguments.quiet)


def add_filter_options(parser: argparse.ArgumentParser, config_help: str) -> None:
    """The options of every command that corrects a rate as it comes."""
    either = parser.add_mutually_exclusive_group()
    either.add_argument("--config", type=Path, metavar="FILE", help=f"{config_help} (default: none)")
    either.add_argument(
        "--filter",
        choices=tuple(FILTERS),
        help=f"run this filter at its defaults, without a file (default: {DEFAULT.name})",
    )


def chosen_config(arguments: argparse.Namespace) -> "Config":
    """The config that is asked for, or that of a filter at its defaults; what it leaves to the defaults is told."""
    from gyrodrift.config.model import Config

    return Config(arguments.filter or DEFAULT.name) if arguments.config is None else loaded_config(arguments.config)


def config_tables(path: Path, config: "Config") -> dict[str, dict[str, str]]:
    """What a recording keeps of a config: its text, and the calibration by which its rates are to be put right."""
    return {"config": {"file": str(path), "text": config.text}, **calibration_tables(config)}


def calibration_tables(config: "Config") -> dict[str, dict[str, str]]:
    """The calibration as a recording keeps it; an empty table says that there is none any more."""
    return {"calibration": {} if config.calibration is None else config.calibration.table()}


def calibrated_session(arguments: argparse.Namespace, config: "Config") -> "Session":
    """The checked session of a command, its rates put right by the calibration of the config, or else by its own.

    Raises
    ------
    DataError
        Where its numbers contradict what they are taken for.
    """
    from gyrodrift.session.calibrated import device_of, with_config

    path, given = arguments.session, config.calibration
    session = checked_session(path, arguments)
    if given is not None and not given.is_for(device_of(session)):
        whose = f"the calibration is one of {given.device_id} and is not applied"
        print(f"gyrodrift: warning: {path}: is of the device {device_of(session)}; {whose}", file=sys.stderr)
    return with_config(session, given)


def loaded_config(path: Path) -> "Config":
    """A config that is read once; what it leaves to the defaults is told."""
    from gyrodrift.config.model import load_config

    config = load_config(path)
    if config.completed:
        print(f"gyrodrift: {path}: defaults are {', '.join(config.completed)}", file=sys.stderr)
    return config


def hold_product_threads() -> None:
    """Before numpy is imported: the products of the analyses are small, and its threads only get in the way."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def processes(jobs: int | None) -> int:
    """Of `--jobs`: as many as there are processors where nothing is said."""
    return jobs or processor_count()
