"""Sessions of a device that runs a filter itself: its yaw, sigma and drift are kept in every format."""

from dataclasses import replace
from io import BytesIO
from math import nan
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from numpy.testing import assert_array_equal

from gyrodrift.session.files import load_session, write_session
from gyrodrift.session.foreign.export import write_json
from gyrodrift.session.foreign.read import read_foreign
from gyrodrift.session.mcap.layout import SAMPLES
from gyrodrift.session.mcap.read import read_mcap
from gyrodrift.session.mcap.repair import repair
from gyrodrift.session.mcap.write import McapWriter
from gyrodrift.session.session import DEVICE_COLUMNS, Session, session_of
from gyrodrift.session.tables.write import session_table, write_rows
from gyrodrift.values.sample import DeviceYaw, Inertial, Sample

AXES = Inertial(0.1, 0.2, 0.3, 0.0, 0.0, 9.81)


def samples(count: int, *, has_axes: bool = False) -> list[Sample]:
    """Every third sample has no result of the device, and every fifth result no sigma."""
    return [
        Sample(
            i,
            i / 100.0,
            1.7e9 + i / 100.0,
            0.5,
            inertial=AXES if has_axes else None,
            device_yaw=None if i % 3 == 2 else DeviceYaw(0.1 * i, nan if i % 5 == 0 else 0.01 * i, -0.25),
        )
        for i in range(count)
    ]


def recorded(path: Path, count: int, *, has_axes: bool = False, is_finished: bool = True) -> Path:
    stream = BytesIO()
    writer = McapWriter(stream, {"device": {"device_id": "bench"}}, has_axes=has_axes, has_device_yaw=True)
    for first in range(0, count, 100):
        writer.add_all(samples(count, has_axes=has_axes)[first : first + 100])
        writer.flush()
    if is_finished:
        writer.finish()
    path.write_bytes(stream.getvalue())
    return path


def own_columns(session: Session) -> dict[str, list[float]]:
    return {name: session.filled(name).tolist() for name in DEVICE_COLUMNS}


@pytest.mark.parametrize("has_axes", [False, True])
def test_what_is_recorded_is_read_back(tmp_path: Path, *, has_axes: bool) -> None:
    session = read_mcap(recorded(tmp_path / "a.mcap", 250, has_axes=has_axes))
    expected = session_of("a", samples(250, has_axes=has_axes))
    for name in (*DEVICE_COLUMNS, "t_device_s", "rate_dps"):
        assert_array_equal(session.filled(name), expected.filled(name))
    assert (session.gyro_dps is not None) == has_axes
    assert np.isnan(session.filled("device_yaw_deg")).sum() == 83


@pytest.mark.parametrize("has_axes", [False, True])
def test_a_killed_recording_is_repaired_with_its_yaws(tmp_path: Path, *, has_axes: bool) -> None:
    path = recorded(tmp_path / "a.mcap", 300, has_axes=has_axes, is_finished=False)
    path.write_bytes(path.read_bytes()[:-40])
    repaired = repair(path)
    assert repaired is not None
    session = read_mcap(path)
    assert len(session.rate_dps) == repaired.samples >= 290
    assert session.filled("device_yaw_deg")[100] == 0.1 * 100


def test_a_damaged_recording_is_rebuilt_with_its_yaws(tmp_path: Path) -> None:
    path = recorded(tmp_path / "a.mcap", 3000)
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 0xFF
    path.write_bytes(content)
    assert repair(path) is not None
    session = read_mcap(path)
    assert 2900 < len(session.rate_dps) < 3000
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.channel_message_counts[SAMPLES.channel_id] == len(session.rate_dps)
    assert b"float64 device_yaw_deg" in summary.schemas[SAMPLES.channel_id].data
    assert session.seq is not None
    has_yaw = session.seq % 3 != 2
    assert_array_equal(session.filled("device_yaw_deg")[has_yaw], 0.1 * session.seq[has_yaw])


@pytest.mark.parametrize("ending", ["csv", "mcap", "jsonl", "parquet"])
def test_every_format_keeps_the_columns(tmp_path: Path, ending: str) -> None:
    session, path = session_of("a", samples(50)), tmp_path / f"b.{ending}"
    if ending in ("csv", "mcap"):
        write_session(path, [session.part(0, 20), session.part(20, 50)])
    else:
        pytest.importorskip("pyarrow")
        write_rows(path, *session_table([session]))
    again = load_session(path)
    assert_array_equal(list(own_columns(again).values()), list(own_columns(session).values()))


def test_json_messages_keep_the_columns(tmp_path: Path) -> None:
    session, path = session_of("a", samples(50)), tmp_path / "b.mcap"
    write_json(path, [session])
    assert_array_equal(list(own_columns(read_foreign(path)).values()), list(own_columns(session).values()))


def test_a_session_without_any_yaw_has_no_columns(tmp_path: Path) -> None:
    plain = session_of("a", [sample._replace(device_yaw=None) for sample in samples(5)])
    assert not set(DEVICE_COLUMNS) & plain.columns().keys()
    path = tmp_path / "a.csv"
    path.write_text("t_device_s,rate_dps,device_yaw_deg\n0.0,1.0,nan\n0.1,1.0,nan\n")
    assert load_session(path).device_yaw_deg is None


def test_a_misspelled_column_of_the_device_is_told(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("t_device_s,rate_dps,device_yaw_deg,device_bias_dsp\n0.0,1.0,2.0,0.0\n0.1,1.0,2.0,0.0\n")
    with pytest.raises(Exception, match="device_bias_dps"):
        load_session(path)


def test_parts_and_sessions_upside_down_keep_the_yaw() -> None:
    """A board upside down turns the other way; the sigma has no sign."""
    session = session_of("a", samples(50))
    part = session.part(10, 20).upside_down()
    assert_array_equal(part.filled("device_yaw_deg"), -session.filled("device_yaw_deg")[10:20])
    assert_array_equal(part.filled("device_bias_dps"), -session.filled("device_bias_dps")[10:20])
    assert_array_equal(part.filled("device_yaw_sigma_deg"), session.filled("device_yaw_sigma_deg")[10:20])
    assert replace(session, device_yaw_deg=None).columns().keys() >= {"t_device_s"}
