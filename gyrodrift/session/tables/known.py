"""Tables of known programs: the columns that are used, and their documentation."""

import re
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from math import isclose
from pathlib import Path

from gyrodrift.columns.fields import as_label
from gyrodrift.columns.spec import CLOCK_US, Column, column_of, parsed
from gyrodrift.columns.units import unit_of
from gyrodrift.values.constants import STANDARD_GRAVITY_MPS2

NOTHING: Mapping[str, str] = {}
UNIT_AT_END = re.compile(r"(?<!\s)\s*+[(\[]([^()\[\]]+)[)\]]\s*$")


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
        Key of the preamble with the unit of a count, as a number or as the bits of a float; empty without one.
    clock_key
        Key of the preamble with the seconds of a tick of the clock; empty if the SPEC has the unit.
    where
        Column and value of the rows to use, in tables that mix sensors.
    remark
        Note for the user; may be empty.
    axes
        SPEC of the rates about x and y and of the accelerations; columns that the table lacks are left out.
    force_key
        Key of the preamble with counts per g; empty if the SPEC has the unit.
    """

    name: str
    columns: str
    source: str
    file: str = ""
    scale_key: str = ""
    clock_key: str = ""
    where: tuple[str, str] | None = None
    remark: str = ""
    axes: str = ""
    force_key: str = ""

    def axis_indices(self, labels: tuple[str, ...]) -> list[tuple[int, Column]]:
        """Columns of the axes that the table has, with their indices."""
        columns = [column_of(entry.strip()) for entry in self.axes.split(",") if entry]
        placed = [(label_index(labels, column.label), column) for column in columns]
        return [(index, column) for index, column in placed if index is not None]

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

    def force_scale(self, preamble: Mapping[str, str]) -> float | None:
        """Factor of the accelerations besides their unit; None if the preamble lacks it."""
        if not self.force_key:
            return 1.0
        counts = preamble.get(self.force_key, "")
        return STANDARD_GRAVITY_MPS2 / int(counts) if counts.isdecimal() and int(counts) else None

    def scale(self, preamble: Mapping[str, str]) -> float | None:
        """Factor of the rates besides their unit; None if the preamble lacks it."""
        if not self.scale_key:
            return 1.0
        text = preamble.get(self.scale_key, "")
        try:
            scale: float = struct.unpack(">f", bytes.fromhex(text[2:]))[0] if text.startswith("0x") else float(text)
        except (ValueError, struct.error):
            return None
        return scale if 1e-6 < scale < 1e3 else None

    def clock_unit(self, preamble: Mapping[str, str]) -> str | None:
        """Unit of the clock by the preamble, such as `t_us`; empty if the SPEC has it, None for an unknown one."""
        if not self.clock_key:
            return ""
        try:
            tick_s = float(preamble.get(self.clock_key, ""))
        except ValueError:
            return None
        return next((unit for unit, us in CLOCK_US.items() if isclose(tick_s, us * 1e-6)), None)


def plain(label: str) -> str:
    """A label in lower case, without comment marks and repeated spaces."""
    return " ".join(label.strip().lstrip("#%").split()).casefold()


def label_index(labels: tuple[str, ...], label: str) -> int | None:
    """Index of a label; None if it is missing or occurs twice.

    A label may be given without its unit in brackets, and without the characters that a SPEC cannot hold.
    """
    name = plain(label)
    for names in (labels, tuple(map(bare, labels))):
        fits = [
            index
            for index, candidate in enumerate(map(plain, names))
            if candidate == name or (name.startswith("*") and candidate.endswith(name[1:]))
        ]
        if fits:
            return fits[0] if len(fits) == 1 else None
    return next((index for index, candidate in enumerate(labels) if plain(as_label(candidate)) == name), None)


def bare(label: str) -> str:
    """Label without the unit in brackets at its end."""
    unit = UNIT_AT_END.search(label)
    return label[: unit.start()] if unit and unit_of(unit[1]) else label


DOWN = "its z axis points down, so the sign of the rate is reversed"
"""Also the signs of y, which keeps the frame right-handed, and of accelerations."""

KNOWN_TABLES = (
    KnownTable(
        "Racelogic VBOX",
        "time=t:hms, YawRate=rate:dps:-",
        "racelogic.support, VBO file format: time as HHMMSS.SS; yaw rate in deg/s, clockwise as the heading",
        file=r"\.vbo$",
        remark="its yaw rate is clockwise, so the sign of the rate is reversed",
    ),
    KnownTable(
        "Gyroflow IMU log",
        "t=t_s, gx=gx:rads, gy=gy:rads, gz=rate:rads",
        "docs.gyroflow.xyz, GCSV format: tscale in seconds, gscale in rad/s",
        scale_key="gscale",
        clock_key="tscale",
    ),
    KnownTable(
        "phyphox",
        "Time (s)=t_s, Gyroscope z (rad/s)=rate:rads",
        "phyphox.org, export of the experiment Gyroscope",
        axes=(
            "Gyroscope x (rad/s)=gx:rads, Gyroscope y (rad/s)=gy:rads, Acceleration x (m/s^2)=ax, "
            "Acceleration y (m/s^2)=ay, Acceleration z (m/s^2)=az"
        ),
    ),
    KnownTable(
        "Sensor Logger",
        "time=t_ns, seconds_elapsed=_, z=rate:rads",
        "github.com/tszheichoi/awesome-sensor-logger, CROSSPLATFORM.md: Gyroscope in rad/s, time in ns since 1970",
        file=r"gyroscope",
        axes="x=gx:rads, y=gy:rads",
    ),
    KnownTable(
        "Sensor Logger (JSON)",
        "time=t_ns, seconds_elapsed=_, z=rate:rads",
        "as above, JSON export: an object per sample with the name of the sensor",
        where=("sensor", "Gyroscope"),
        axes="x=gx:rads, y=gy:rads",
    ),
    KnownTable(
        "SensorLog (gyroscope)",
        "gyroTimestamp_sinceReboot(s)=t_s, gyroRotationZ(rad/s)=rate:rads",
        "sensorlog.berndthomas.net, list of columns",
        axes=(
            "gyroRotationX(rad/s)=gx:rads, gyroRotationY(rad/s)=gy:rads, "
            "accelerometerAccelerationX(G)=ax:g:-, accelerometerAccelerationY(G)=ay:g:-, "
            "accelerometerAccelerationZ(G)=az:g:-"
        ),
    ),
    KnownTable(
        "SensorLog (device motion)",
        "motionTimestamp_sinceReboot(s)=t_s, motionRotationRateZ(rad/s)=rate:rads",
        "as above; iOS has subtracted its own bias",
        axes=(
            "motionRotationRateX(rad/s)=gx:rads, motionRotationRateY(rad/s)=gy:rads, "
            "accelerometerAccelerationX(G)=ax:g:-, accelerometerAccelerationY(G)=ay:g:-, "
            "accelerometerAccelerationZ(G)=az:g:-"
        ),
    ),
    KnownTable(
        "Physics Toolbox",
        "time=t_s, gFx=_, gFy=_, gFz=_, wx=_, wy=_, wz=rate:rads",
        "vieyrasoftware.net, multi record: w in rad/s",
        axes="wx=gx:rads, wy=gy:rads, gFx=ax:g, gFy=ay:g, gFz=az:g",
    ),
    KnownTable(
        "EuRoC",
        "timestamp [ns]=t_ns, w_RS_S_z [rad s^-1]=rate:rads",
        "ASL dataset format, imu0/data.csv",
        axes=(
            "w_RS_S_x [rad s^-1]=gx:rads, w_RS_S_y [rad s^-1]=gy:rads, a_RS_S_x [m s^-2]=ax, "
            "a_RS_S_y [m s^-2]=ay, a_RS_S_z [m s^-2]=az"
        ),
    ),
    KnownTable(
        "rostopic echo -p",
        "%time=t_ns, field.header.stamp=_, field.angular_velocity.z=rate:rads",
        "wiki.ros.org/rostopic; sensor_msgs/Imu is in rad/s",
        axes=(
            "field.angular_velocity.x=gx:rads, field.angular_velocity.y=gy:rads, "
            "field.linear_acceleration.x=ax, field.linear_acceleration.y=ay, "
            "field.linear_acceleration.z=az"
        ),
    ),
    KnownTable(
        "bagpy",
        "Time=t_s, header.stamp.secs=_, angular_velocity.z=rate:rads",
        "jmscslgroup.github.io/bagpy; sensor_msgs/Imu is in rad/s",
        axes=(
            "angular_velocity.x=gx:rads, angular_velocity.y=gy:rads, linear_acceleration.x=ax, "
            "linear_acceleration.y=ay, linear_acceleration.z=az"
        ),
    ),
    KnownTable(
        "PlotJuggler",
        "__time=t_s, */angular_velocity/z=rate:rads",
        "facontidavide.github.io/PlotJuggler, export as csv; sensor_msgs/Imu is in rad/s",
        axes=(
            "*/angular_velocity/x=gx:rads, */angular_velocity/y=gy:rads, */linear_acceleration/x=ax, "
            "*/linear_acceleration/y=ay, */linear_acceleration/z=az"
        ),
    ),
    KnownTable(
        "Betaflight blackbox",
        "loopIteration=_, time=t_us, gyroADC[2]=rate",
        "betaflight.com/docs, blackbox: gyro_scale is deg/s a count, its bits as a float",
        scale_key="gyro_scale",
        force_key="acc_1G",
        axes="gyroADC[0]=gx, gyroADC[1]=gy, accSmooth[0]=ax, accSmooth[1]=ay, accSmooth[2]=az",
    ),
    KnownTable(
        "blackbox_decode",
        "loopIteration=_, time (us)=t_us, gyroADC[2] (deg/s)=rate:dps",
        "github.com/betaflight/blackbox-tools, --unit-rotation deg/s",
        axes=(
            "gyroADC[0] (deg/s)=gx, gyroADC[1] (deg/s)=gy, accSmooth[0] (g)=ax:g, "
            "accSmooth[1] (g)=ay:g, accSmooth[2] (g)=az:g"
        ),
    ),
    KnownTable(
        "ArduPilot (mavlogdump)",
        "TimeUS=t_us, I=_, GyrX=_, GyrZ=rate:rads:-",
        "ardupilot.org, onboard message log: IMU in rad/s, z down; the first gyro",
        where=("I", "0"),
        remark=DOWN,
        axes="GyrX=gx:rads, GyrY=gy:rads:-, AccX=ax, AccY=ay:-, AccZ=az:-",
    ),
    KnownTable(
        "PX4 (ulog2csv)",
        "timestamp=t_us, gyro_rad[2]=rate:rads:-",
        "docs.px4.io, uORB message sensor_combined: rad/s, z down",
        remark=DOWN,
        axes=(
            "gyro_rad[0]=gx:rads, gyro_rad[1]=gy:rads:-, accelerometer_m_s2[0]=ax, "
            "accelerometer_m_s2[1]=ay:-, accelerometer_m_s2[2]=az:-"
        ),
    ),
    KnownTable(
        "WitMotion",
        "Time(s)=_, ChipTime()=t_s, AsZ(°/s)=rate:dps",
        "wit-motion.com, recording of the PC software",
        axes="AsX(°/s)=gx, AsY(°/s)=gy, AccX(g)=ax:g, AccY(g)=ay:g, AccZ(g)=az:g",
    ),
)
"""Known forms; the first one that fits is used."""
