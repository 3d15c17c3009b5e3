"""Sessions from MCAP as arrays: files in the own layout at once, finished or torn.

`foreign` reads files of other programs.
"""

from math import nan
from operator import itemgetter
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from mcap.opcode import Opcode
from numpy.typing import NDArray

from gyrodrift.io.system import read_at
from gyrodrift.session.aids import RowAid, RowAids
from gyrodrift.session.damage import DamagedError, RecordingDamage
from gyrodrift.session.mcap.ending import is_bare
from gyrodrift.session.mcap.inspection import Inspection, inspect
from gyrodrift.session.mcap.layout import (
    AIDS,
    LATEST_NS,
    LAYOUTS,
    MAGIC,
    MESSAGE_START,
    PROVED,
    REPAIR,
    SAMPLES,
    STILLS,
)
from gyrodrift.session.mcap.rows import DEVICE_YAW, ROW_SIZES, ROWS, Rows, finished
from gyrodrift.session.mcap.walk import (
    BrokenRecordError,
    PlacedRecord,
    SampleRows,
    Walk,
    aid_in,
    channel_of,
    metadata_of,
    schema_of,
    still_of,
)
from gyrodrift.session.mcap.write import McapWriter, Stream
from gyrodrift.session.session import AXIS_COLUMNS, DEVICE_COLUMNS, Session
from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import DataError

LATEST_SAMPLE = 1 << 62
"""Numbers of samples are clipped to this."""

OPTIONAL = ("t_host_s", "encoder_deg", "temp_c")
"""Optional columns; all NaN in a file without them."""

UNPROVED = (
    "it was repaired from a damaged file without usable checksums: samples may be wrong, repeated or in another order"
)

WIDE = {"axes": tuple(AXIS_COLUMNS), DEVICE_YAW: DEVICE_COLUMNS}
"""Columns of a session by the field of a row that has all of them."""

OWN_SCHEMAS = {
    (layout.topic.schema_name, layout.topic.schema_encoding, layout.topic.schema_text.encode())
    for layout in LAYOUTS.values()
}
VALUES = ("seq", "t_device_s", "rate_dps", *OPTIONAL)


def read_mcap(path: Path, *, allow_damage: bool = False) -> Session:
    """Load a session from `.mcap`.

    A file that was never closed gives all its whole samples.

    Raises
    ------
    DamagedError
        Bytes were changed or are missing, and `allow_damage` is not given.
    DataError
        It is no MCAP file, has no samples, or contradicts itself.
    """
    try:
        with path.open("rb") as file:
            if is_bare(file):
                raise DataError(f"{path}: nothing was recorded before it was cut off; it can be deleted")
            inspection = inspect(file)
            if not inspection.is_ours and read_at(file.fileno(), len(MAGIC), 0) != MAGIC:
                raise DataError(f"{path}: is no MCAP file: it does not begin as one")
            session = _read_own(path, file, inspection)
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror}") from error
    except MemoryError as error:
        raise DataError(f"{path}: its samples need more memory than this computer has") from error
    if session is None:
        from gyrodrift.session.foreign.read import read_foreign  # noqa: PLC0415 - imports decoders that own files do not need

        return read_foreign(path)
    if session.damage is not None and not allow_damage:
        raise DamagedError([(path, session.damage)])
    return session


def _read_own(path: Path, file: BinaryIO, inspection: Inspection) -> Session | None:
    """The session; None if its samples have another layout."""
    walk = Walk(file, inspection.stretches)
    columns, declared = _Columns(inspection, walk.zeros_at), _Declared(is_ours=inspection.is_ours)
    for step in walk:
        match step:
            case SampleRows(rows=rows) if declared.is_ours:
                columns.take(rows)
            case SampleRows() | PlacedRecord(opcode=Opcode.CHUNK):
                return None
            case PlacedRecord(opcode=Opcode.DATA_END):
                break
            case PlacedRecord():
                try:
                    if step.opcode == Opcode.MESSAGE:
                        columns.take_message(walk.body(step))
                    else:
                        declared.take(step, walk)
                except BrokenRecordError as error:
                    if not inspection.is_damaged:
                        raise DataError(f"{path}: {error}; the file was changed since it was written") from error
    if not columns.count and inspection.is_ours and inspection.lost:
        raise DamagedError([(path, RecordingDamage(tuple(inspection.lost), 0, tuple(inspection.remarks)))])
    return columns.session(path.stem, declared.metadata) if columns.count else None


class _Columns:
    """Arrays of a session while they fill; memory without samples is never touched."""

    def __init__(self, inspection: Inspection, zeros_at: int) -> None:
        self.count = 0
        most = sum(stretch.stop - stretch.start for stretch in inspection.stretches)
        self._most = min(zeros_at, most) // min(ROW_SIZES) + 1  # the last sample may end in zeros
        self._inspection = inspection
        self._stills: list[tuple[int, float]] = []
        self._aids: list[RowAid] = []
        self._arrays: dict[str, NDArray[Any]] = {
            name: np.empty(self._most, np.int64 if name == "seq" else np.float64) for name in VALUES
        }
        self._wide: dict[str, Floats] = {}

    def take(self, rows: Rows) -> None:
        """Append a table of samples."""
        end = self.count + len(rows)
        for name, array in self._arrays.items():
            array[self.count : end] = rows[name]
        for name in WIDE:
            self._take_wide(name, rows, end)
        self.count = end

    def _take_wide(self, name: str, rows: Rows, end: int) -> None:
        """Append columns that only some samples of a repaired file may have."""
        if name not in (rows.dtype.names or ()):
            if name in self._wide:
                self._wide[name][self.count : end] = np.nan
            return
        if name not in self._wide:
            self._wide[name] = np.empty((self._most, len(WIDE[name])))
            self._wide[name][: self.count] = np.nan
        self._wide[name][self.count : end] = rows[name]

    def take_message(self, body: bytes) -> None:
        """Read a message that is no sample: rest flags and measurements of second sources are used."""
        if body.startswith(STILLS.channel_id.to_bytes(2, "little")):
            number, still = still_of(body[MESSAGE_START.size :])
            self._stills.append((min(max(number, 0), LATEST_SAMPLE), still))
        elif body.startswith(AIDS.channel_id.to_bytes(2, "little")):
            number, aid = aid_in(body[MESSAGE_START.size :])
            self._aids.append((min(max(number, 0), LATEST_SAMPLE), aid))

    def _still(self) -> Floats | None:
        """Rest flag of every sample; unknown from a loss of records to the next flag."""
        if not self._stills:
            return None
        lost = [(number, nan) for number in self._inspection.record_losses]
        numbers, flags = zip(*sorted([*lost, *self._stills], key=itemgetter(0)) if lost else self._stills, strict=True)
        firsts = self._inspection.kept_before(numbers)
        ends = np.minimum.accumulate([*firsts, self.count][::-1])[::-1]  # a flag holds until the next one
        still: Floats = np.repeat([np.nan, *flags], np.diff(ends, prepend=0))
        return still

    def _row_aids(self) -> RowAids | None:
        """Measurements of second sources with the indices of their samples; None without any."""
        if not self._aids:
            return None
        rows = self._inspection.kept_before([number for number, _ in self._aids])
        placed = ((int(row), aid) for row, (_, aid) in zip(rows, self._aids, strict=True) if row < self.count)
        return tuple(sorted(placed, key=itemgetter(0)))

    def session(self, name: str, metadata: dict[str, dict[str, str]]) -> Session:
        """The session, without the columns that the device never filled."""
        columns = {key: array[: self.count] for key, array in self._arrays.items()}
        wide = {key: array[: self.count] for key, array in self._wide.items()}
        axes, device_yaw = wide.get("axes"), wide.get(DEVICE_YAW)
        session = Session(
            name=name,
            t_device_s=columns["t_device_s"],
            rate_dps=columns["rate_dps"],
            seq=None if (columns["seq"] < 0).all() else columns["seq"],
            **{key: None if _is_empty(columns[key]) else columns[key] for key in OPTIONAL},  # type: ignore[arg-type]
            still=self._still(),
            aids=self._row_aids(),
            metadata=metadata,
            damage=self._inspection.damage(columns["t_device_s"]),
            remarks=(UNPROVED,) if metadata.get(REPAIR, {}).get(PROVED) == "no" else (),
            gyro_dps=None if axes is None or np.isnan(axes[:, :3]).all() else axes[:, :3],
            accel_mps2=None if axes is None or np.isnan(axes[:, 3:]).all() else axes[:, 3:],
        )
        own = {} if device_yaw is None else dict(zip(DEVICE_COLUMNS, device_yaw.T, strict=True))
        return session.with_device_yaw(own)


def _is_empty(column: Floats) -> bool:
    return bool(np.isnan(column[0])) and bool(np.isnan(column).all())


class _Declared:
    """Schema, channel and metadata that a file declared so far."""

    def __init__(self, *, is_ours: bool) -> None:
        self.metadata: dict[str, dict[str, str]] = {}
        self._has_schema = self._has_channel = is_ours

    @property
    def is_ours(self) -> bool:
        """Whether samples have the layout of this version."""
        return self._has_schema and self._has_channel

    def take(self, record: PlacedRecord, walk: Walk) -> None:
        """Read a record that is no table of samples."""
        match record.opcode:
            case Opcode.SCHEMA:
                schema = schema_of(walk.body(record))
                if schema.id == SAMPLES.channel_id:
                    self._has_schema = (schema.name, schema.encoding, schema.data) in OWN_SCHEMAS
            case Opcode.CHANNEL:
                channel = channel_of(walk.body(record))
                if channel.id == SAMPLES.channel_id:
                    declared = (channel.topic, channel.message_encoding, channel.schema_id)
                    self._has_channel = declared == (SAMPLES.name, SAMPLES.message_encoding, SAMPLES.channel_id)
            case Opcode.METADATA:
                table = metadata_of(walk.body(record))
                self.metadata[table.name] = table.metadata


def writer_for(session: Session, stream: Stream, metadata: dict[str, dict[str, str]] | None) -> McapWriter:
    """A writer with a layout that holds all values of a session."""
    has_axes, has_device_yaw = session.gyro_dps is not None, session.device_yaw_deg is not None
    return McapWriter(stream, metadata, has_axes=has_axes, has_device_yaw=has_device_yaw)


def add_chunk(writer: McapWriter, session: Session) -> None:
    """Add the samples of a session at once; columns that the layout of the file does not have are lost."""
    rows = np.zeros(len(session.t_device_s), ROWS[writer.has_axes, writer.has_device_yaw, True])
    if not len(rows):
        return
    rows["seq"] = session.filled("seq")
    rows["t_device_s"], rows["rate_dps"] = session.t_device_s, session.rate_dps
    for name in OPTIONAL:
        rows[name] = session.filled(name)
    for field in set(WIDE) & set(rows.dtype.names or ()):
        for index, name in enumerate(WIDE[field]):
            rows[field][:, index] = session.filled(name)
    rows["publish_time"] = _nanoseconds(session.t_device_s)
    rows["log_time"] = rows["publish_time"] if session.t_host_s is None else _nanoseconds(session.t_host_s)
    if session.still is not None:
        _add_stills(writer, session.still, rows["log_time"])
    for row, aid in session.aids or ():
        t_host_s = float(rows["log_time"][row]) * 1e-9
        writer.add_aid(writer.count + row, aid, float(session.t_device_s[row]), t_host_s)
    content = finished(rows, writer.count, writer.salt)
    writer.add_rows(content, int(rows["log_time"].min()), int(rows["log_time"].max()))


def _add_stills(writer: McapWriter, still: Floats, log_time: NDArray[np.uint64]) -> None:
    """Add the rest flag of the first sample, and every change."""
    is_known = ~np.isnan(still)
    changes = (still[1:] != still[:-1]) & (is_known[1:] | is_known[:-1])
    for index in [0, *(np.flatnonzero(changes) + 1).tolist()]:
        writer.add_still(writer.count + index, float(still[index]), float(log_time[index]) * 1e-9)


def _nanoseconds(seconds: Floats) -> NDArray[np.uint64]:
    finite = np.where(np.isfinite(seconds), seconds, 0.0)
    with np.errstate(over="ignore"):  # clipped to the latest
        return np.clip(finite * 1e9, 0, LATEST_NS).astype(np.uint64)
