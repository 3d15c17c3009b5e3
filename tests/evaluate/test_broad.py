"""The BROAD protocol on trials of its form, made by scipy: known errors come out as they were put in."""

import json
from pathlib import Path

import numpy as np
import pytest
from evaluate.broad import Trial, load_trial, main, trial_errors
from hand_motion import RATE_HZ, hand_motion
from scipy.io import savemat
from scipy.spatial.transform import Rotation

from gyrodrift.values.arrays import Floats


def trial(count: int = 2000) -> Trial:
    rng = np.random.default_rng(1)
    reference = Rotation.random(count, rng=rng).as_quat(scalar_first=True)
    is_moving = np.arange(count) >= 500
    zeros = np.zeros((count, 3))
    return Trial("01_undisturbed", np.arange(count) / RATE_HZ, zeros, zeros, reference, is_moving)


def rotated(moved: Trial, rotation: Rotation) -> Floats:
    product = rotation * Rotation.from_quat(moved.reference, scalar_first=True)
    return np.asarray(product.as_quat(scalar_first=True), dtype=np.float64)


def test_a_constant_heading_offset_is_no_error_and_a_later_one_is() -> None:
    moved = trial()
    heading_deg = np.where(moved.is_moving, 33.0, 30.0)[:, np.newaxis]
    errors = trial_errors(rotated(moved, Rotation.from_euler("z", heading_deg, degrees=True)), moved)
    assert (errors.heading_deg, errors.inclination_deg) == pytest.approx((3.0, 0.0), abs=1e-6)


def test_a_tilt_is_an_error_of_the_inclination_alone() -> None:
    moved = trial()
    tilt_deg = np.where(moved.is_moving, 2.0, 0.0)[:, np.newaxis]
    errors = trial_errors(rotated(moved, Rotation.from_euler("x", tilt_deg, degrees=True)), moved)
    assert (errors.heading_deg, errors.inclination_deg) == pytest.approx((0.0, 2.0), abs=1e-6)


def test_samples_without_a_reference_are_left_out() -> None:
    moved = trial()
    estimate = rotated(moved, Rotation.identity())
    moved.reference[600:700] = np.nan
    assert trial_errors(estimate, moved).heading_deg == pytest.approx(0.0, abs=1e-6)


def test_the_command_prints_filters_and_published_means(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("vqf", reason="the comparison needs its package")
    (tmp_path / "data_mat").mkdir()
    motion = hand_motion(30.0)
    angles = np.zeros((len(motion.t_s), 3))
    attitude = Rotation.from_euler("ZYX", angles, degrees=True).as_quat(scalar_first=True)
    fields = {
        "imu_gyr": np.deg2rad(motion.gyro_dps),
        "imu_acc": motion.accel_mps2,
        "opt_quat": attitude,
        "movement": (motion.t_s > 5.0)[:, np.newaxis],
        "sampling_rate": RATE_HZ,
    }
    savemat(tmp_path / "data_mat" / "01_undisturbed_slow.mat", fields)
    results = tmp_path / "example_code" / "out"
    results.mkdir(parents=True)
    mean = {"tagp_parameters": {"heading_rmse_deg": 3.36, "inclination_rmse_deg": 2.44}}
    groups = dict.fromkeys(("all_trials", "undisturbed", "disturbed"), mean)
    (results / "results_madgwick_average_rmse.json").write_text(json.dumps({"groups": groups}))
    assert main([str(tmp_path)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("1 trials")
    assert [line.split()[0] for line in lines[1:]] == ["gyrodrift"] * 2 + ["VQF,"] * 2 + ["madgwick,"] * 3
    assert load_trial(tmp_path / "data_mat" / "01_undisturbed_slow.mat").is_moving.sum() == np.sum(motion.t_s > 5.0)


def test_a_folder_without_the_data_is_told(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main([str(tmp_path)]) == 2
    assert "expected a folder with data_mat" in capsys.readouterr().err
