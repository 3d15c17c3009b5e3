"""Text from outside, as unit files of systemd and rules of udev may hold it: escaped, or refused with a reason."""

import re
from collections.abc import Sequence
from urllib.parse import quote

from gyrodrift.errors import UsageError

PLAIN = re.compile(r"[A-Za-z0-9/_.:,+=@~-]+")
"""Characters that mean themselves everywhere in a unit file."""

USB_NUMBER = re.compile(r"[0-9A-Fa-f]{4}")
"""A vendor or product number, as the kernel writes it (Linux, Documentation/ABI/testing/sysfs-bus-usb)."""

NOT_PLAIN_IN_A_SERIAL = re.compile(r"[^A-Za-z0-9_.:-]")
ANY_ONE_BYTE = "?"
"""udev matches by shell patterns (udev(7)): `?` is any one byte."""

LONGEST_SERIAL = 256
"""USB allows 126 characters; a longer text is no serial number."""

NO_PROGRAM = frozenset("\"'\\$")
"""systemd takes no program whose path has one of them (systemd.service(5): the first word is not substituted)."""


def command_line(words: Sequence[str]) -> str:
    """Write a command as `ExecStart=` reads it (systemd.service(5), COMMAND LINES).

    Raises
    ------
    UsageError
        Where a word has characters that a unit file cannot hold.
    """
    if NO_PROGRAM & set(words[0]):
        raise UsageError(
            f"{words[0]!r}: systemd runs no program with a quote, $ or \\ in its path: install it elsewhere"
        )
    return " ".join(_word(word) for word in words)


def _word(text: str) -> str:
    if not text.isprintable():
        raise UsageError(f"{text!r} has characters that a unit file cannot hold: use a path of printable characters")
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("%", "%%").replace("$", "$$")
    return text if PLAIN.fullmatch(text) else f'"{escaped}"'


def plain_text(text: str) -> str:
    """Text for a description, with `_` in the place of characters that might mean something."""
    return "".join(letter if PLAIN.fullmatch(letter) else "_" for letter in text)


def file_url(path: str) -> str:
    """A path as `Documentation=` takes it."""
    return f"file://{quote(path)}".replace("%", "%%")


def usb_number(text: str) -> str:
    """A vendor or product number.

    Raises
    ------
    UsageError
        Where it is none.
    """
    if not USB_NUMBER.fullmatch(text):
        raise UsageError(
            f"the USB number {text!r} of the adapter is not four hexadecimal digits: no udev rule is written"
        )
    return text


def serial_pattern(serial: str) -> str:
    """A pattern that matches a serial number, in which letters, digits and `_.:-` stand for themselves."""
    found = NOT_PLAIN_IN_A_SERIAL.sub(ANY_ONE_BYTE, serial[:LONGEST_SERIAL])
    return f"{found}*" if len(serial) > LONGEST_SERIAL else found
