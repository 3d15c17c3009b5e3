"""Memory of a filter about a device, as a JSON file that is written whole."""

import json
import os
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from gyrodrift.io.files import UnreadableError, read_ordinary, write_whole
from gyrodrift.values.errors import UsageError

VERSION = 1

LONGEST_BYTES = 1 << 20
"""Longest file, in bytes; a memory takes a few kilobytes."""

CLOCK_UNSET_S = 86_400.0
"""Age of a memory with a time in the future, s: one of the clocks was not set."""

LATEST_S = 1e12
"""Latest Unix time that is accepted, s; the year 33 658."""


class MemoryDamagedError(Exception):
    """A file holds no memory; the text says why."""


@dataclass(frozen=True, slots=True)
class MemoryFile:
    """A memory.

    device
        Name of the device, or of its port.
    filter
        Name of the filter.
    written_s
        Unix time of writing, s.
    knowledge
        Fields of the memory of that filter.
    calibration
        Date of the calibration that was applied; empty for none.
    """

    device: str
    filter: str
    written_s: float
    knowledge: dict[str, Any]
    calibration: str = ""

    def age_s(self, now_s: float) -> float:
        """Age, s."""
        return now_s - self.written_s if now_s >= self.written_s else CLOCK_UNSET_S


def read_memory(path: Path) -> MemoryFile | None:
    """Read a memory; None if there is no file.

    Raises
    ------
    MemoryDamagedError
        If the file holds no memory.
    UsageError
        If it cannot be read.
    """
    try:
        text = read_ordinary(path, LONGEST_BYTES).content.decode()
    except FileNotFoundError:
        return None
    except UnicodeDecodeError as error:
        raise MemoryDamagedError("it is no text") from error
    except UnreadableError as error:
        raise UsageError(f"--memory {path}: {error}") from error
    try:
        content = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise MemoryDamagedError(f"it is no JSON: {error}") from error
    return _memory_of(content)


def _memory_of(content: Any) -> MemoryFile:
    if not isinstance(content, dict) or content.get("gyrodrift_memory") != VERSION:
        raise MemoryDamagedError(f"it says nothing of gyrodrift_memory {VERSION}")
    kinds = {"device": str, "filter": str, "written_s": int | float, "knowledge": dict}
    for name, kind in kinds.items():
        if not isinstance(content.get(name), kind):
            raise MemoryDamagedError(f"{name} is {content.get(name)!r}")
    if not isinstance(content.get("calibration", ""), str):
        raise MemoryDamagedError(f"calibration is {content['calibration']!r}")
    if not abs(content["written_s"]) < LATEST_S:  # JSON can hold NaN, and numbers beyond all floats
        raise MemoryDamagedError("written_s is no time")
    return MemoryFile(
        content["device"],
        content["filter"],
        float(content["written_s"]),
        content["knowledge"],
        content.get("calibration", ""),
    )


def write_memory(path: Path, memory: MemoryFile) -> None:
    """Replace a memory.

    Raises
    ------
    UsageError
        If the file cannot be written; the old memory then stays.
    """
    content = {
        "gyrodrift_memory": VERSION,
        "device": memory.device,
        "filter": memory.filter,
        "calibration": memory.calibration,
        "written": datetime.fromtimestamp(memory.written_s, UTC).isoformat(timespec="seconds"),
        "written_s": memory.written_s,
        "knowledge": memory.knowledge,
    }
    write_whole(path, [json.dumps(content, indent=1, allow_nan=False), "\n"])


def set_aside(path: Path) -> Path:
    """Rename a damaged memory, so that nothing is lost; returns the new name.

    Raises
    ------
    UsageError
        If it cannot be renamed.
    """
    number = 1
    while os.path.lexists(aside := path.with_name(f"{path.name}.damaged_{number}")):
        number += 1
    try:
        path.rename(aside)
    except OSError as error:
        raise UsageError(f"--memory {path}: is damaged and cannot be set aside: {error.strerror}") from error
    return aside
