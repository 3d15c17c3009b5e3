"""Logs of ArduPilot (.bin, .log) and PX4 (.ulg): the first gyro; its z axis points down."""

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing, contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from io import StringIO
from math import degrees
from mmap import ACCESS_READ, mmap
from pathlib import Path
from typing import Any

import numpy as np

from gyrodrift.io.installation import packages_of
from gyrodrift.session.session import AXIS_COLUMNS, TABLE, Session
from gyrodrift.session.tables.known import DOWN
from gyrodrift.values.arrays import Floats
from gyrodrift.values.constants import US_PER_S
from gyrodrift.values.errors import DataError

Z_UP = np.array([degrees(1.0), -degrees(1.0), -degrees(1.0), 1.0, -1.0, -1.0])
"""Factors from rad/s and m/s² with z down to deg/s and m/s² with z up."""

TIMESTAMP = "timestamp"
"""Field of every topic of PX4, µs."""

ARDUPILOT_AXES = ("GyrX", "GyrY", "GyrZ", "AccX", "AccY", "AccZ")
STDERR = 2
ARDUPILOT_FORMAT, LENGTH_AT, HEAD_BYTES = b"\xa3\x95\x80", 4, 3
"""Start of a message that declares another one, index of the declared length, and the smallest valid length."""

ARDUPILOT_MAGIC, ARDUPILOT_TEXT, PX4_MAGIC = b"\xa3\x95", b"FMT, 128, 89, FMT,", b"ULog\x01\x12\x35"


@dataclass(frozen=True, slots=True)
class UlogTopic:
    """A topic of PX4 with the fields of its rates, rad/s, and accelerations, m/s², about x, y and z; empty without."""

    name: str
    rates: tuple[str, ...]
    forces: tuple[str, ...] = ()


ULOG_TOPICS = (
    UlogTopic(
        "sensor_combined",
        ("gyro_rad[0]", "gyro_rad[1]", "gyro_rad[2]"),
        ("accelerometer_m_s2[0]", "accelerometer_m_s2[1]", "accelerometer_m_s2[2]"),
    ),
    UlogTopic("vehicle_angular_velocity", ("xyz[0]", "xyz[1]", "xyz[2]")),
    UlogTopic("sensor_gyro", ("x", "y", "z")),
)
"""Best first (docs.px4.io, uORB messages)."""

HOLE = bytes(1 << 16)
"""No ULog message is longer than 64 KiB, and its size and type are not 0: so many zeros are a hole in the file."""


def is_ardupilot_text(path: Path) -> bool:
    """Whether a `.log` is a log of ArduPilot."""
    with path.open("rb") as file:
        return file.read(len(ARDUPILOT_TEXT)) == ARDUPILOT_TEXT


def read_ardupilot(path: Path) -> Session:
    """Load a log of ArduPilot: rates in rad/s and accelerations of the first gyro, at `IMU.TimeUS`.

    Raises
    ------
    DataError
        The file is no such log, is damaged or has no gyro, or `pymavlink` is missing.
    """
    with path.open("rb") as file:
        is_binary = file.read(2) == ARDUPILOT_MAGIC
    if not is_binary and not is_ardupilot_text(path):
        raise DataError(f"{path}: is no log of ArduPilot")
    with packages_of(path, "logs"):
        from pymavlink import DFReader
    if is_binary:
        _check_formats(path)
    try:
        with _silence():  # it prints each byte that it cannot read
            opened = DFReader.DFReader_binary if is_binary else DFReader.DFReader_text
            with closing(opened(str(path))) as log:
                rows = list(_imu_rows(log))
    except Exception as error:  # bytes from anywhere
        raise DataError(f"{path}: is damaged: {error}") from error
    if not rows:
        raise DataError(f"{path}: has no messages IMU with TimeUS and GyrZ")
    gyros = sorted({row[0] for row in rows})
    table = np.array([row[1:] for row in rows if row[0] == gyros[0]])
    remarks = [f"it has {len(gyros)} gyros, the first is used"] if len(gyros) > 1 else []
    return _session(path, "ArduPilot", table[:, 0], table[:, 2:], table[:, 1], remarks)


def _check_formats(path: Path) -> None:
    """See that every declared message has a length; without it pymavlink loops forever."""
    start = -1
    with path.open("rb") as file, mmap(file.fileno(), 0, access=ACCESS_READ) as content:
        while (start := content.find(ARDUPILOT_FORMAT, start + 1)) >= 0:
            if len(content) > start + LENGTH_AT and content[start + LENGTH_AT] < HEAD_BYTES:
                raise DataError(f"{path}: is damaged: at byte {start} it declares a message without length")


@contextmanager
def _silence() -> Iterator[None]:
    """Discard all output of packages, also of their C code."""
    with redirect_stdout(StringIO()), redirect_stderr(StringIO()), Path(os.devnull).open("w") as nowhere:
        saved_fd = os.dup(STDERR)
        os.dup2(nowhere.fileno(), STDERR)
        try:
            yield
        finally:
            os.dup2(saved_fd, STDERR)
            os.close(saved_fd)


def _imu_rows(log: Any) -> Iterator[tuple[float, ...]]:
    """Number of the gyro, time in µs, temperature in °C, rates in rad/s and accelerations in m/s²."""
    while (message := log.recv_match(type=["IMU", "IMU2", "IMU3"])) is not None:
        fields: Mapping[str, Any] = message.to_dict()
        if "TimeUS" in fields and "GyrZ" in fields:
            gyro = int(fields.get("I", 0)) + max(0, ("IMU", "IMU2", "IMU3").index(fields["mavpackettype"]))
            values = (float(fields.get(name, np.nan)) for name in ("T", *ARDUPILOT_AXES))
            yield gyro, float(fields["TimeUS"]), *values


def read_px4(path: Path) -> Session:
    """Load a log of PX4 in the format ULog.

    Raises
    ------
    DataError
        The file is no such log, is damaged or has no gyro, or `pyulog` is missing.
    """
    with path.open("rb") as file:
        if file.read(len(PX4_MAGIC)) != PX4_MAGIC:
            raise DataError(f"{path}: is no log of PX4: it does not begin as ULog")
    with packages_of(path, "logs"):
        from pyulog import ULog
    _check_holes(path)
    try:
        with _silence():
            log = ULog(str(path), [topic.name for topic in ULOG_TOPICS])
    except Exception as error:  # bytes from anywhere
        raise DataError(f"{path}: is damaged: {error}") from error
    for topic in ULOG_TOPICS:
        for recorded in log.data_list:
            fields = recorded.data
            is_read = recorded.name == topic.name and recorded.multi_id == 0
            if is_read and {TIMESTAMP, topic.rates[2]} <= fields.keys():
                with np.errstate(all="ignore"):  # damaged bytes may be a signaling NaN
                    times = fields[TIMESTAMP].astype(np.float64)
                    axes = [_values(fields, name, len(times)) for name in (*topic.rates, *(topic.forces or ("",) * 3))]
                return _session(path, f"PX4, {topic.name}", times, np.column_stack(axes), None, [])
    names = ", ".join(topic.name for topic in ULOG_TOPICS)
    raise DataError(f"{path}: has none of the topics {names} with a time and a rate")


def _values(fields: Mapping[str, Any], name: str, count: int) -> Floats:
    """Values of a field; NaN without it."""
    values: Floats = fields[name].astype(np.float64) if name in fields else np.full(count, np.nan)
    return values


def _check_holes(path: Path) -> None:
    """See that no zeros replace messages: pyulog would take minutes for some megabytes of them."""
    with path.open("rb") as file, mmap(file.fileno(), 0, access=ACCESS_READ) as content:
        start = content.find(HOLE)
        if start >= 0:
            raise DataError(
                f"{path}: is damaged: only zeros from byte {start} to {start + len(HOLE)} and maybe further"
            )


def _session(
    path: Path, form: str, times_us: Floats, axes: Floats, temp_c: Floats | None, remarks: Sequence[str]
) -> Session:
    """Session of a sensor with z down; `axes` are rates in rad/s and accelerations in m/s², shape (n, 6)."""
    if not len(times_us):
        raise DataError(f"{path}: has no samples")
    all_remarks = (DOWN, *remarks)
    axes_up = axes * Z_UP
    return Session(
        name=path.stem,
        t_device_s=times_us / US_PER_S,
        rate_dps=axes_up[:, 2],
        rate_scale=degrees(1.0),
        temp_c=None if temp_c is None or np.isnan(temp_c).all() else temp_c,
        metadata={TABLE: {"form": form, "remarks": "; ".join(all_remarks)}},
        remarks=all_remarks,
    ).with_axes(dict(zip(AXIS_COLUMNS, axes_up.T, strict=True)))
