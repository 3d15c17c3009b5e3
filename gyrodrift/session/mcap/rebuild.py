"""Repair of a damaged session file: a new file with everything that is whole."""

import json
import os
import shutil
from collections import deque
from contextlib import suppress
from math import nan
from pathlib import Path
from typing import IO

from mcap.opcode import Opcode

from gyrodrift.io.files import whole_file
from gyrodrift.session.damage import RecordingDamage
from gyrodrift.session.mcap.layout import EVENTS, PROVED, READS, REPAIR, STILLS
from gyrodrift.session.mcap.surveyed import Survey
from gyrodrift.session.mcap.walk import DEVICE_YAW, BrokenRecordError, PlacedRecord, SampleRows, Walk, metadata_of
from gyrodrift.session.mcap.write import MESSAGE_START, McapWriter

TOPICS = {topic.channel_id: topic for topic in (READS, EVENTS)}


def rebuild(path: Path, file: IO[bytes], file_survey: Survey, damage: RecordingDamage) -> Path:
    """Replace a damaged file by a whole one; returns the new path of the damaged file."""
    kept = _free_name(path)
    try:
        os.link(path, kept)
    except OSError:  # a disk without links, such as FAT, or a file of another user
        shutil.copy(path, kept)
    with whole_file(path) as fresh:
        names = _fields(Walk(file, file_survey.stretches))
        table = {REPAIR: _damage_table(damage)}
        writer = McapWriter(fresh, table, has_axes="axes" in names, has_device_yaw=DEVICE_YAW in names)
        _Copy(Walk(file, file_survey.stretches), file_survey, writer).run()
        writer.finish()
    return kept


def _fields(walk: Walk) -> tuple[str, ...]:
    """Fields of the samples of a file."""
    tables = (step.rows for step in walk if isinstance(step, SampleRows))
    return next((rows.dtype.names or () for rows in tables), ())


def _free_name(path: Path) -> Path:
    kept, number = path.with_name(f"{path.name}.damaged"), 1
    while os.path.lexists(kept):
        number += 1
        kept = path.with_name(f"{path.name}.damaged_{number}")
    return kept


def _damage_table(damage: RecordingDamage) -> dict[str, str]:
    """Metadata table about the damage."""
    return {
        "damage": str(damage),
        "samples_lost": str(damage.lost_count),
        "seconds_lost": f"{damage.lost_seconds:.6g}",
        PROVED: "yes" if damage.is_sure else "no",
    }


class _Copy:
    """Copies everything whole; rest flags get the new numbers of their samples."""

    def __init__(self, walk: Walk, file_survey: Survey, writer: McapWriter) -> None:
        self._walk = walk
        self._survey = file_survey
        self._writer = writer
        self._record_losses = deque(file_survey.record_losses)
        self._last_ns = 0

    def run(self) -> None:
        """Copy all records."""
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
        """Write an unknown rest flag after lost records."""
        while self._record_losses and self._survey.kept_before(self._record_losses[0]) <= self._writer.count:
            self._record_losses.popleft()
            self._writer.add_still(self._writer.count, nan, self._last_ns * 1e-9)

    def _record(self, record: PlacedRecord) -> None:
        body = self._walk.body(record)
        if record.opcode == Opcode.METADATA:
            table = metadata_of(body)
            if table.name != REPAIR or table.metadata.get(PROVED) == "no":  # once unproved, always unproved
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
            values = json.loads(content)
            number = self._survey.kept_before(int(values["sample"]))
            self._writer.add_still(number, nan if values["still"] is None else float(values["still"]), log_ns * 1e-9)
