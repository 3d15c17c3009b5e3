"""Options that several commands share, and how their values are read."""

import argparse
import os
import re
import sys
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from gyrodrift.errors import UsageError
from gyrodrift.filters.filter import Filter, FilterParams
from gyrodrift.filters.registry import DEFAULT, FILTERS

if TYPE_CHECKING:
    from gyrodrift.config.model import Config

SIZES = {"kb": 1000, "mb": 1_000_000, "gb": 1_000_000_000}
TIMES_S = {"s": 1.0, "min": 60.0, "h": 3600.0}


def add_link_options(parser: argparse.ArgumentParser) -> None:
    """The options of every command that reads a device."""
    from gyrodrift.link.protocols.registry import AUTO, PROTOCOLS

    parser.add_argument("--port", required=True, help="serial port of the device, such as /dev/ttyUSB0")
    parser.add_argument(
        "--baud",
        default="auto",
        help="line rate in baud, or auto to find it (default); a rate that is given is kept to",
    )
    protocols = ", ".join(f"{protocol.name} ({protocol.help})" for protocol in PROTOCOLS.values())
    parser.add_argument("--protocol", default=AUTO, help=f"auto to find it (default), {protocols}")
    parser.add_argument(
        "--timeout",
        type=float,
        default=10.0,
        metavar="S",
        help="give up where nothing decodable came within S seconds of the start; 0 waits for ever (default 10)",
    )


def add_log_options(parser: argparse.ArgumentParser) -> None:
    """The options of every command that logs."""
    parser.add_argument("--log-level", default="info", choices=("debug", "info", "warning", "error"))
    parser.add_argument("--log-format", default="auto", choices=("auto", "text", "json"))


def add_recording_options(parser: argparse.ArgumentParser) -> None:
    """The options of every command that records."""
    parser.add_argument("--profile", default="", metavar="NAME", help="what is being done; goes into the file's name")
    parser.add_argument("--note", default="", metavar="TEXT", help="a note that is kept in the file")
    parser.add_argument(
        "--rotate", metavar="SIZE|TIME", help="begin a new file at a size (100MB, 2GB) or after a time (90s, 30min, 1h)"
    )
    parser.add_argument("--raw", action="store_true", help="keep the bytes of the link too, each read with its time")


def add_force_option(parser: argparse.ArgumentParser) -> None:
    """The option of every command that could write over a session."""
    parser.add_argument("--force", action="store_true", help="replace sessions that are there already")


def add_filter_options(parser: argparse.ArgumentParser, config_help: str) -> None:
    """The options of every command that corrects a rate as it comes."""
    either = parser.add_mutually_exclusive_group()
    either.add_argument("--config", type=Path, metavar="FILE", help=config_help)
    either.add_argument(
        "--filter",
        choices=tuple(FILTERS),
        help=f"run this filter at its defaults, without a file (default: {DEFAULT.name})",
    )


def chosen_filter(arguments: argparse.Namespace) -> tuple[Filter, FilterParams]:
    """The filter that is asked for, and its parameters; what a config leaves to the defaults is told."""
    if arguments.config is None:
        chosen = FILTERS[arguments.filter or DEFAULT.name]
        return chosen, chosen.params()
    config = loaded_config(arguments.config)
    return config.chosen, config.params


def loaded_config(path: Path) -> "Config":
    """A config that is read once; what it leaves to the defaults is told."""
    from gyrodrift.config.model import load_config

    config = load_config(path)
    if config.completed:
        print(f"gyrodrift: {path}: defaults are {', '.join(config.completed)}", file=sys.stderr)
    return config


def check_seed(seed: int) -> None:
    """Refuse a seed that no generator takes."""
    if seed < 0:
        raise UsageError(f"--seed {seed}: expected a whole number from 0")


def need_packages(command: str, *names: str) -> None:
    """Refuse to begin where a package of the workstation is missing, rather than break off half way."""
    try:
        for name in names:
            import_module(name)
    except ImportError as error:
        from gyrodrift.installation import extra_command

        raise UsageError(f"{command} needs the package {error.name}: {extra_command('lab')}") from error


def hold_product_threads() -> None:
    """Before numpy is imported: the products of the analyses are small, and its threads only get in the way."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def processes(jobs: int | None) -> int:
    """Of `--jobs`: as many as there are processors where nothing is said."""
    return jobs or len(os.sched_getaffinity(0))


def rotation(text: str | None) -> tuple[int | None, float | None]:
    """Bytes and seconds at which a new file begins, from `--rotate`; None for never."""
    if text is None:
        return None, None
    found = re.fullmatch(r"(\d+(?:\.\d+)?) ?([A-Za-z]+)", text)
    number, unit = (float(found[1]), found[2].lower()) if found else (0.0, "")
    if number > 0.0 and unit in SIZES:
        return round(number * SIZES[unit]), None
    if number > 0.0 and unit in TIMES_S:
        return None, number * TIMES_S[unit]
    raise UsageError(f"--rotate {text}: expected a size such as 100MB or 2GB, or a time such as 90s, 30min or 1h")


def baud(text: str) -> int | None:
    """A line rate; None for `auto`."""
    if text == "auto":
        return None
    if not text.isdigit() or int(text) == 0:
        raise UsageError(f"--baud {text}: expected a rate in baud such as 115200, or auto")
    return int(text)


def positive(name: str, value: float | None) -> float | None:
    """A number above 0, or None where it was not given."""
    if value is not None and not 0.0 < value < float("inf"):
        raise UsageError(f"{name} {value:g}: expected a number above 0")
    return value
