"""Options that several commands share, and how their values are read."""

import argparse
from pathlib import Path

from gyrodrift.errors import UsageError


def add_link_options(parser: argparse.ArgumentParser) -> None:
    """The options of every command that reads a device."""
    parser.add_argument("--port", required=True, help="serial port of the device, such as /dev/ttyUSB0")
    parser.add_argument(
        "--baud",
        default="auto",
        help="line rate in baud, or auto to find it (default); a rate that is given is kept to",
    )
    parser.add_argument("--protocol", default="auto", help="auto (default), native, csv or witmotion")
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


def existing(path: Path) -> Path:
    """A path that is there."""
    if not path.exists():
        raise UsageError(f"{path}: there is no such file or folder")
    return path
