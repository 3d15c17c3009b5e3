"""Heading error of the attitude filter and of VQF on simulated motions of cheap parts, and the time of a sample."""

import time
from pathlib import Path

import numpy as np
import pytest
from attitude_support import filtered
from c_filter_support import write_header
from firmware_support import run
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
