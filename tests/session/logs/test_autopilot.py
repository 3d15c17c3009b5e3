"""Logs of ArduPilot and PX4, written here byte by byte as their formats say."""

import struct
from collections.abc import Iterator
from math import radians
from pathlib import Path

import numpy as np
import pytest
from tables_support import TURN_DEG, filtered_yaw_deg, samples, written

from gyrodrift.cli import main
from gyrodrift.io.installation import extra_command
from gyrodrift.session.files import load_session
from gyrodrift.values.errors import DataError

IMU_COLUMNS = "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,T"
IMU_FORMAT, IMU_STRUCT = "QBfffffff", struct.Struct("<QB7f")
FORMAT = struct.Struct("<BBBBB4s16s64s")
"""Head, and of the message that is declared: number, length, name, kinds and names of its columns."""

ULOG_COLUMNS = "sensor_combined:uint64_t timestamp;float[3] gyro_rad;uint32_t gyro_integral_dt;"


def declared(number: int, length: int, name: str, kinds: str, columns: str) -> bytes:
    return FORMAT.pack(0xA3, 0x95, 128, number, length, name.encode(), kinds.encode(), columns.encode())


def imu_values(gyros: int = 1) -> Iterator[tuple[float, ...]]:
    for _, t_s, rate_dps in samples():
        for gyro in range(gyros):
            yield 3_000_000 + round(1e6 * t_s), gyro, 0.1, 0.2, -radians(rate_dps), 0.0, 0.0, -9.8, 31.5


def dataflash(gyros: int = 1) -> bytes:
    heads = declared(128, 89, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns")
    heads += declared(160, 3 + IMU_STRUCT.size, "IMU", IMU_FORMAT, IMU_COLUMNS)
    return heads + b"".join(b"\xa3\x95\xa0" + IMU_STRUCT.pack(*row) for row in imu_values(gyros))


def dataflash_text() -> str:
    heads = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n"
    heads += f"FMT, 160, {3 + IMU_STRUCT.size}, IMU, {IMU_FORMAT}, {IMU_COLUMNS}\n"
    return heads + "".join(f"IMU, {', '.join(map(str, row))}\n" for row in imu_values())


def ulog(columns: str = ULOG_COLUMNS, name: bytes = b"sensor_combined") -> bytes:
    def message(kind: bytes, content: bytes) -> bytes:
        return struct.pack("<Hc", len(content), kind) + content

    head = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0)
    head += message(b"B", bytes(40)) + message(b"F", columns.encode()) + message(b"A", b"\0\0\0" + name)
    return head + b"".join(
        message(b"D", struct.pack("<HQ3fI", 0, round(1e6 * t_s), 0.1, 0.2, -radians(rate_dps), 5000))
        for _, t_s, rate_dps in samples()
    )


@pytest.mark.promise("Files of other programs")
@pytest.mark.parametrize("name", ["log.bin", "LOG.BIN", "00000001.log"])
def test_a_log_of_ardupilot_is_read(tmp_path: Path, name: str, capsys: pytest.CaptureFixture[str]) -> None:
    """ArduPilot logs are read."""
    pytest.importorskip("pymavlink")
    path = written(tmp_path / name, dataflash_text() if name.endswith(".log") else dataflash())
    assert filtered_yaw_deg(path) == pytest.approx(TURN_DEG, abs=1.0)
    assert "its z axis points down, so the sign of the rate is reversed" in capsys.readouterr().err
    session = load_session(path)
    assert session.t_device_s[0] == 3.0
    assert session.temp_c is not None
    assert session.temp_c[0] == pytest.approx(31.5)


def test_the_first_gyro_of_several_is_taken(tmp_path: Path) -> None:
    pytest.importorskip("pymavlink")
    session = load_session(written(tmp_path / "log.bin", dataflash(3)))
    assert len(session.rate_dps) == len(list(samples()))
    assert "it has 3 gyros, the first is used" in session.remarks


@pytest.mark.promise("Files of other programs")
def test_a_log_of_px4_is_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """PX4 logs are read."""
    pytest.importorskip("pyulog")
    assert filtered_yaw_deg(written(tmp_path / "flight.ulg", ulog())) == pytest.approx(TURN_DEG, abs=1.0)
    assert "its z axis points down" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("name", "content", "package", "message"),
    [
        ("a.bin", b"\0\1\2\3" * 9, "", "is no log of ArduPilot"),
        ("a.ulg", b"\0\1\2\3" * 9, "", "is no log of PX4"),
        (
            "a.bin",
            dataflash().replace(b"\x80\xa0\x28", b"\x80\xa0\0"),
            "pymavlink",
            "declares a message without length",
        ),
        ("a.bin", dataflash()[:178], "pymavlink", "has no messages IMU with TimeUS and GyrZ"),
        ("a.ulg", ulog(name=b"battery_status"), "pyulog", "has none of the topics sensor_combined|is damaged"),
    ],
)
def test_what_is_no_log_is_said(tmp_path: Path, name: str, content: bytes, package: str, message: str) -> None:
    if package:
        pytest.importorskip(package)
    with pytest.raises(DataError, match=message):
        load_session(written(tmp_path / name, content))


@pytest.mark.promise("Files of other programs")
def test_the_extra_is_named_where_its_package_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """If a package is missing, the message names the extra to install."""
    for package in ("pymavlink", "pyulog", "rosbags", "rosbags.highlevel"):
        monkeypatch.setitem(__import__("sys").modules, package, None)
    for name, content, extra in (
        ("a.bin", dataflash(), "logs"),
        ("a.ulg", ulog(), "logs"),
        ("a.bag", b"#ROSBAG", "ros"),
    ):
        assert main(["info", str(written(tmp_path / name, content))]) == 4
        assert extra_command(extra) in capsys.readouterr().err


def test_a_topic_of_px4_without_its_time_is_none(tmp_path: Path) -> None:
    pytest.importorskip("pyulog")
    columns = ULOG_COLUMNS.replace("timestamp", "timestbmp")
    with pytest.raises(DataError, match=r"none of the topics sensor_combined, .* with a time and a rate"):
        load_session(written(tmp_path / "a.ulg", ulog(columns)))


def test_a_log_of_px4_with_signaling_nans_is_read_without_a_warning(tmp_path: Path) -> None:
    """Damaged bytes may be any bit pattern; numpy warns of some when it converts them."""
    pytest.importorskip("pyulog")
    rate = struct.pack("<f", -radians(next(rate_dps for _, _, rate_dps in samples() if rate_dps)))
    path = written(tmp_path / "a.ulg", ulog().replace(rate, b"\x01\x00\xa0\x7f"))
    assert np.isnan(load_session(path).rate_dps).any()


@pytest.mark.promise("Files of other programs")
@pytest.mark.parametrize("position", ["definitions", "data"])
def test_a_hole_in_a_log_of_px4_is_damage(tmp_path: Path, position: str) -> None:
    """A PX4 log with a hole of zeros is refused at once."""
    path = tmp_path / "a.ulg"
    path.write_bytes(ulog()[:16] if position == "definitions" else ulog())
    with path.open("r+b") as file:
        file.truncate(10_000_000_000)
    with pytest.raises(DataError, match=r"a\.ulg: is damaged: only zeros from byte \d+ to \d+"):
        load_session(path)


def test_a_log_of_ardupilot_gives_all_axes_with_z_up(tmp_path: Path) -> None:
    pytest.importorskip("pymavlink")
    session = load_session(written(tmp_path / "log.bin", dataflash()))
    assert session.gyro_dps is not None
    assert session.accel_mps2 is not None
    assert session.gyro_dps[0] == pytest.approx((5.7296, -11.4592, session.rate_dps[0]), abs=1e-3)
    assert session.accel_mps2[0] == pytest.approx((0.0, 0.0, 9.8), abs=1e-6)


def test_a_log_of_px4_gives_all_axes_with_z_up(tmp_path: Path) -> None:
    pytest.importorskip("pyulog")
    session = load_session(written(tmp_path / "flight.ulg", ulog()))
    assert session.gyro_dps is not None
    assert session.gyro_dps[0] == pytest.approx((5.7296, -11.4592, session.rate_dps[0]), abs=1e-3)
    assert session.accel_mps2 is None
