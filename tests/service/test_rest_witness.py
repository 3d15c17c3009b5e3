"""A witness of rest at a running service: its word reaches filter and recording, and a lie is told."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from outputs_support import serving
from support import Command, never

from gyrodrift.session.files import load_session

RATE_HZ = 100


def lines(first: int, rates_dps: list[float], still: int | None = None) -> bytes:
    """The csv protocol at 100 Hz."""
    statement = "" if still is None else f",nan,25.0,{still}"
    rows = (f"{(first + n) * 10_000},{rate:.4f}{statement}\n" for n, rate in enumerate(rates_dps))
    return "".join(rows).encode()


def noisy(true_dps: np.ndarray[tuple[int], np.dtype[np.float64]], seed: int = 1) -> list[float]:
    result: list[float] = (true_dps + 0.4 + np.random.default_rng(seed).normal(0.0, 0.05, len(true_dps))).tolist()
    return result


def ctl(path: Path, *words: str) -> dict[str, object]:
    with Command("ctl", path, *words) as command:
        command.end()
    answer: dict[str, object] = json.loads(command.out)
    return answer


def test_what_ctl_says_of_rest_beats_statistics_and_is_recorded(port: Path, tmp_path: Path) -> None:
    """A rest too short to be found, behind motion from the first sample on; `filter` gives the same bits."""
    control, folder = tmp_path / "control", tmp_path / "r"
    moving = noisy(40.0 * np.sin(np.arange(400) / 40.0))
    with serving(port, "--control", control, "--record", folder) as (serve, device):
        device.send_all(lines(0, moving), never)
        serve.take_lines(400)
        assert ctl(control, "rest", "1") == {"ok": True, "still": 1.0, "is_believed": True}
        device.send_all(lines(400, noisy(np.zeros(90))), never)
        result = serve.take_lines(90)[-1]
        status = ctl(control, "status")["filter"]
        assert ctl(control, "rest", "auto") == {"ok": True, "still": None, "is_believed": True}
        device.send_all(lines(490, moving[:60]), never)
        last = serve.take_lines(60)[-1]
        assert serve.stop() == 0
    assert result["bias_dps"] == pytest.approx(0.4, abs=0.05)
    assert result["rest_probability"] == 1.0
    assert isinstance(status, dict)
    assert (status["still"], status["is_witness_believed"]) == (1.0, True)
    (recorded,) = folder.glob("*.mcap")
    still = load_session(recorded).still
    assert still is not None
    assert np.flatnonzero(still == 1.0).tolist() == list(range(400, 490))
    with Command("filter", recorded) as filtered:
        assert filtered.end() == 0
    *_, row = csv.DictReader(filtered.out.splitlines())
    assert float(row["yaw_deg"]) == pytest.approx(last["yaw_deg"], abs=1e-4)


def test_a_device_whose_word_is_stuck_is_told_of(port: Path, tmp_path: Path) -> None:
    control = tmp_path / "control"
    with serving(port, "--control", control) as (serve, device):
        device.send_all(lines(0, noisy(np.zeros(500)), still=1), never)
        device.send_all(lines(500, noisy(30.0 * np.sin(np.arange(300) / 100.0)), still=1), never)
        last = serve.take_lines(800)[-1]
        serve.until_log('"event": "witness_refuted"')
        status = ctl(control, "status")["filter"]
        serve.stop()
    assert isinstance(status, dict)
    assert (status["still"], status["is_witness_believed"]) == (1.0, False)
    assert last["yaw_deg"] == pytest.approx(59.7, abs=1.0)
