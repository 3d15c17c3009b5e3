"""Tables of known programs: the columns that are used, and their documentation."""

import re
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from gyrodrift.columns.spec import Column, parsed

NOTHING: Mapping[str, str] = {}


@dataclass(frozen=True, slots=True)
class KnownTable:
    """A form of table that is read without options.

    name
        Program or device that writes it.
    columns
        SPEC by label; the table has all of its labels. A label that begins with `*` fits every label with this ending.
    source
        Documentation of the columns and their units.
    file
        Pattern of the file name, if other tables of the program have the same header; empty for any name.
    scale_key
        Key of the preamble with deg/s per count, as the bits of a float; empty if the SPEC has the scale.
    where
        Column and value of the rows to use, in tables that mix sensors.
    remark
        Note for the user; may be empty.
    """

    name: str
    columns: str
    source: str
    file: str = ""
    scale_key: str = ""
    where: tuple[str, str] | None = None
    remark: str = ""

    def indices(self, path: Path, labels: tuple[str, ...]) -> list[tuple[int, Column]] | None:
        """Columns with their indices; None for another form of table."""
        if self.file and not re.search(self.file, path.name, re.IGNORECASE):
            return None
        if self.where is not None and label_index(labels, self.where[0]) is None:
            return None
        placed = [(label_index(labels, column.label), column) for column in parsed(self.columns)]
        return (
            [(index, column) for index, column in placed if index is not None]
            if all(p[0] is not None for p in placed)
            else None
        )

    def scale(self, preamble: Mapping[str, str]) -> float | None:
        """Factor of the rates besides their unit; None if the preamble lacks it."""
        if not self.scale_key:
            return 1.0
        try:
            bits = struct.pack(">I", int(preamble[self.scale_key], 16))
        except (KeyError, ValueError, struct.error):
            return None
        scale: float = struct.unpack(">f", bits)[0]
        return scale if 1e-6 < scale < 1e3 else None


def plain(label: str) -> str:
    """A label in lower case, without comment marks and repeated spaces."""
    return " ".join(label.strip().lstrip("#%").split()).casefold()


def label_index(labels: tuple[str, ...], label: str) -> int | None:
    """Index of a label; None if it is missing or occurs twice."""
    name = plain(label)
    fits = [
        index
        for index, candidate in enumerate(labels)
        if plain(candidate) == name or (name.startswith("*") and plain(candidate).endswith(name[1:]))
    ]
    return fits[0] if len(fits) == 1 else None


DOWN = "its z axis points down, so the sign of the rate is reversed"

KNOWN_TABLES = (
    KnownTable(
        "phyphox",
        "Time (s)=t_s, Gyroscope z (rad/s)=rate:rads",
        "phyphox.org, export of the experiment Gyroscope",
    ),
    KnownTable(
        "Sensor Logger",
        "time=t_ns, seconds_elapsed=_, z=rate:rads",
        "github.com/tszheichoi/awesome-sensor-logger, CROSSPLATFORM.md: Gyroscope in rad/s, time in ns since 1970",
        file=r"gyroscope",
    ),
    KnownTable(
        "Sensor Logger (JSON)",
        "time=t_ns, seconds_elapsed=_, z=rate:rads",
        "as above, JSON export: an object per sample with the name of the sensor",
        where=("sensor", "Gyroscope"),
    ),
    KnownTable(
        "SensorLog (gyroscope)",
        "gyroTimestamp_sinceReboot(s)=t_s, gyroRotationZ(rad/s)=rate:rads",
        "sensorlog.berndthomas.net, list of columns",
    ),
    KnownTable(
        "SensorLog (device motion)",
        "motionTimestamp_sinceReboot(s)=t_s, motionRotationRateZ(rad/s)=rate:rads",
        "as above; iOS has subtracted its own bias",
    ),
    KnownTable(
        "Physics Toolbox",
        "time=t_s, gFx=_, gFy=_, gFz=_, wx=_, wy=_, wz=rate:rads",
        "vieyrasoftware.net, multi record: w in rad/s",
    ),
    KnownTable(
        "EuRoC",
        "timestamp [ns]=t_ns, w_RS_S_z [rad s^-1]=rate:rads",
        "ASL dataset format, imu0/data.csv",
    ),
    KnownTable(
        "rostopic echo -p",
        "%time=t_ns, field.header.stamp=_, field.angular_velocity.z=rate:rads",
        "wiki.ros.org/rostopic; sensor_msgs/Imu is in rad/s",
    ),
    KnownTable(
        "bagpy",
        "Time=t_s, header.stamp.secs=_, angular_velocity.z=rate:rads",
        "jmscslgroup.github.io/bagpy; sensor_msgs/Imu is in rad/s",
    ),
    KnownTable(
        "PlotJuggler",
        "__time=t_s, */angular_velocity/z=rate:rads",
        "facontidavide.github.io/PlotJuggler, export as csv; sensor_msgs/Imu is in rad/s",
    ),
    KnownTable(
        "Betaflight blackbox",
        "loopIteration=_, time=t_us, gyroADC[2]=rate",
        "betaflight.com/docs, blackbox: gyro_scale is deg/s a count, its bits as a float",
        scale_key="gyro_scale",
    ),
    KnownTable(
        "blackbox_decode",
        "loopIteration=_, time (us)=t_us, gyroADC[2] (deg/s)=rate:dps",
        "github.com/betaflight/blackbox-tools, --unit-rotation deg/s",
    ),
    KnownTable(
        "ArduPilot (mavlogdump)",
        "TimeUS=t_us, I=_, GyrX=_, GyrZ=rate:rads:-",
        "ardupilot.org, onboard message log: IMU in rad/s, z down; the first gyro",
        where=("I", "0"),
        remark=DOWN,
    ),
    KnownTable(
        "PX4 (ulog2csv)",
        "timestamp=t_us, gyro_rad[2]=rate:rads:-",
        "docs.px4.io, uORB message sensor_combined: rad/s, z down",
        remark=DOWN,
    ),
    KnownTable(
        "WitMotion",
        "Time(s)=_, ChipTime()=t_s, AsZ(°/s)=rate:dps",
        "wit-motion.com, recording of the PC software",
    ),
)
"""Known forms; the first one that fits is used."""
