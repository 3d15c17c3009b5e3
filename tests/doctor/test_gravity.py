"""Findings of `doctor` about an accelerometer, on motions made by scipy."""

from pathlib import Path

import numpy as np
import pytest
from doctor_support import assert_findings, doctor
from hand_motion import hand_motion

from gyrodrift.values.arrays import Floats


def board(**changed: Floats) -> dict[str, Floats]:
    """Columns of a sound board, some of them changed."""
    motion = hand_motion()
    columns = {"t_device_s": motion.t_s}
    for axis, name in enumerate("xyz"):
        columns |= {f"gyro_{name}_dps": motion.gyro_dps[:, axis], f"accel_{name}_mps2": motion.accel_mps2[:, axis]}
    columns |= changed
    return columns | {"rate_dps": columns["gyro_z_dps"]}


def written(path: Path, columns: dict[str, Floats]) -> Path:
    np.savetxt(path, np.column_stack(list(columns.values())), delimiter=",", header=",".join(columns), comments="")
    return path


def test_a_board_with_six_sound_axes_passes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _, findings = doctor(capsys, written(tmp_path / "board.csv", board()))

    assert_findings(
        findings,
        [
            ("gravity", "ok", "9.81 m/s², +z is up"),
            ("axes_agree", "ok", "both have the same axes"),
            ("accel_vibration", "ok", "0.0"),
            ("accel_range", "ok", "largest acceleration"),
        ],
    )


@pytest.mark.parametrize(
    ("factor", "unit"), [(1.0 / 9.81, "ax:g"), (1e3 / 9.81, "ax:mg"), (16384.0 / 9.81, "ax:lsb/16384")]
)
def test_accelerations_in_another_unit_are_told_with_the_columns_that_mend_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], factor: float, unit: str
) -> None:
    columns = board()
    for name in "xyz":
        columns[f"accel_{name}_mps2"] *= factor

    status, findings = doctor(capsys, written(tmp_path / "board.csv", columns))

    assert status == 3
    assert_findings(findings, [("gravity", "error", unit)])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda x, y, z: (x, -y, z), "ay is −ay"),
        (lambda x, y, z: (y, x, z), "ax is ay, ay is ax"),
        (lambda x, y, z: (y, -x, z), "ax is −ay, ay is ax"),
    ],
)
def test_an_accelerometer_with_other_axes_than_the_gyro_is_told_how_they_lie(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], change: object, words: str
) -> None:
    columns = board()
    x, y, z = change(*(columns[f"accel_{name}_mps2"] for name in "xyz"))  # type: ignore[operator]
    columns |= {"accel_x_mps2": x, "accel_y_mps2": y, "accel_z_mps2": z}

    status, findings = doctor(capsys, written(tmp_path / "board.csv", columns))

    assert status == 3
    assert_findings(findings, [("axes_agree", "error", words)])


def test_a_clipped_accelerometer_and_a_vibrating_one_are_warned_of(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    columns = board()
    rng = np.random.default_rng(2)
    for name in "xyz":
        shaken = columns[f"accel_{name}_mps2"] + rng.normal(0.0, 8.0, len(columns["t_device_s"]))
        columns[f"accel_{name}_mps2"] = np.clip(shaken, -19.6, 19.6)

    _, findings = doctor(capsys, written(tmp_path / "board.csv", columns))

    assert_findings(
        findings, [("accel_vibration", "warning", "the sensor shakes"), ("accel_range", "warning", "exactly 19.6")]
    )


def test_a_board_on_its_side_is_told_by_the_axis_that_points_up(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    columns = board()
    columns |= {
        "gyro_x_dps": columns["gyro_z_dps"], "gyro_z_dps": -columns["gyro_x_dps"], "rate_dps": -columns["gyro_x_dps"],
        "accel_x_mps2": columns["accel_z_mps2"], "accel_z_mps2": -columns["accel_x_mps2"],
    }  # fmt: skip

    _, findings = doctor(capsys, written(tmp_path / "board.csv", columns))

    assert_findings(findings, [("gravity", "ok", "+x is up"), ("axes_agree", "ok", "same axes")])


def test_a_device_of_one_axis_has_no_finding_about_gravity(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    columns = board()

    _, findings = doctor(
        capsys, written(tmp_path / "board.csv", {name: columns[name] for name in ("t_device_s", "rate_dps")})
    )

    assert not {"gravity", "axes_agree", "accel_vibration", "accel_range"} & findings.keys()
