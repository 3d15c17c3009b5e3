"""Real recordings through the whole serial path: replay → pty → serve, against `filter` on the same file.

What the filter makes of them is printed (pytest -s), not asserted: they are other sensors at other sample rates
than its published parameters were found for.
"""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from recordings_support import Recordings
from support import Command

from gyrodrift.cli import main
from gyrodrift.evaluation.integration import trapezium
from gyrodrift.session.files import load_session

RECORDINGS = (
    "broad_01",
    "mpu6050_still",
    "temperature_sweep",
    *(pytest.param(name, marks=pytest.mark.evaluation) for name in ("broad_06", "broad_14")),
)


def yaw_of_filter(session: Path, out: Path) -> list[float]:
    assert main(["filter", str(session), "--filter", "hdr", "--out", str(out)]) == 0
    with out.open() as file:
        return [float(row["yaw_deg"]) for row in csv.DictReader(file)]


@pytest.mark.parametrize("name", RECORDINGS)
def test_a_real_recording_comes_out_of_serve_as_it_comes_out_of_filter(
    name: str, tmp_path: Path, recordings: Recordings
) -> None:
    """Every sample arrives, with the same yaw to the last digit that serve writes."""
    path, link, out = recordings.path(name), tmp_path / "gyro", tmp_path / "lines.json"
    session, expected = load_session(path), yaw_of_filter(path, tmp_path / "out.csv")
    with Command("replay", path, "--link", link, "--speed", "max") as replay:
        replay.until_log("waiting for a reader")
        with Command("serve", "--port", link, "--filter", "hdr", out_file=out) as serve:
            serve.until_log("event=link_lost")
            assert serve.stop() == 0
    lines = [json.loads(line) for line in out.read_text().splitlines()]
    assert len(expected) == len(session.t_device_s)
    assert [line["t_s"] for line in lines] == session.t_device_s.round(6).tolist()
    assert [line["yaw_deg"] for line in lines] == [round(yaw_deg, 4) for yaw_deg in expected]
    assert session.encoder_deg is not None
    true_deg = session.encoder_deg - session.encoder_deg[0]
    steps_s = np.diff(session.t_device_s, prepend=session.t_device_s[0])
    plain_deg = trapezium(steps_s, session.rate_dps)
    plain, hdr = (float(np.mean(np.abs(yaw - true_deg))) for yaw in (plain_deg, np.array(expected)))
    print(f"\n{name:18} mean |yaw error|, deg: Euler {plain:8.2f}   HDR, published parameters {hdr:8.2f}")
