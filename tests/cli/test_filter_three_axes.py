"""`gyrodrift filter` on sessions of three axes."""

import csv
from pathlib import Path

import numpy as np
import pytest
from hand_motion import COLUMNS, hand_motion

from gyrodrift.cli import main


def last_row(path: Path) -> dict[str, float]:
    with path.open() as file:
        *_, row = csv.DictReader(file)
    return {name: float(value) for name, value in row.items()}


def test_the_mount_of_the_config_holds_for_recordings(tmp_path: Path) -> None:
    session, config = hand_motion(20.0, tilt_deg=20.0).write(tmp_path / "hand.csv"), tmp_path / "mount.yaml"
    config.write_text("filter: restlevel\nmount: {up: +z, forward: -x}\n")
    plain, mounted = tmp_path / "plain.csv", tmp_path / "mounted.csv"
    assert main(["filter", str(session), "--out", str(plain), "--quiet"]) == 0
    assert main(["filter", str(session), "--config", str(config), "--out", str(mounted), "--quiet"]) == 0
    plain_row, mounted_row = last_row(plain), last_row(mounted)
    assert abs(plain_row["roll_deg"]) + abs(plain_row["pitch_deg"]) > 5.0
    assert mounted_row["roll_deg"] == pytest.approx(-plain_row["roll_deg"], abs=0.05)
    assert mounted_row["pitch_deg"] == pytest.approx(-plain_row["pitch_deg"], abs=0.05)


def test_samples_without_axes_are_those_of_one_axis(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A recording goes on if a device with one axis is plugged in: `serve` takes its samples, too."""
    motion = hand_motion(20.0)
    table = np.column_stack([motion.t_s, motion.gyro_dps[:, 2], motion.heading_deg, motion.gyro_dps, motion.accel_mps2])
    table[1000:, 3:] = np.nan
    session, out = tmp_path / "both.csv", tmp_path / "out.csv"
    np.savetxt(session, table, delimiter=",", fmt="%.9g", header=",".join(COLUMNS), comments="")
    assert main(["filter", str(session), "--out", str(out)]) == 0
    messages = capsys.readouterr().err
    assert "skipped" not in messages
    assert "2,000 samples" in messages
    assert np.isnan(last_row(out)["roll_deg"])
