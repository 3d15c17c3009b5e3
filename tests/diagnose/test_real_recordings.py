"""Recordings of real sensors, each with one thing about it that is known."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from recordings_support import Recordings
from support import beginning

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import Moments
from firmware_sim.effects.link import UsbBatching
from gyrodrift.cli import main
from gyrodrift.diagnose import diagnosis
from gyrodrift.diagnose.what_next import Next
from gyrodrift.session.files import load_session
from gyrodrift.values.arrays import Floats

pytestmark = [pytest.mark.long, pytest.mark.timeout(1800)]


@pytest.fixture(autouse=True)
def without_next_recording(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(diagnosis, "what_next", lambda *_: Next("", None))


def diagnosed(paths: list[Path], base: dict[str, float], folder: Path, *options: str) -> dict[str, Any]:
    """The verdict beside a rig of these facts."""
    rig = folder / "rig.yaml"
    usual = {"noise_dps_rthz": 0.005, "bias_dps": 0.5, "encoder_cpr": 36000, "host_delay_s": 0.002}
    rig.write_text(yaml.safe_dump({"base": usual | base, "effects": []}))
    words = ["diagnose", *map(str, paths), "--rig", str(rig), "--out", str(folder / "out"), "--jobs", "1", *options]
    assert main(words) == 0
    result: dict[str, Any] = json.loads((folder / "out" / "gap.json").read_text())
    return result


def only(*kept: str) -> tuple[str, ...]:
    """Options that leave these effects: quicker, where it is not the choice among all that is tested."""
    return tuple(word for name in CATALOGUE if name not in kept for word in ("--withhold", name))


def test_a_bias_that_follows_the_temperature_with_hysteresis(tmp_path: Path, recordings: Recordings) -> None:
    tried = ("temp_bias", "scale_factor", "clock_drift")
    base = {"sample_rate_hz": 2.0, "dps_per_lsb": 250.0 / 32768.0}
    gap = diagnosed([recordings.path("temperature_sweep")], base, tmp_path, *only(*tried))
    assert gap["verdict"] in {"partly", "unknown"}
    assert gap["leftover"]
    assert gap["untestable"]["scale_factor"] == "no motion"
    assert gap["untestable"]["clock_drift"] == "no host times"


def bunch_distance_s(arrived_s: Floats) -> float:
    """Mean distance of bunches: samples of a bunch are less than half a period of 10 ms apart."""
    return float(np.diff(arrived_s[1:][np.diff(arrived_s) > 0.005]).mean())


OF_TIMES = only("usb_batching", "timestamp_jitter", "clock_drift")


@pytest.mark.parametrize("withheld", [OF_TIMES, pytest.param((), marks=pytest.mark.evaluation)], ids=["few", "all"])
def test_arrivals_in_bunches(tmp_path: Path, recordings: Recordings, withheld: tuple[str, ...]) -> None:
    still = beginning(recordings.path("mpu6050_still"), 40_000, tmp_path)
    gap = diagnosed([still], {"sample_rate_hz": 100.0, "dps_per_lsb": 250.0 / 32768.0}, tmp_path, *withheld)
    (batching,) = (cause for cause in gap["causes"] if cause["effect"] == "usb_batching")
    assert batching["probability"] > 0.8
    fitted = UsbBatching(**{name: stated["value"] for name, stated in batching["parameters"].items()})
    session = load_session(still)
    assert session.t_host_s is not None
    empty = np.zeros(0)
    moments = Moments(empty, empty, empty, empty, empty, 0.01)
    waited_s = fitted.begin(np.random.default_rng(1), 100.0)(session.t_device_s, moments)
    assert bunch_distance_s(waited_s) == pytest.approx(bunch_distance_s(session.t_host_s), rel=0.1)
    stages = [deviation["stage"] for deviation in gap["where"][:2]]
    assert sorted(stages) == ["clock", "link"]  # its arrivals also change their pace


@pytest.mark.evaluation
def test_motion_in_three_axes_is_no_effect_of_one(tmp_path: Path, recordings: Recordings) -> None:
    paths = [beginning(recordings.path(f"broad_{number}"), 20_000, tmp_path) for number in ("01", "14")]
    gap = diagnosed(paths, {"sample_rate_hz": 285.7, "dps_per_lsb": 0.061, "encoder_cpr": 3600000}, tmp_path)
    assert gap["verdict"] in {"partly", "unknown"}
    assert gap["leftover"]
    assert gap["gap"]["shrink"] is None or gap["gap"]["shrink"] < 0.75  # cameras and gyros are 4 ms apart, too
    assert len(gap["leftover"]) > 5


def test_a_rig_that_cannot_hold_the_rates_is_told_of(
    tmp_path: Path, recordings: Recordings, capsys: pytest.CaptureFixture[str]
) -> None:
    base = {"sample_rate_hz": 2.0, "dps_per_lsb": 1e-5}
    diagnosed([recordings.path("temperature_sweep")], base, tmp_path, *only())
    assert "is the rig's dps_per_lsb right?" in capsys.readouterr().out
