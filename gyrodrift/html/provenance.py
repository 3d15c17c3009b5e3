"""Provenance of a page, its last section: date, version, command and files."""

import platform
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from gyrodrift import __version__
from gyrodrift.html.html import command_line, facts, headings, section, table, text

NAMED = 3
"""At most this many folders or files name a set; for more, their folders do, or the first of them."""


@dataclass(frozen=True, slots=True)
class UsedFile:
    """A file that a page was made from.

    sha256
        Hash of its content in hexadecimal digits; empty if unknown.
    use
        Purpose in a word or two; empty if all files have the same.
    """

    name: str
    sha256: str = ""
    use: str = ""


@dataclass(frozen=True, slots=True)
class Provenance:
    """Provenance of a page.

    set_name
        Common name of its sessions; see `set_name`.
    command
        Command that wrote the page, to copy.
    date
        Date and time; see `date_now`.
    sessions
        Sessions of the page.
    config
        Parameters in words.
    config_text
        Parameters as the text of their file.
    """

    set_name: str = ""
    command: str = ""
    date: str = ""
    sessions: Sequence[UsedFile] = ()
    config: str = ""
    config_text: str = ""


def date_now() -> str:
    """Date and time of day, UTC."""
    return f"{datetime.now(UTC):%Y-%m-%d %H:%M:%S} UTC"


def set_name(paths: Sequence[Path]) -> str:
    """Common name of sessions, from the paths given to a command: folders, and files without suffix."""
    names = list(dict.fromkeys(_name(path) for path in paths))
    if len(names) > NAMED:
        names = list(dict.fromkeys(_name(path if path.is_dir() else path.parent) for path in paths))
    if len(names) > NAMED:
        return f"{', '.join(names[:NAMED])} and {len(names) - NAMED} more"
    return " and ".join(filter(None, [", ".join(names[:-1]), *names[-1:]]))


def _name(path: Path) -> str:
    resolved = path.resolve()
    return resolved.name if path.is_dir() else resolved.stem


def provenance(made: Provenance) -> str:
    """HTML of the section."""
    rows = [
        ("Date", text(made.date)),
        ("Version", f"gyrodrift {text(__version__)}, Python {platform.python_version()}, {text(platform.machine())}"),
        ("Sessions", text(_counted(made))),
        ("Config", text(made.config)),
        ("Command", command_line(made.command)),
    ]
    filled = [(name, words) for name, words in rows if words]
    return section("Provenance", facts(filled), command_line(made.config_text), _files(made.sessions))


def _counted(made: Provenance) -> str:
    count = len(made.sessions)
    words = f"{count} session{'s' * (count != 1)}" if count else ""
    return f"{made.set_name} ({words})" if made.set_name and words else made.set_name or words


def _files(files: Sequence[UsedFile]) -> str:
    """Table of the files with their hashes, if known; empty without files."""
    if not files:
        return ""
    has_use, has_hash = any(file.use for file in files), any(file.sha256 for file in files)
    head = ["session", *["used for"] * has_use, *["SHA-256"] * has_hash]
    rows = [
        [text(file.name), *[text(file.use)] * has_use, *[f"<code>{text(file.sha256)}</code>"] * has_hash]
        for file in files
    ]
    return table("The sessions.", headings(head, words=len(head) - 1), rows, words=len(head) - 1)
