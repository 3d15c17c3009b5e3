"""What a filter remembers of a device, as a JSON file that is there whole or not at all."""

import json
import os
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from gyrodrift.errors import UsageError
from gyrodrift.files import UnreadableError, read_ordinary, write_whole

VERSION = 1

LONGEST_BYTES = 1 << 20
"""A memory is a few kilobytes."""

CLOCK_UNSET_S = 86_400.0
"""The age of a memory that was written later than now: the clock of one of the two was not set."""

LATEST_S = 1e12
"""Unix time; the year 33 658."""


class MemoryDamagedError(Exception):
    """A file that holds no memory; it says why."""


@dataclass(frozen=True, slots=True)
class MemoryFile:
    """A memory.

    device
        Whose: what the device calls itself, or the name of its port.
    filter
        Which filter remembers.
    written_s
        Unix time when it was made, s.
    knowledge
        What that filter knows.
    calibration
        Date of the calibration that its rates were put right by; empty for none.
    """

    device: str
    filter: str
    written_s: float
    knowledge: dict[str, Any]
    calibration: str = ""

    def age_s(self, now_s: float) -> float:
        """How old it is, s."""
        return now_s - self.written_s if now_s >= self.written_s else CLOCK_UNSET_S


def read_memory(path: Path) -> MemoryFile | None:
    """The memory in a file; None where there is no file.

    Raises
    ------
    MemoryDamagedError
        Where it holds none.
    UsageError
        Where it cannot be read.
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
    if not abs(content["written_s"]) < LATEST_S:  # JSON may say NaN, and more digits than any float has
        raise MemoryDamagedError("written_s is no time")
    return MemoryFile(
        content["device"],
        content["filter"],
        float(content["written_s"]),
        content["knowledge"],
        content.get("calibration", ""),
    )


def write_memory(path: Path, memory: MemoryFile) -> None:
    """Write a memory in place of the one before.

    Raises
    ------
    UsageError
        Where the place cannot be written to; the one before is still there then.
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
    """Give a file that holds no memory another name, so that nothing of it is lost; that name.

    Raises
    ------
    UsageError
        Where it cannot be renamed.
    """
    number = 1
    while os.path.lexists(aside := path.with_name(f"{path.name}.damaged_{number}")):
        number += 1
    try:
        path.rename(aside)
    except OSError as error:
        raise UsageError(f"--memory {path}: is damaged and cannot be set aside: {error.strerror}") from error
    return aside
