"""The MicroPython program in MicroPython: golden frames, any fields, and a whole run with an MPU-6050."""

import importlib.util
import json
from math import isnan, nan
from pathlib import Path
from random import Random
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from firmware_support import MICROPYTHON, compiled, in_micropython, run, same_sensor
from golden_frames import AXES_FILTER_HELLO, AXES_HELLO, AXES_SAMPLES, FILTER_HELLO, HELLO, SAMPLES, YAWS
from support import Command, never, speaking_on

from firmware_sim.wire.native import axes_sample_frame, sample_frame
from gyrodrift.firmware.micropython import restlevel_py
from gyrodrift.link.protocols.native import NativeDecoder
from gyrodrift.values.sample import Reading

SECONDS = 6.0
BOARD = {"seconds": SECONDS, "absent": 0.0, "pin": True, "up": [2, False], "filter": ""}


def played(folder: Path, **board: Any) -> tuple[bytes, list[list[int]]]:
    (folder / "gyrodrift_restlevel.py").write_text(restlevel_py())
    modules = [folder / "gyrodrift_restlevel.py"]
    stream, _, truth = in_micropython("play_board.py", BOARD | board, folder, *modules).rpartition(b"\n")
    return stream, json.loads(truth)


def read_back(stream: bytes) -> tuple[NativeDecoder, list[Reading]]:
    decoder = NativeDecoder()
    return decoder, decoder.push(stream)


def _sensors() -> ModuleType:
    spec = importlib.util.spec_from_file_location("gyro_sensors", MICROPYTHON / "gyro_sensors.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_frames_are_the_golden_ones(tmp_path: Path) -> None:
    """HELLO and each sample of the table, byte for byte."""
    hello = ["hello", [100, 0.00763, 36000, "firmware_sim"]]
    samples = [["sample", list(sample)] for sample in SAMPLES]
    assert in_micropython("write_frames.py", [hello, *samples], tmp_path) == HELLO + b"".join(SAMPLES.values())
    hello3 = ["hello3", [100, 0.00763, 36000, "firmware_sim", 0.0047884]]
    samples3 = [["sample3", [s.flags, s.seq, s.t_us, [*s.gyro_raw, *s.accel_raw], *s[5:]]] for s in AXES_SAMPLES]
    expected = AXES_HELLO + b"".join(AXES_SAMPLES.values())
    assert in_micropython("write_frames.py", [hello3, *samples3], tmp_path) == expected


def test_frames_of_a_filter_are_the_golden_ones(tmp_path: Path) -> None:
    """HELLO with one axis and with three, and each yaw of the table."""
    device = [100, 0.00763, 36000, "firmware_sim"]
    hellos = [["hello_filter", [*device, 1, 0.0, 2]], ["hello_filter", [*device, 3, 0.0047884, 3]]]
    yaws = [["yaw", [None if isnan(value) else value for value in yaw]] for yaw in YAWS]
    expected = FILTER_HELLO + AXES_FILTER_HELLO + b"".join(YAWS.values())
    assert in_micropython("write_frames.py", [*hellos, *yaws], tmp_path) == expected


def test_any_sample_has_the_bytes_of_the_simulated_device(tmp_path: Path) -> None:
    random = Random(7)
    ends = [(0, 255), (0, 65535), (0, 2**32 - 1), (-32768, 32767), (-32768, 32767), (-(2**31), 2**31 - 1)]
    request = [[random.choice([*end, random.randint(*end)]) for end in ends] for _ in range(400)]
    sent = in_micropython("write_frames.py", [["sample", fields] for fields in request], tmp_path)
    assert sent == b"".join(sample_frame(*fields) for fields in request)
    axes = [[random.choice([-32768, 32767, random.randint(-32768, 32767)]) for _ in range(6)] for _ in request]
    rows = list(zip(request, axes, strict=True))
    asked3 = [["sample3", [flags, seq, t_us, values, temp, n]] for (flags, seq, t_us, _, temp, n), values in rows]
    expected = [
        axes_sample_frame(flags, seq, t_us, values[:3], values[3:], temp, n)
        for (flags, seq, t_us, _, temp, n), values in rows
    ]
    assert in_micropython("write_frames.py", asked3, tmp_path) == b"".join(expected)


def test_a_long_name_is_cut(tmp_path: Path) -> None:
    decoder, _ = read_back(in_micropython("write_frames.py", [["hello", [1, 1.0, 0, "x" * 40]]], tmp_path))
    assert decoder.device.device_id == "x" * 16


def test_serve_reads_every_sample(tmp_path: Path, port: Path) -> None:
    stream, truth = played(tmp_path)
    with speaking_on(port) as device, Command("serve", "--port", port) as serve:
        device.wait_for_reader(never)
        device.send_all(stream, never)
        lines = serve.take_lines(len(truth) - 1)
        assert 'device_id="MPU-6050 250/42"' in serve.log
    t_us, rates, temps, *_ = np.array(truth[: len(lines)]).T
    assert len(lines) > 1100
    assert [line["seq"] for line in lines] == list(range(1, len(lines) + 1))
    assert [round(line["rate_dps"] * 131) for line in lines] == rates.tolist()
    assert np.abs([line["temp_c"] for line in lines] - (temps / 340 + 36.53)).max() <= 0.0101
    assert np.ptp([line["t_s"] * 1e6 for line in lines] - t_us) < 1.0


def test_every_axis_is_sent(tmp_path: Path) -> None:
    """Rates and accelerations, with their scales."""
    stream, truth = played(tmp_path, seconds=2.0)
    _, readings = read_back(stream)
    assert len(readings) > 300
    for reading, (_, rate, _, *accels) in zip(readings, truth, strict=False):
        assert reading.inertial is not None
        assert [round(dps * 131) for dps in reading.inertial[:3]] == [111, -222, rate]
        assert [round(force / 9.80665 * 4096) for force in reading.inertial[3:]] == accels


@pytest.mark.parametrize(
    ("name", "file", "kind"), [("hdr", "gyrodrift_hdr.py", "Hdr"), ("restlevel", "gyrodrift_restlevel.py", "Restlevel")]
)
def test_the_board_may_send_its_own_yaw(
    name: str, file: str, kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stream, _ = played(tmp_path, seconds=3.0, filter=name)
    decoder, readings = read_back(stream)
    assert decoder.device.device_filter == name
    assert len(readings) > 300
    monkeypatch.setattr("time.ticks_diff", lambda end, start: end - start, raising=False)
    names: dict[str, Any] = {}
    exec(((tmp_path if name == "restlevel" else MICROPYTHON) / file).read_text(), names)
    reference = names[kind]()
    for reading in readings:
        assert reading.device_yaw is not None
        assert reference.update_us(reading.t_us, reading.rate_dps)
        sigma_deg = reference.yaw_sigma_deg if name == "restlevel" else nan
        expected = (reference.yaw_deg, sigma_deg, reference.bias_dps)
        assert reading.device_yaw == pytest.approx(expected, rel=1e-4, abs=1e-3, nan_ok=True)


@pytest.mark.parametrize(
    ("up", "slots", "signs"),
    [([0, False], [1, 2, 0], [1, 1, 1]), ([1, True], [2, 0, 1], [1, -1, -1]), ([2, True], [0, 1, 2], [1, -1, -1])],
)
def test_another_axis_may_point_up_or_down(
    up: list[object], slots: list[int], signs: list[int], tmp_path: Path
) -> None:
    stream, truth = played(tmp_path, seconds=1.0, up=up)
    _, readings = read_back(stream)
    assert len(readings) > 100
    assert np.linalg.det(np.eye(3)[slots] * np.array(signs)[:, None]) == pytest.approx(1.0)
    for reading, (_, _, _, *accels) in zip(readings, truth, strict=False):
        assert reading.inertial is not None
        sent = [round(force / 9.80665 * 4096) for force in reading.inertial[3:]]
        assert sent == [sign * accels[slot] for slot, sign in zip(slots, signs, strict=True)]


def test_samples_take_no_memory(tmp_path: Path) -> None:
    assert in_micropython("count_memory.py", None, tmp_path) == b"1001 0"


@pytest.mark.parametrize(("board", "name"), [({"absent": 9.0}, "no gyro on I2C"), ({"pin": False}, "INT pin is quiet")])
def test_what_is_not_wired_is_told(tmp_path: Path, board: dict[str, Any], name: str) -> None:
    decoder, readings = read_back(played(tmp_path, seconds=2.5, **board)[0])
    assert (decoder.device.device_id, readings, decoder.counters.before_hello) == (name, [], 0)


def test_a_gyro_that_is_plugged_in_late_is_found(tmp_path: Path) -> None:
    stream, truth = played(tmp_path, seconds=3.0, absent=1.5)
    decoder, readings = read_back(stream)
    assert decoder.device.device_id == "MPU-6050 250/42"
    assert [round(reading.rate_dps * 131) for reading in readings] == [row[1] for row in truth[: len(readings)]]
    assert len(readings) >= len(truth) - 1 > 200


def test_the_records_of_sensors_are_those_of_the_sketch(tmp_path: Path) -> None:
    records = [json.loads(line) for line in run(compiled("sensor_records.c", tmp_path)).splitlines()]
    sensors = _sensors().SENSORS
    assert len(records) == len(sensors)
    for record, sensor in zip(records, sensors, strict=True):
        assert same_sensor(record, sensor)
        assert len(sensor.id) <= 16
