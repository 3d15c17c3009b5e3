"""The folder of a written library, with a record of its files, so that no change of a user is overwritten.

The record has a hash of each file as it was written. A file that still has its hash may be replaced by a newer
version of gyrodrift. A file with another hash was changed by its user, or is not from gyrodrift.
"""

import json
from collections.abc import Mapping
from contextlib import suppress
from hashlib import sha256
from pathlib import Path

from gyrodrift.io.files import NAMED, UnreadableError, check_writable, read_json, read_ordinary, write_whole
from gyrodrift.values.errors import UsageError

RECORD = ".gyrodrift-firmware.json"
LONGEST_BYTES = 4 << 20
"""Longest file that is compared; a written header has a twentieth of it."""


def check_replaceable(folder: Path, texts: Mapping[str, str], *, force: bool) -> None:
    """Check that writing loses no file: files of others and changed files are replaced only with `force`.

    Raises
    ------
    UsageError
        With the names of the files that would be lost.
    """
    recorded = _record(folder)
    lost = [path for path, text in texts.items() if not _is_replaceable(folder / path, text, recorded.get(path))]
    if lost and not force:
        rest = f" and {len(lost) - NAMED} more" if len(lost) > NAMED else ""
        names = ", ".join(str(folder / path) for path in lost[:NAMED])
        raise UsageError(
            f"{names}{rest}: not as gyrodrift firmware wrote it; choose another --out, or --force replaces it"
        )


def write_library(folder: Path, texts: Mapping[str, str]) -> None:
    """Write the files, each whole or not at all, and their record.

    Raises
    ------
    UsageError
        A file cannot be written.
    """
    for path, text in texts.items():
        file = folder / path
        check_writable(file.parent)
        write_whole(file, [text])
    hashes = _record(folder) | {path: _hash(text.encode()) for path, text in texts.items()}
    write_whole(folder / RECORD, [json.dumps(hashes, indent=0, sort_keys=True) + "\n"])


def _record(folder: Path) -> dict[str, str]:
    """Hashes of the files that were written; empty without a record."""
    with suppress(FileNotFoundError, UnreadableError):
        hashes = read_json(folder / RECORD, LONGEST_BYTES)
        if isinstance(hashes, dict):
            return {str(path): str(value) for path, value in hashes.items()}
    return {}


def _is_replaceable(file: Path, text: str, recorded: str | None) -> bool:
    """Whether nothing is lost: there is no file, or it has the new text, or the text that was written before."""
    try:
        content = read_ordinary(file, LONGEST_BYTES).content
    except FileNotFoundError:
        return True
    except UnreadableError:
        return False
    return content == text.encode() or _hash(content) == recorded


def _hash(content: bytes) -> str:
    return sha256(content).hexdigest()
