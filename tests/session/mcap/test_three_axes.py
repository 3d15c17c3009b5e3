"""Sessions of devices with three axes: every column is kept by writing, reading, repair and conversion."""

import io
from dataclasses import replace
from math import nan
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from gyrodrift.session.files import load_session, write_session
from gyrodrift.session.foreign.export import write_imu, write_json
from gyrodrift.session.mcap.layout import LAYOUTS
from gyrodrift.session.mcap.read import add_chunk, read_mcap
from gyrodrift.session.mcap.repair import repair
from gyrodrift.session.mcap.write import McapWriter
from gyrodrift.session.session import AXIS_COLUMNS, Session, session_of
from gyrodrift.values.sample import Inertial, Sample

AXES = LAYOUTS[True, False, True].values
METADATA = {"device": {"device_id": "bench"}}


def turning(count: int) -> list[Sample]:
    """Samples with axes; every fifth has no acceleration."""
    samples = []
    for i in range(count):
        rate_dps = 0.5 * i
        forces_mps2 = (nan, nan, nan) if i % 5 == 4 else (0.1 * i, -0.2, 9.81)
        inertial = Inertial(-0.25 * i, 1.5, rate_dps, *forces_mps2)
        samples.append(Sample(i, i / 100, 1.7e9 + i / 100, rate_dps, 0.1 * i, 25.0, nan, inertial))
    return samples


def recorded(samples: list[Sample], *, is_finished: bool = True, flushed_after: int | None = None) -> bytes:
    stream = io.BytesIO()
    writer = McapWriter(stream, METADATA, has_axes=True)
    writer.add_all(samples[:flushed_after])
    writer.flush()
    if flushed_after is not None:
        writer.add_all(samples[flushed_after:])
        writer.flush()
    if is_finished:
        writer.finish()
    return stream.getvalue()


def assert_same_axes(session: Session, samples: list[Sample]) -> None:
    expected = session_of("expected", samples)
    assert np.array_equal(session.rate_dps, expected.rate_dps)
    for name in AXIS_COLUMNS:
        assert np.array_equal(session.filled(name), expected.filled(name), equal_nan=True), name


def test_axes_are_read_with_the_same_bits(tmp_path: Path) -> None:
    path = tmp_path / "s.mcap"
    path.write_bytes(recorded(turning(500)))
    assert_same_axes(read_mcap(path), turning(500))


def test_a_sample_without_axes_in_a_file_with_axes_has_missing_values(tmp_path: Path) -> None:
    samples = turning(3)
    samples[1] = samples[1]._replace(inertial=None)
    path = tmp_path / "s.mcap"
    path.write_bytes(recorded(samples))
    session = read_mcap(path)
    assert session.gyro_dps is not None
    assert np.isnan(session.gyro_dps[1]).all()
    assert session.gyro_dps[2].tolist() == [-0.5, 1.5, 1.0]


def test_chunks_of_arrays_and_single_samples_make_the_same_file() -> None:
    samples = turning(4000)
    stream, session = io.BytesIO(), session_of("s", samples)
    writer = McapWriter(stream, METADATA, has_axes=True)
    for rows in (slice(0, 2000), slice(2000, 4000)):
        add_chunk(writer, session.rows(rows))
    writer.finish()
    assert stream.getvalue() == recorded(samples, flushed_after=2000)


def test_public_readers_decode_all_axes_by_our_schema() -> None:
    reader = make_reader(io.BytesIO(recorded(turning(50))), validate_crcs=True, decoder_factories=[DecoderFactory()])
    decoded = [message for _, _, _, message in reader.iter_decoded_messages(topics=["/gyro"])]
    assert [(m.gyro_x_dps, m.gyro_z_dps, m.accel_z_mps2) for m in decoded[:4]] == [
        (-0.25 * i, 0.5 * i, 9.81) for i in range(4)
    ]


def test_an_interrupted_file_loads_and_is_repaired_with_its_axes(tmp_path: Path) -> None:
    path, samples = tmp_path / "s.mcap", turning(4000)
    content = recorded(samples, is_finished=False, flushed_after=3000)
    path.write_bytes(content[: content.index(AXES.pack(*_packed(samples[3990]))[:60]) + 90])
    assert_same_axes(read_mcap(path), samples[:3990])
    repaired = repair(path)
    assert repaired is not None
    assert repaired.samples == 3990
    assert repaired.damage is None
    assert_same_axes(read_mcap(path), samples[:3990])


def test_damage_costs_a_sample_and_the_rest_keeps_its_axes(tmp_path: Path) -> None:
    path, samples = tmp_path / "s.mcap", turning(4000)
    content = bytearray(recorded(samples))
    content[len(content) // 2] ^= 0xFF
    path.write_bytes(content)
    damaged = read_mcap(path, allow_damage=True)
    assert damaged.damage is not None
    assert len(damaged.rate_dps) == 3999
    assert repair(path) is not None
    assert_same_axes(read_mcap(path), [samples[round(t_s * 100)] for t_s in damaged.t_device_s])


def _packed(sample: Sample) -> tuple[float | int, ...]:
    log_ns, device_ns = int(sample.t_host_s * 1e9), int(sample.t_device_s * 1e9)
    assert sample.inertial is not None
    head = (5, AXES.size + 4 - 9, 1, sample.seq, log_ns, device_ns, 0x100)
    return (*head, *sample[:6], *sample.inertial)


@pytest.mark.parametrize("ending", [".csv", ".mcap"])
def test_a_file_keeps_the_axes(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"s{ending}"
    write_session(path, [session_of("s", turning(100))])
    assert_same_axes(load_session(path), turning(100))


def test_a_session_without_axes_makes_the_same_files_as_before(tmp_path: Path) -> None:
    session = replace(session_of("s", turning(10)), gyro_dps=None, accel_mps2=None)
    write_session(tmp_path / "s.csv", [session])
    assert (tmp_path / "s.csv").read_text().splitlines()[0] == "t_device_s,t_host_s,seq,rate_dps,encoder_deg,temp_c"
    write_session(tmp_path / "s.mcap", [session])
    assert b"gyro_x_dps" not in (tmp_path / "s.mcap").read_bytes()
    assert load_session(tmp_path / "s.mcap").gyro_dps is None


def test_imu_messages_carry_all_axes(tmp_path: Path) -> None:
    path = tmp_path / "imu.mcap"
    write_imu(path, [session_of("s", turning(20))])
    session = load_session(path)
    assert session.gyro_dps is not None
    assert session.accel_mps2 is not None
    assert session.gyro_dps[3] == pytest.approx([-0.75, 1.5, 1.5])
    assert session.accel_mps2[3] == pytest.approx([0.3, -0.2, 9.81])
    assert np.isnan(session.accel_mps2[4]).all()


def test_json_messages_carry_all_axes(tmp_path: Path) -> None:
    path = tmp_path / "json.mcap"
    write_json(path, [session_of("s", turning(20))])
    assert_same_axes(load_session(path), turning(20))


def test_a_single_axis_in_imu_messages_stays_one(tmp_path: Path) -> None:
    """Zeros about x and y and no acceleration are no axes."""
    path = tmp_path / "imu.mcap"
    write_imu(path, [replace(session_of("s", turning(20)), gyro_dps=None, accel_mps2=None)])
    assert load_session(path).gyro_dps is None
