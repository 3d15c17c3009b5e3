"""Heading error of the attitude filter and of VQF on simulated motions of cheap parts, and the time of a sample."""

import time
from pathlib import Path

import numpy as np
import pytest
from attitude_support import filtered, remembering
from c_filter_support import write_header
from firmware_support import run
from scipy.spatial.transform import Rotation
from six_axis_motions import MOTIONS
from six_axis_sensors import Recorded
from six_axis_support import heading_errors_deg, inclination_errors_deg, record

from bench.harness import show
from gyrodrift.filters.attitude.model import AttitudeState, coefficients
from gyrodrift.filters.attitude.step import step
from gyrodrift.filters.restlevel.model import RestlevelParams
from gyrodrift.values.arrays import Floats

SEEDS = range(400, 410)


def vqf(recorded: Recorded) -> Floats:
    """Attitudes (n, 4) of VQF with six axes."""
    package = pytest.importorskip("vqf", reason="VQF has no wheel here")
    period_s = float(np.median(np.diff(recorded.t_s)))
    gyro, accel = np.radians(recorded.gyro_dps), np.ascontiguousarray(recorded.accel_mps2)
    return np.asarray(package.VQF(period_s).updateBatch(gyro, accel)["quat6D"])


@pytest.mark.parametrize("name", list(MOTIONS))
def test_heading_errors(name: str) -> None:
    """Mean |heading error| of each recording; share of samples within two sigma; inclination."""
    ours, theirs, within, tilts = [], [], [], []
    for seed in SEEDS:
        recorded = record(name, seed)
        estimate = filtered(recorded)
        errors = np.abs(heading_errors_deg(estimate.q, recorded.attitude))
        ours.append(errors.mean())
        within.append(np.mean(errors <= 2.0 * estimate.yaw_sigma_deg))
        tilts.append(np.median(inclination_errors_deg(estimate.q, recorded.attitude)))
        theirs.append(np.abs(heading_errors_deg(vqf(recorded), recorded.attitude)).mean())
    rows = (
        ("gyrodrift, median / mean, deg", f"{np.median(ours):.2f} / {np.mean(ours):.2f}"),
        ("VQF", f"{np.median(theirs):.2f} / {np.mean(theirs):.2f}"),
        ("within two sigma", f"{np.mean(within):.2f}"),
        ("inclination, deg", f"{np.median(tilts):.2f}"),
    )
    show(name, rows)


def from_the_first_motion(recorded: Recorded) -> Recorded:
    """The recording without its rest at the start."""
    first = int((np.abs(recorded.gyro_dps - recorded.bias_dps).max(axis=1) > 10.0).argmax())
    return Recorded(*(column[first:] for column in recorded))


@pytest.mark.parametrize("name", ["arm", "hand_slow", "hand_fast", "limb", "stick", "drone", "car_without_stops"])
def test_memory(name: str) -> None:
    """Mean |heading error| of starts in motion, without a memory, with a right one and with that of another part."""
    rows: dict[str, list[float]] = {}
    for seed in SEEDS[:4]:
        recorded = from_the_first_motion(record(name, seed, 45.0))
        bias_dps, rng = recorded.bias_dps[0], np.random.default_rng(seed)
        states = {
            "none": None,
            "right, 5 s old": remembering(bias_dps, (0.01,) * 3, 5.0),
            "an hour old, each axis off by 0.05": remembering(bias_dps + rng.normal(0.0, 0.05, 3), (0.01,) * 3, 3600.0),
            "wrong by 1 in each axis": remembering(bias_dps + 1.0, (0.01,) * 3, 3600.0),
            "wrong by 1 about z alone": remembering(bias_dps + np.array((0.0, 0.0, 1.0)), (0.01,) * 3, 3600.0),
        }
        for memory, state in states.items():
            errors = np.abs(heading_errors_deg(filtered(recorded, state).q, recorded.attitude))
            rows.setdefault(memory, []).append(float(errors.mean()))
    show(name, [(memory, f"{np.median(deg):.2f} / {np.mean(deg):.2f}") for memory, deg in rows.items()])


def after_a_rest(recorded: Recorded, rng: np.random.Generator) -> Recorded:
    """The recording, which begins at rest, after a minute more of that rest."""
    period_s = float(np.median(np.diff(recorded.t_s)))
    count = round(60.0 / period_s)
    gyro_dps = recorded.gyro_dps[:20].mean(axis=0) + rng.normal(0.0, 0.05, (count, 3))
    accel_mps2 = recorded.accel_mps2[:20].mean(axis=0) + rng.normal(0.0, 0.03, (count, 3))
    return Recorded(
        np.concatenate((recorded.t_s[0] + period_s * np.arange(-count, 0), recorded.t_s)),
        np.concatenate((gyro_dps, recorded.gyro_dps)),
        np.concatenate((accel_mps2, recorded.accel_mps2)),
        Rotation.concatenate([recorded.attitude[0]] * count + [recorded.attitude]),
        np.concatenate((np.tile(recorded.bias_dps[0], (count, 1)), recorded.bias_dps)),
    )


@pytest.mark.parametrize("name", ["hand_slow", "limb"])
def test_temperature(name: str) -> None:
    """Mean |heading error| of a part that warms up by 5 °C in a rest of 60 s and by 10 °C in the motion after it."""
    rows: dict[str, list[float]] = {"without the temperature": [], "with it": []}
    for seed in SEEDS[:4]:
        rng = np.random.default_rng(seed)
        recorded = after_a_rest(record(name, seed, 120.0), rng)
        temp_c = 20.0 + (recorded.t_s - recorded.t_s[0]) / 12.0
        gyro_dps = recorded.gyro_dps + np.outer(temp_c - 20.0, rng.normal(0.0, 0.015, 3))
        for temps, errors_deg in zip((None, temp_c), rows.values(), strict=True):
            estimate = filtered(recorded._replace(gyro_dps=gyro_dps), temp_c=temps)
            errors_deg.append(float(np.abs(heading_errors_deg(estimate.q, recorded.attitude)).mean()))
    show(name, [(label, f"{np.median(deg):.2f} / {np.mean(deg):.2f}") for label, deg in rows.items()])


@pytest.mark.parametrize("rate_hz", [100, 1000])
def test_time_of_a_sample(rate_hz: int) -> None:
    """Processor time of a sample in motion, with the updates at the ends of blocks."""
    c, s, n = coefficients(RestlevelParams()), AttitudeState(), 20 * rate_hz
    t_s = np.arange(n) / rate_hz
    gyro = np.column_stack((40.0 * np.sin(2.0 * t_s), 30.0 * np.cos(1.3 * t_s), 60.0 * np.sin(0.7 * t_s)))
    rows = np.column_stack((t_s, gyro, np.tile((0.0, 0.0, 9.81), (n, 1)))).tolist()
    begun_s = time.process_time()
    for t, gx, gy, gz, ax, ay, az in rows:
        step(c, s, t, gx, gy, gz, ax, ay, az)
    sample_us = (time.process_time() - begun_s) / n * 1e6
    show(f"attitude filter at {rate_hz} Hz", (("µs a sample", f"{sample_us:.1f}"),))


@pytest.mark.parametrize("optimization", ["-O2", "-O3"])
@pytest.mark.parametrize("name", ["hand_slow", "car_with_stops"])
def test_time_of_a_sample_in_c_on_a_desk(tmp_path: Path, name: str, optimization: str) -> None:
    """Processor time of a sample of `gyrodrift.h` in float, and of VQF (C++, double) in the same run."""
    package = pytest.importorskip("vqf", reason="VQF has no wheel here")
    recorded = record(name, 3, 120.0)
    rows = np.column_stack((recorded.t_s, recorded.gyro_dps, recorded.accel_mps2))
    rows.tofile(tmp_path / "rows.bin")
    write_header(tmp_path)
    source, program = Path(__file__).parent / "attitude_time.c", tmp_path / "attitude_time"
    run("cc", "-std=c11", optimization, f"-I{tmp_path}", source, "-o", program, "-lm")
    ours_ns = float(run(program, tmp_path / "rows.bin", str(len(rows))))
    gyro, accel = np.radians(recorded.gyro_dps), np.ascontiguousarray(recorded.accel_mps2)
    theirs_ns = []
    for _ in range(5):
        filter_ = package.VQF(float(np.median(np.diff(recorded.t_s))))
        begun_s = time.process_time()
        filter_.updateBatch(gyro, accel)
        theirs_ns.append((time.process_time() - begun_s) / len(rows) * 1e9)
    ratio = ours_ns / min(theirs_ns)
    show(
        f"{name}, {optimization}",
        (("ns a sample", f"{ours_ns:.0f}"), ("VQF", f"{min(theirs_ns):.0f}"), ("ratio", f"{ratio:.2f}")),
    )
