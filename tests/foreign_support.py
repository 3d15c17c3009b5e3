"""MCAP files as others write them: every kind of message, in every form of file."""

import io
import json
import math
import struct
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest
from mcap.writer import CompressionType, IndexType
from mcap.writer import Writer as PlainWriter
from mcap_ros2.writer import Writer as RosWriter

from gyrodrift.session.foreign.read import read_foreign
from gyrodrift.values.errors import DataError

FIELDS = ("seq", "t_device_s", "t_host_s", "rate_dps", "encoder_deg", "temp_c")
SAMPLE_TEXT = "int64 seq\n" + "".join(f"float64 {name}\n" for name in FIELDS[1:])
IMU_TEXT = f"""\
std_msgs/Header header
geometry_msgs/Quaternion orientation
float64[9] orientation_covariance
geometry_msgs/Vector3 angular_velocity
float64[9] angular_velocity_covariance
geometry_msgs/Vector3 linear_acceleration
float64[9] linear_acceleration_covariance
{"=" * 80}
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
{"=" * 80}
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
{"=" * 80}
MSG: geometry_msgs/Quaternion
float64 x 0
float64 y 0
float64 z 0
float64 w 1
{"=" * 80}
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
"""
METADATA = {"robot": {"name": "bench"}}
FORMS: dict[str, dict[str, Any]] = {
    "lz4": {"compression": CompressionType.LZ4},
    "zstd": {"compression": CompressionType.ZSTD},
    "stored": {"compression": CompressionType.NONE},
    "data crc": {"compression": CompressionType.LZ4, "enable_data_crcs": True},
    "no crc": {"enable_crcs": False},
    "unchunked": {"use_chunking": False, "enable_data_crcs": True},
    "bare": {
        "use_chunking": False,
        "index_types": IndexType.NONE,
        "repeat_channels": False,
        "repeat_schemas": False,
        "use_statistics": False,
        "use_summary_offsets": False,
    },
}
MAGIC = b"\x89MCAP0\r\n"
CHANNEL, MESSAGE, CHUNK = 4, 5, 6
"""Opcodes."""

Row = dict[str, float]


def rows(count: int) -> list[Row]:
    return [
        {
            "seq": i,
            "t_device_s": i / 100,
            "t_host_s": 1.7e9 + i / 100,
            "rate_dps": math.sin(i),
            "encoder_deg": 0.1 * i,
            "temp_c": 25.0,
        }
        for i in range(count)
    ]


def cdr(row: Row) -> bytes:
    return struct.pack("<Iqddddd", 0x100, *(row[name] for name in FIELDS))


def as_json(row: dict[str, Any]) -> bytes:
    return json.dumps(row).encode()


class Recorder:
    """A file by the public writer, in the form that is asked for; chunks are small, so that there are many."""

    def __init__(self, **form: Any) -> None:
        self.stream = io.BytesIO()
        self.writer = PlainWriter(self.stream, **{"chunk_size": 600} | form)
        self.writer.start("ros2", "somebody")

    def channel(self, topic: str, encoding: str, schema: tuple[str, str, str] | None = None) -> int:
        schema_id = self.writer.register_schema(schema[0], schema[1], schema[2].encode()) if schema else 0
        return self.writer.register_channel(topic, encoding, schema_id)

    def add(self, channel_id: int, payloads: Iterable[bytes]) -> None:
        for i, payload in enumerate(payloads):
            self.writer.add_message(channel_id, 1_600_000_000_000_000_000 + i * 10_000_000, payload, 0, i)

    def content(self) -> bytes:
        self.writer.finish()  # type: ignore[no-untyped-call]  # the package leaves it unannotated
        return self.stream.getvalue()


def own(values: list[Row], topic: str = "/gyro", name: str = "gyrodrift/Sample", **form: Any) -> bytes:
    recorder = Recorder(**form)
    recorder.writer.add_metadata("robot", METADATA["robot"])
    recorder.add(recorder.channel(topic, "cdr", (name, "ros2msg", SAMPLE_TEXT)), map(cdr, values))
    return recorder.content()


def in_json(payloads: Iterable[bytes], topic: str = "/gyro", **form: Any) -> bytes:
    recorder = Recorder(**form)
    recorder.add(recorder.channel(topic, "json"), payloads)
    return recorder.content()


def imu(i: int, **fields: Any) -> dict[str, Any]:
    return {
        "header": {"stamp": {"sec": 1_700_000_000 + i, "nanosec": 500_000_001}, "frame_id": "imu_link"},
        "orientation_covariance": [-1.0] + [0.0] * 8,
        "angular_velocity": {"x": 9.0, "y": 9.0, "z": 0.01 * i},
        "angular_velocity_covariance": [0.02] + [0.0] * 8,
        "linear_acceleration_covariance": [0.0] * 9,
        **fields,
    }


def ros(messages: Iterable[dict[str, Any]], topic: str = "/imu/data", name: str = "sensor_msgs/msg/Imu") -> bytes:
    stream = io.BytesIO()
    with RosWriter(stream, chunk_size=2000) as writer:
        schema = writer.register_msgdef(name, IMU_TEXT)
        for i, message in enumerate(messages):
            writer.write_message(topic, schema, message, log_time=5_000_000_000 + i * 1000)
    return stream.getvalue()


def written(folder: Path, content: bytes) -> Path:
    path = folder / "s.mcap"
    path.write_bytes(content)
    return path


def refused(folder: Path, content: bytes, topic: str | None = None) -> str:
    path = written(folder, content)
    with pytest.raises(DataError) as caught:
        read_foreign(path, topic)
    text = str(caught.value)
    assert text.startswith(f"{path}: ")
    assert "\n" not in text
    return text.removeprefix(f"{path}: ")
