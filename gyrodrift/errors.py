"""Errors for people, and the exit status of a command that ends with one.

    GyrodriftError
    ├── UsageError            2   wrong arguments (a ValueError)
    │   └── ConfigError       2   a YAML file with mistakes, all of them at once
    ├── LinkError             3   the port, the cable, the device
    │   ├── PortMissingError      (a FileNotFoundError)
    │   ├── PortDeniedError       (a PermissionError)
    │   ├── PortBusyError
    │   ├── DeviceSilentError     nothing decodable within the time given (a TimeoutError)
    │   └── UnitError             a device clock in another unit than microseconds
    └── DataError             4   a session that cannot be read (a ValueError)
        ├── DamagedError          changed or missing bytes (gyrodrift.session.damage)
        └── CalibrationError      turns or a rest that calibrate nothing

A message says what happened, to which thing, and what to do. Damaged bytes are counted, never raised.
"""

import re
from collections.abc import Sequence
from typing import ClassVar

from gyrodrift.secret import without_secrets

MOST_LINES, LONGEST_LINE = 40, 1000
"""Of a message: what it quotes may come from a file or a device, and may be of any length."""

CONTROLS = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")
"""All but tab and line feed: a terminal may take them for orders."""


class GyrodriftError(Exception):
    """Root of the tree; `exit_status` is what a command ends with.

    A message is of bounded length, has no control characters, and names no password.
    """

    exit_status: ClassVar[int] = 1

    def __init__(self, message: str) -> None:
        lines = [shortened(visible(line), LONGEST_LINE) for line in without_secrets(message).split("\n")]
        more = len(lines) - MOST_LINES
        super().__init__("\n".join([*lines[:MOST_LINES], f"and {more} lines more"] if more > 0 else lines))


def shortened(text: str, most: int) -> str:
    """A text in no more than so many characters."""
    return text if len(text) <= most else f"{text[: most // 2]} … {text[-most // 4 :]}"


def visible(text: str) -> str:
    r"""A text that came from elsewhere, as a terminal may have it: control characters are written as `\x1b`."""
    return CONTROLS.sub(lambda found: f"\\x{ord(found[0]):02x}", text)


class UsageError(GyrodriftError, ValueError):
    """The command was asked for something it cannot do."""

    exit_status = 2


class ConfigError(UsageError):
    """A config file with mistakes; `problems` has one line each, `file:line:column key: what, and what is expected`."""

    def __init__(self, problems: Sequence[str]) -> None:
        super().__init__("\n".join(problems))
        self.problems = tuple(problems)


class LinkError(GyrodriftError):
    """The serial link cannot be used."""

    exit_status = 3


class PortMissingError(LinkError, FileNotFoundError):
    """There is no such port."""


class PortDeniedError(LinkError, PermissionError):
    """The port may not be opened by this user."""


class PortBusyError(LinkError):
    """Another process holds the port."""


class DeviceSilentError(LinkError, TimeoutError):
    """The port is open, but nothing that can be decoded came in time."""


class UnitError(LinkError):
    """The stream is understood, but its clock has another unit than it is taken for."""


class DataError(GyrodriftError, ValueError):
    """A recorded session cannot be read."""

    exit_status = 4


class CalibrationError(DataError):
    """What the device sent while it was calibrated says nothing of it."""
