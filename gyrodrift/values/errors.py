"""Errors for people, and the exit status of a command that ends with one.

```
GyrodriftError
├── UsageError            2   wrong arguments (a ValueError)
│   └── ConfigError       2   a YAML file with mistakes; lists all of them
├── LinkError             3   the port, the cable, the device
│   ├── PortMissingError      (a FileNotFoundError)
│   ├── PortDeniedError       (a PermissionError)
│   ├── PortBusyError
│   ├── DeviceSilentError     no decodable data in time (a TimeoutError)
│   └── UnitError             a device clock that does not count microseconds
└── DataError             4   a session that cannot be read (a ValueError)
    ├── DamagedError          changed or missing bytes (gyrodrift.session.damage)
    └── CalibrationError      turns or a rest that give no calibration
```

A message names the thing, the problem, and the next step. Damaged bytes are counted, never raised.
"""

import re
from collections.abc import Sequence
from typing import ClassVar

from gyrodrift.values.secret import without_secrets

MOST_LINES, LONGEST_LINE = 40, 1000
"""Most lines of a message, and characters of a line: a message may quote a file or a device. Chosen."""

CONTROLS = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")
"""Control characters except tab and line feed; a terminal may execute them."""


class GyrodriftError(Exception):
    """Root of the tree; `exit_status` is the exit status of a command that fails with it.

    The message has a limited length, no control characters, and no passwords.
    """

    exit_status: ClassVar[int] = 1

    def __init__(self, message: str) -> None:
        lines = [shortened(visible(line), LONGEST_LINE) for line in without_secrets(message).split("\n")]
        dropped = len(lines) - MOST_LINES
        super().__init__("\n".join([*lines[:MOST_LINES], f"and {dropped} lines more"] if dropped > 0 else lines))


def shortened(text: str, most: int) -> str:
    """Shorten a text to at most `most` characters."""
    return text if len(text) <= most else f"{text[: most // 2]} … {text[-most // 4 :]}"


def visible(text: str) -> str:
    r"""Escape the control characters of a text from a file or a device, as `\x1b`."""
    return CONTROLS.sub(lambda match: f"\\x{ord(match[0]):02x}", text)


def printable(text: str) -> str:
    r"""Escape each character that a terminal does not print in its place: `\x1b`, a mark of direction, `\udcff`."""
    if text.isprintable():
        return text
    return "".join(character if character.isprintable() else repr(character)[1:-1] for character in text)


class UsageError(GyrodriftError, ValueError):
    """Wrong arguments of a command or a function."""

    exit_status = 2


class ConfigError(UsageError):
    """A config file with mistakes; `problems` are lines `file:line:column key: mistake, and expected value`."""

    def __init__(self, problems: Sequence[str]) -> None:
        super().__init__("\n".join(problems))
        self.problems = tuple(problems)


class LinkError(GyrodriftError):
    """The serial link cannot be used."""

    exit_status = 3


class PortMissingError(LinkError, FileNotFoundError):
    """The port does not exist."""


class PortDeniedError(LinkError, PermissionError):
    """The user may not open the port."""


class PortBusyError(LinkError):
    """Another process holds the port."""


class DeviceSilentError(LinkError, TimeoutError):
    """The port is open, but no decodable data arrived in time."""


class UnitError(LinkError):
    """The stream is decoded, but its clock has a different unit than assumed."""


class DataError(GyrodriftError, ValueError):
    """A recorded session cannot be read."""

    exit_status = 4


class CalibrationError(DataError):
    """Recorded turns or rests do not determine the calibration."""
