"""Text for unit files of systemd and rules of udev: escaped, or refused with a reason."""

import re
from collections.abc import Sequence
from urllib.parse import quote

from gyrodrift.values.errors import UsageError

PLAIN = re.compile(r"[A-Za-z0-9/_.:,+=@~-]+")
"""Characters without a special meaning in a unit file."""

USB_NUMBER = re.compile(r"[0-9A-Fa-f]{4}")
"""A vendor or product number, as the kernel writes it (Linux, Documentation/ABI/testing/sysfs-bus-usb)."""

NOT_PLAIN_IN_A_SERIAL = re.compile(r"[^A-Za-z0-9_.:-]")
ANY_ONE_BYTE = "?"
"""udev matches by shell patterns (udev(7)): `?` is any one byte."""

LONGEST_SERIAL = 256
"""USB allows 126 characters; a longer text is no serial number."""

NO_PROGRAM = frozenset("\"'\\$")
"""Characters that systemd refuses in the path of a program (systemd.service(5))."""


def command_line(words: Sequence[str]) -> str:
    """Write a command as `ExecStart=` reads it (systemd.service(5), COMMAND LINES).

    Raises
    ------
    UsageError
        If a word has characters that a unit file cannot hold.
    """
    if NO_PROGRAM & set(words[0]):
        raise UsageError(
            f"{words[0]!r}: systemd runs no program with a quote, $ or \\ in its path; install it elsewhere"
        )
    return " ".join(_word(word) for word in words)


def _word(text: str) -> str:
    if not text.isprintable():
        raise UsageError(f"{text!r} has characters that a unit file cannot hold: use a path of printable characters")
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("%", "%%").replace("$", "$$")
    return text if PLAIN.fullmatch(text) else f'"{escaped}"'


def plain_text(text: str) -> str:
    """Text for a description, with `_` for special characters."""
    return "".join(letter if PLAIN.fullmatch(letter) else "_" for letter in text)


def file_url(path: str) -> str:
    """URL of a path for `Documentation=`."""
    return f"file://{quote(path)}".replace("%", "%%")


def usb_number(text: str) -> str:
    """Check a vendor or product number.

    Raises
    ------
    UsageError
        If it is not four hexadecimal digits.
    """
    if not USB_NUMBER.fullmatch(text):
        raise UsageError(
            f"the USB number {text!r} of the adapter is not four hexadecimal digits: no udev rule is written"
        )
    return text


def serial_pattern(serial: str) -> str:
    """Udev pattern of a serial number: letters, digits and `_.:-` stay, other bytes become `?`."""
    pattern = NOT_PLAIN_IN_A_SERIAL.sub(ANY_ONE_BYTE, serial[:LONGEST_SERIAL])
    return f"{pattern}*" if len(serial) > LONGEST_SERIAL else pattern
