"""Provenance of a page, its last section: date, version, command and files."""

import platform
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from gyrodrift import __version__
from gyrodrift.report.page import Section
from gyrodrift.values.words import listed

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
    return listed(names)


def _name(path: Path) -> str:
    resolved = path.resolve()
    return resolved.name if path.is_dir() else resolved.stem


def provenance(made: Provenance) -> Section:
    """The section."""
    values = {
        "made": made,
        "version": f"gyrodrift {__version__}, Python {platform.python_version()}, {platform.machine()}",
        "shown": [name for name in ("name", "use", "sha256") if any(getattr(file, name) for file in made.sessions)],
    }
    return Section("report/templates/provenance.html", values, "Provenance")
