"""Names of recordings: date, device and profile."""

import os
import re
from collections.abc import Collection
from datetime import datetime
from pathlib import Path

LONGEST_WORD = 80
"""Characters of a word; names of files have at most 255 bytes."""


def recording_path(
    folder: Path, begun: datetime, device: str, profile: str, taken: Collection[Path] = frozenset()
) -> Path:
    """A path that does not exist yet: `2026-05-01T12-30-00Z_bench-7_turntable.mcap`; `begun` is in UTC.

    Paths in `taken` count as existing.
    """
    words = [f"{begun:%Y-%m-%dT%H-%M-%SZ}", _plain(device), _plain(profile)]
    stem = "_".join(word for word in words if word)
    path, number = folder / f"{stem}.mcap", 1
    while path in taken or os.path.lexists(path):  # a link to nowhere takes a name too
        number += 1
        path = folder / f"{stem}_{number}.mcap"
    return path


def _plain(text: str) -> str:
    """Text as a part of a file name for any file system, shortened."""
    return re.sub(r"[^A-Za-z0-9.-]+", "-", text)[:LONGEST_WORD].strip("-.")
