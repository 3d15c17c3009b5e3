"""Writing a damaged session file anew, from all that is whole in it."""

import json
import os
import shutil
from collections import deque
from contextlib import suppress
from math import nan
from pathlib import Path
from typing import IO

from mcap.opcode import Opcode

from gyrodrift.files import whole_file
from gyrodrift.session.damage import RecordingDamage
from gyrodrift.session.mcap.layout import EVENTS, READS, STILLS
from gyrodrift.session.mcap.surveyed import Survey
from gyrodrift.session.mcap.walk import BrokenRecordError, PlacedRecord, SampleRows, Walk, metadata_of
from gyrodrift.session.mcap.write import MESSAGE_START, McapWriter

TOPICS = {topic.channel_id: topic for topic in (READS, EVENTS)}


def rebuild(path: Path, file: IO[bytes], found: Survey, damage: RecordingDamage) -> Path:
    """Put a whole file in the place of a damaged one; where the damaged one is kept."""
    kept = _free_name(path)
    try:
        os.link(path, kept)
    except OSError:  # a disk without links, such as FAT, or a file of another user
        shutil.copy(path, kept)
    with whole_file(path) as fresh:
        writer = McapWriter(fresh, {"repair": _told(damage)})
        _Copy(Walk(file, found.stretches), found, writer).run()
        writer.finish()
    return kept


def _free_name(path: Path) -> Path:
    kept, number = path.with_name(f"{path.name}.damaged"), 1
    while os.path.lexists(kept):
        number += 1
        kept = path.with_name(f"{path.name}.damaged_{number}")
    return kept


def _told(damage: RecordingDamage) -> dict[str, str]:
    """What a reader of the new file should know."""
    return {
        "damage": str(damage),
        "samples_lost": str(damage.lost_count),
        "seconds_lost": f"{damage.lost_seconds:.6g}",
    }


class _Copy:
    """Copies what is whole, the word of rest with the numbers that its samples have now."""

    def __init__(self, walk: Walk, found: Survey, writer: McapWriter) -> None:
        self._walk = walk
        self._found = found
        self._writer = writer
        self._unheard = deque(found.unheard)
        self._last_ns = 0

    def run(self) -> None:
        """All of it."""
        for step in self._walk:
            self._forget_rest()
            match step:
                case SampleRows(rows=rows):
                    times = rows["log_time"]
                    self._last_ns = int(times.max())
                    self._writer.add_rows(rows.tobytes(), int(times.min()), self._last_ns)
                case PlacedRecord(opcode=Opcode.DATA_END):
                    return
                case PlacedRecord():
                    with suppress(BrokenRecordError):
                        self._record(step)

    def _forget_rest(self) -> None:
        """Behind lost records nobody knows what was said of rest."""
        while self._unheard and self._found.kept_before(self._unheard[0]) <= self._writer.count:
            self._unheard.popleft()
            self._writer.add_still(self._writer.count, nan, self._last_ns * 1e-9)

    def _record(self, record: PlacedRecord) -> None:
        body = self._walk.body(record)
        if record.opcode == Opcode.METADATA:
            table = metadata_of(body)
            self._writer.add_metadata(table.name, table.metadata)
        elif record.opcode == Opcode.MESSAGE and len(body) >= MESSAGE_START.size:
            channel_id, _, log_ns, _ = MESSAGE_START.unpack_from(body)
            content = body[MESSAGE_START.size :]
            if channel_id == STILLS.channel_id:
                self._still(content, log_ns)
            elif channel_id in TOPICS:
                self._writer.add_message(TOPICS[channel_id], content, log_ns)

    def _still(self, content: bytes, log_ns: int) -> None:
        with suppress(ValueError, KeyError, TypeError, OverflowError, RecursionError):
            said = json.loads(content)
            number = self._found.kept_before(int(said["sample"]))
            self._writer.add_still(number, nan if said["still"] is None else float(said["still"]), log_ns * 1e-9)
