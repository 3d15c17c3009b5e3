"""Sessions in MCAP files of other programs.

Four kinds of messages can be read: `gyrodrift/Sample` and `sensor_msgs/msg/Imu` in CDR with a ros2msg schema,
`sensor_msgs/Imu` as ROS 1 serializes it, and JSON objects with the column names of a session.
"""

import math
import struct
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from mcap.well_known import MessageEncoding
from numpy.typing import NDArray

from gyrodrift.session.aids import RowAid
from gyrodrift.session.foreign.channels import Messages, chosen_topic, contents_of
from gyrodrift.session.foreign.columns import Decode, WrongValueError, json_sample
from gyrodrift.session.foreign.records import messages, records
from gyrodrift.session.foreign.ros import cdr_decoder, ros1_imu_sample
from gyrodrift.session.mcap.layout import MAGIC
from gyrodrift.session.mcap.walk import BrokenRecordError
from gyrodrift.session.session import DEVICE_COLUMNS, Session, session_of_columns
from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import DataError
from gyrodrift.values.sample import NO_AXES, NO_YAW, Inertial, Sample

NAMES = (*Sample._fields[:7], *Inertial._fields, *DEVICE_COLUMNS)
OPTIONAL = ("t_host_s", "encoder_deg", "temp_c", "still")
ROW = np.dtype([(name, "i8" if name == "seq" else "f8") for name in NAMES])


def read_foreign(path: Path, topic: str | None = None) -> Session:
    """Load a session from any MCAP file, with the samples in the order of the file.

    A file that was cut off gives all whole messages before the cut.

    Parameters
    ----------
    path
        The file.
    topic
        Channel to read; without it `/gyro`, or else the only readable one.

    Raises
    ------
    DataError
        It is no MCAP file, or damaged. Or no channel, or more than one, can be read. Or a message is no sample.
    """
    with opened_file(path) as file:
        return _session(path, file, topic)


@contextmanager
def opened_file(path: Path) -> Iterator[BinaryIO]:
    """Open an MCAP file, and turn what can go wrong while it is read into an error for the user.

    Raises
    ------
    DataError
        It is damaged, or cannot be read.
    """
    try:
        with path.open("rb") as file:
            yield file
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror or error}") from error
    except BrokenRecordError as error:
        raise DataError(f"{path}: is damaged: {error}") from error
    except (MemoryError, struct.error) as error:
        raise DataError(f"{path}: cannot be read: it needs too much memory, or changes while it is read") from error


def _session(path: Path, file: BinaryIO, topic: str | None) -> Session:
    if file.read(len(MAGIC)) != MAGIC:
        raise DataError(f"{path}: is no MCAP file: it does not begin as one")
    contents = contents_of(records(file))
    chosen = chosen_topic(path, list(contents.channels.values()), topic)
    decoders = {
        channel_id: decoder_of(f"{path}: {channel.topic}", channel)
        for channel_id, channel in contents.channels.items()
        if channel.topic == chosen and channel.is_understood
    }
    is_imu = any(channel.is_imu for channel in contents.channels.values() if channel.topic == chosen)
    aids: list[RowAid] = []
    samples = _with_aids(_samples(f"{path}: {chosen}", file, decoders), aids)
    session = session_of_rows(path.stem, sample_rows(samples), is_imu=is_imu, metadata=contents.metadata)
    return replace(session, aids=tuple(aids)) if aids else session


def _with_aids(samples: Iterable[Sample], aids: list[RowAid]) -> Iterator[Sample]:
    """The samples, whose measurements of second sources are added to a list."""
    for row, sample in enumerate(samples):
        aids += ((row, aid) for aid in sample.aids)
        yield sample


def sample_rows(samples: Iterable[Sample]) -> NDArray[np.void]:
    """Samples as rows of `ROW`, shape (n,)."""
    return np.fromiter(map(_row, samples), ROW)


def session_of_rows(
    name: str, rows: NDArray[np.void], *, is_imu: bool, metadata: dict[str, dict[str, str]] | None = None
) -> Session:
    """Session from rows of `ROW`; the clock of Imu messages may stand still."""
    columns: dict[str, NDArray[Any] | None] = {name: rows[name].copy() for name in NAMES}
    columns |= {name: None for name in OPTIONAL if np.isnan(rows[name]).all()}
    remarks: tuple[str, ...] = ()
    if is_imu:
        columns["t_device_s"], remarks = running_clock(rows["t_device_s"].copy(), rows["t_host_s"])
    if (rows["seq"] < 0).all():
        columns["seq"] = None
    rate_scale = math.degrees(1.0) if is_imu else 1.0
    return session_of_columns(name, columns, metadata=metadata or {}, remarks=remarks, rate_scale=rate_scale)


def _row(sample: Sample) -> tuple[float, ...]:
    return (*sample[:7], *(sample.inertial or NO_AXES), *(sample.device_yaw or NO_YAW))


def running_clock(stamps_s: Floats, logged_s: Floats) -> tuple[Floats, tuple[str, ...]]:
    """Times of the samples in s: their stamps, or the log times if a driver leaves all stamps equal; with a note."""
    is_standing = len(stamps_s) > 1 and bool((stamps_s == stamps_s[0]).all())
    if not is_standing or not len(np.unique(logged_s)) > 1:
        return stamps_s, ()
    remark = f"all of its stamps are {stamps_s[0]:g} s, so the times of logging are used"
    return logged_s - logged_s[0], (remark,)


def _samples(source: str, file: BinaryIO, decoders: dict[int, Decode]) -> Iterator[Sample]:
    read = (body for body in messages(file) if body.channel_id in decoders)
    for number, (channel_id, log_ns, payload) in enumerate(read, 1):
        try:
            sample = decoders[channel_id](payload, log_ns)
        except WrongValueError as error:
            raise DataError(f"{source}: message {number} {error}") from error
        yield sample


def decoder_of(source: str, channel: Messages) -> Decode:
    """Decoder of the messages of a channel that can be read; `source` names it in messages."""
    if channel.encoding == MessageEncoding.JSON or channel.schema is None:
        return json_sample
    if channel.encoding == MessageEncoding.ROS1:
        return ros1_imu_sample
    return cdr_decoder(source, channel.schema)
