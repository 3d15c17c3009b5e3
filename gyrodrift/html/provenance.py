"""Where a page comes from, as its last section: when, by which version and command, from which files."""

import platform
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from gyrodrift import __version__
from gyrodrift.html.html import command_line, facts, headings, section, table, text

NAMED = 3
"""So many folders or files name a set; of more their folders do, or the first of them."""


@dataclass(frozen=True, slots=True)
class UsedFile:
    """A file that a page was made from.

    sha256
        Of its content, in hexadecimal digits; empty where it is not known.
    use
        What for, in a word or two; empty where there is one use only.
    """

    name: str
    sha256: str = ""
    use: str = ""


@dataclass(frozen=True, slots=True)
class Provenance:
    """Where a page comes from.

    set_name
        What its sessions are called together; see `set_name`.
    command
        That made it, to be copied.
    date
        When; see `date_now`.
    sessions
        That it was made from.
    config
        Which parameters were used, as words.
    config_text
        The parameters themselves, as they stand in the file.
    """

    set_name: str = ""
    command: str = ""
    date: str = ""
    sessions: Sequence[UsedFile] = ()
    config: str = ""
    config_text: str = ""


def date_now() -> str:
    """Date and time of day, by UTC."""
    return f"{datetime.now(UTC):%Y-%m-%d %H:%M:%S} UTC"


def set_name(paths: Sequence[Path]) -> str:
    """What sessions are called together, by the paths that a command was given: folders, and files without suffix."""
    names = list(dict.fromkeys(_name(path) for path in paths))
    if len(names) > NAMED:
        names = list(dict.fromkeys(_name(path if path.is_dir() else path.parent) for path in paths))
    if len(names) > NAMED:
        return f"{', '.join(names[:NAMED])} and {len(names) - NAMED} more"
    return " and ".join(filter(None, [", ".join(names[:-1]), *names[-1:]]))


def _name(path: Path) -> str:
    whole = path.resolve()
    return whole.name if path.is_dir() else whole.stem


def provenance(made: Provenance) -> str:
    """The section."""
    rows = [
        ("Date", text(made.date)),
        ("Version", f"gyrodrift {text(__version__)}, Python {platform.python_version()}, {text(platform.machine())}"),
        ("Sessions", text(_counted(made))),
        ("Config", text(made.config)),
        ("Command", command_line(made.command)),
    ]
    known = [(name, words) for name, words in rows if words]
    return section("Provenance", facts(known), command_line(made.config_text), _files(made.sessions))


def _counted(made: Provenance) -> str:
    count = len(made.sessions)
    said = f"{count} session{'s' * (count != 1)}" if count else ""
    return f"{made.set_name} ({said})" if made.set_name and said else made.set_name or said


def _files(files: Sequence[UsedFile]) -> str:
    """The table of what it was made from, with hashes where there are any; nothing of nothing."""
    if not files:
        return ""
    has_use, has_hash = any(one.use for one in files), any(one.sha256 for one in files)
    head = ["session", *["used for"] * has_use, *["SHA-256"] * has_hash]
    rows = [
        [text(one.name), *[text(one.use)] * has_use, *[f"<code>{text(one.sha256)}</code>"] * has_hash] for one in files
    ]
    return table("The sessions.", headings(head, words=len(head) - 1), rows, words=len(head) - 1)
