"""Sessions as other tools want them: public readers decode every value, and JSON keeps every bit."""

import io
import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from gyrodrift.session.foreign.export import write_imu, write_json
from gyrodrift.session.foreign.read import read_foreign
from gyrodrift.session.session import Session
from gyrodrift.values.errors import DataError, UsageError

UNKNOWN = [-1.0] + [0.0] * 8
METADATA = {"device": {"id": "bench"}}
NAMES = ("t_device_s", "rate_dps", "t_host_s", "seq", "encoder_deg", "temp_c")


def steady(count: int, first: int = 0) -> Session:
    i = np.arange(first, first + count)
    angle_deg = 0.1 * i.astype(np.float64)
    return Session("s", i / 100, np.sin(i), 1.7e9 + i / 100, i, angle_deg, np.full(count, 25.5), METADATA)


def brief(t_device_s: list[float], rate_dps: list[float]) -> Session:
    return Session("s", np.array(t_device_s), np.array(rate_dps))


def opened(path: Path) -> Any:
    return make_reader(io.BytesIO(path.read_bytes()), validate_crcs=True, decoder_factories=[DecoderFactory()])


def decoded(path: Path) -> list[Any]:
    return list(opened(path).iter_decoded_messages())


def test_an_imu_file_is_what_ros_expects(tmp_path: Path) -> None:
    """Value by value: rate in rad/s, stamp from device time, log time from host time, the rest marked as unknown."""
    write_imu(tmp_path / "s.mcap", [steady(120), steady(80, first=120)])
    got = decoded(tmp_path / "s.mcap")
    assert len(got) == 200
    for i, (schema, channel, message, imu) in enumerate(got):
        assert (schema.name, schema.encoding) == ("sensor_msgs/msg/Imu", "ros2msg")
        assert (channel.topic, channel.message_encoding, message.sequence) == ("/imu", "cdr", i)
        assert message.log_time / 1_000_000_000 == 1.7e9 + i / 100
        assert (imu.header.stamp.sec, imu.header.stamp.nanosec) == (i // 100, i % 100 * 10_000_000)
        assert imu.header.frame_id == "gyro"
        assert (imu.angular_velocity.x, imu.angular_velocity.y) == (0.0, 0.0)
        assert imu.angular_velocity.z == math.radians(np.sin(i))
        assert imu.angular_velocity_covariance == [0.0] * 9
        assert imu.orientation_covariance == imu.linear_acceleration_covariance == UNKNOWN
        assert (imu.orientation.x, imu.orientation.w, imu.linear_acceleration.z) == (0.0, 1.0, 0.0)


@pytest.mark.parametrize("write", [write_imu, write_json])
def test_the_file_is_chunked_and_tells_what_is_in_it(tmp_path: Path, write: Any) -> None:
    write(tmp_path / "s.mcap", [steady(100), steady(100, first=100)])
    reader = opened(tmp_path / "s.mcap")
    summary = reader.get_summary()
    assert {chunk.compression for chunk in summary.chunk_indexes} == {"zstd"}
    assert summary.statistics.message_count == 200
    assert {record.name: record.metadata for record in reader.iter_metadata()} == METADATA


def test_an_imu_file_comes_back_here(tmp_path: Path) -> None:
    """Times with the same bits, rates to the last digit or two; what has no place in it is gone."""
    session = steady(500)
    write_imu(tmp_path / "s.mcap", [session])
    back = read_foreign(tmp_path / "s.mcap")
    assert back.t_device_s.tolist() == session.t_device_s.tolist()
    assert back.t_host_s is not None
    assert session.t_host_s is not None
    assert back.t_host_s.tolist() == session.t_host_s.tolist()
    assert back.rate_dps == pytest.approx(session.rate_dps, rel=4e-16, abs=0.0)
    assert (back.seq, back.encoder_deg, back.temp_c) == (None, None, None)


def test_times_before_zero_and_rates_that_are_no_numbers_have_a_place_in_an_imu(tmp_path: Path) -> None:
    """Nanoseconds count upwards, and log times begin at 0."""
    write_imu(tmp_path / "s.mcap", [brief([-1.25, -1e-12, 0.0], [math.nan, math.inf, 0.5])])
    got = decoded(tmp_path / "s.mcap")
    stamps = [(imu.header.stamp.sec, imu.header.stamp.nanosec) for _, _, _, imu in got]
    assert stamps == [(-2, 750_000_000), (0, 0), (0, 0)]
    assert [message.log_time for _, _, message, _ in got] == [0, 0, 0]
    assert [imu.angular_velocity.z for _, _, _, imu in got] == pytest.approx(
        [math.nan, math.inf, math.radians(0.5)], nan_ok=True
    )


@pytest.mark.parametrize("t_device_s", [math.nan, math.inf, -math.inf, 2.0**31, -(2.0**31) - 1, 1e300])
def test_a_time_that_no_stamp_can_say_is_told_and_leaves_nothing(tmp_path: Path, t_device_s: float) -> None:
    with pytest.raises(DataError, match=r"s.mcap: sample 2 has .* as t_device_s, which does not fit header.stamp"):
        write_imu(tmp_path / "s.mcap", [brief([0.0], [0.0]), brief([t_device_s], [0.0])])
    assert not list(tmp_path.iterdir())


def test_json_is_what_anybody_expects(tmp_path: Path) -> None:
    """An object a sample, with a schema, on `/gyro`."""
    write_json(tmp_path / "s.mcap", [steady(120), steady(80, first=120)])
    got = list(opened(tmp_path / "s.mcap").iter_messages())
    assert len(got) == 200
    for i, (schema, channel, message) in enumerate(got):
        assert (schema.name, schema.encoding) == ("gyrodrift.Sample", "jsonschema")
        assert json.loads(schema.data)["required"] == ["t_device_s", "rate_dps"]
        assert (channel.topic, channel.message_encoding) == ("/gyro", "json")
        assert message.log_time / 1_000_000_000 == 1.7e9 + i / 100
        assert json.loads(message.data) == {
            "seq": i,
            "t_device_s": i / 100,
            "t_host_s": 1.7e9 + i / 100,
            "rate_dps": np.sin(i),
            "encoder_deg": 0.1 * i,
            "temp_c": 25.5,
        }


def test_json_leaves_out_what_is_no_number(tmp_path: Path) -> None:
    """Rate and times are null then, so that a reader does not take the log time for the host's."""
    write_json(tmp_path / "s.mcap", [brief([0.0, 1.0, math.nan], [math.nan, -math.inf, 2.0])])
    texts = [message.data.decode() for _, _, message in opened(tmp_path / "s.mcap").iter_messages(log_time_order=False)]
    assert texts == [
        '{"t_device_s":0.0,"t_host_s":null,"rate_dps":null}',
        '{"t_device_s":1.0,"t_host_s":null,"rate_dps":null}',
        '{"t_device_s":null,"t_host_s":null,"rate_dps":2.0}',
    ]
    back = read_foreign(tmp_path / "s.mcap")
    assert back.t_device_s.tolist() == pytest.approx([0.0, 1.0, math.nan], nan_ok=True)
    assert back.rate_dps.tolist() == pytest.approx([math.nan, math.nan, 2.0], nan_ok=True)
    assert (back.t_host_s, back.seq, back.encoder_deg, back.temp_c) == (None, None, None, None)


number = st.floats(allow_infinity=False, width=64)
whole_rows = st.lists(
    st.tuples(number, number, number, st.integers(-1, 2**63 - 1), number, number), min_size=1, max_size=40
)


def session_of(rows: list[tuple[Any, ...]]) -> Session:
    floats = [np.array([row[index] for row in rows], dtype=np.float64) for index in (0, 1, 2, 4, 5)]
    t_device_s, rate_dps, t_host_s, encoder_deg, temp_c = floats
    return Session("s", t_device_s, rate_dps, t_host_s, np.array([row[3] for row in rows]), encoder_deg, temp_c)


def bits(session: Session) -> Iterator[list[int] | None]:
    """Every column as its bits; a column without a single value is the same as none."""
    for name in NAMES:
        column = getattr(session, name)
        is_empty = column is None or bool((column < 0).all() if name == "seq" else np.isnan(column).all())
        if is_empty and name not in NAMES[:2]:
            yield None
        else:
            yield np.where(np.isnan(column), np.nan, column).view("i8").tolist() if name != "seq" else column.tolist()


@given(whole_rows, st.integers(1, 40))
def test_json_keeps_every_bit(tmp_path_factory: pytest.TempPathFactory, rows: list[tuple[Any, ...]], cut: int) -> None:
    path = tmp_path_factory.mktemp("s") / "s.mcap"
    write_json(path, [session_of(part) for part in (rows[:cut], rows[cut:]) if part])
    assert list(bits(read_foreign(path))) == list(bits(session_of(rows)))


@given(st.lists(st.tuples(st.integers(-(2**31) * 10**6, 2**31 * 10**6 - 1), st.floats(-1e6, 1e6)), min_size=1))
def test_an_imu_keeps_every_microsecond(
    tmp_path_factory: pytest.TempPathFactory, rows: list[tuple[int, float]]
) -> None:
    """Device times of whole microseconds come back with the same bits."""
    path = tmp_path_factory.mktemp("s") / "s.mcap"
    session = brief([t_us / 1e6 for t_us, _ in rows], [rate_dps for _, rate_dps in rows])
    write_imu(path, [session])
    back = read_foreign(path)
    assert back.t_device_s.tolist() == session.t_device_s.tolist()
    assert back.rate_dps == pytest.approx(session.rate_dps, rel=1e-15, abs=1e-300)


@pytest.mark.parametrize("write", [write_imu, write_json])
def test_a_place_that_cannot_be_written_to_is_told(tmp_path: Path, write: Any) -> None:
    with pytest.raises(UsageError, match="cannot be written: No such file or directory"):
        write(tmp_path / "none" / "s.mcap", [steady(3)])
