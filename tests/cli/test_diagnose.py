"""The command that explains the gap, from sessions and a rig to its files."""

import json
import re
import shutil
from contextlib import redirect_stdout
from dataclasses import replace
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from page_support import parsed, row, words

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import load_rig, parse_effect, with_effects
from gyrodrift.cli import main
from gyrodrift.session.files import load_session, write_session
from gyrodrift.simulation.sessions import write_sessions

pytestmark = [pytest.mark.xdist_group("diagnosis"), pytest.mark.usefixtures("diagnosis_kernels")]

MINUTES = 2.0


def only(*kept: str) -> tuple[str, ...]:
    """Options that leave these effects: quicker, where it is not the choice among all that is tested."""
    return tuple(word for name in CATALOGUE if name not in kept for word in ("--withhold", name))


FEW = only("scale_factor", "scale_asymmetry", "warmup", "popcorn", "timestamp_jitter")
REST = only("scale_asymmetry", "warmup", "popcorn", "timestamp_jitter")
ITEM = only("scale_factor")


def record(folder: Path, *effects: str, sessions: int = 3) -> Path:
    rig = with_effects(load_rig(None), [parse_effect(text) for text in effects])
    list(write_sessions(rig, load_profile("identify"), folder, 11, sessions, MINUTES, "csv"))
    (folder / "rig.yaml").unlink()
    return folder


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Sessions of the shipped rig."""
    return record(tmp_path_factory.mktemp("plain"))


@pytest.fixture(scope="module")
def scaled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Sessions of a gyro that reads 1.2 % too much."""
    return record(tmp_path_factory.mktemp("scaled"), "scale_factor:error_percent=1.2")


@pytest.fixture(scope="module")
def two(scaled: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two of the sessions that read too much, where a third adds nothing."""
    folder = tmp_path_factory.mktemp("two")
    for path in sorted(scaled.iterdir())[:2]:
        shutil.copy(path, folder)
    return folder


def diagnosed(sessions: Path, out: Path, *options: str) -> dict[str, Any]:
    assert main(["diagnose", str(sessions), "--out", str(out), "--jobs", "1", *options]) == 0
    result: dict[str, Any] = json.loads((out / "gap.json").read_text())
    return result


@pytest.fixture(scope="module")
def exported(scaled: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any], str]:
    """Files, `gap.json` and output of a diagnosis with exports."""
    formats = [word for name in ("gazebo", "kalibr", "mujoco", "json") for word in ("--export", name)]
    out = tmp_path_factory.mktemp("exported")
    with redirect_stdout(StringIO()) as statement:
        gap = diagnosed(scaled, out, *formats, *FEW)
    return out, gap, statement.getvalue()


def charts(out: Path) -> list[str]:
    html = (out / "report.html").read_text()
    return ["".join(item.itertext()) for item in parsed(html).iter("div") if item.get("class") == "panel"]


def test_a_missing_effect_is_named_sized_and_closes_the_gap(exported: tuple[Path, dict[str, Any], str]) -> None:
    out, gap, statement = exported
    assert_is_the_scale_error(gap)
    assert re.match(r"effect: the rate reads [\d.]+ % too (high|low) \(scale_factor\)\n", statement)
    assert len(statement.splitlines()) <= 14
    again = with_effects(load_rig(out / "rig.yaml"), [])
    assert [effect.name for effect in again.effects] == ["scale_factor"]
    drawn = charts(out)
    assert all(any(shown in chart for chart in drawn) for shown in ("temperature", "angle within the turn", "rate:"))
    assert sum("session-0" in chart for chart in drawn) == 3


@pytest.mark.evaluation
def test_a_missing_effect_is_named_among_all(scaled: Path, tmp_path: Path) -> None:
    assert_is_the_scale_error(diagnosed(scaled, tmp_path / "out"))


def assert_is_the_scale_error(gap: dict[str, Any]) -> None:
    """One cause with its size, found by both models, that closes the gap."""
    assert gap["verdict"] == "effect"
    (cause,) = gap["causes"]
    assert (cause["effect"], cause["group"]) == ("scale_factor", "scale")
    size = cause["parameters"]["error_percent"]
    assert size["value"] == pytest.approx(1.2, rel=0.1)
    assert size["low"] <= size["value"] <= size["high"]
    assert size["unit"] == "%"
    assert cause["probability"] > 0.9
    assert gap["probability_of_no_gap"] + gap["probability_of_unknown"] < 0.1
    assert gap["posterior"][0]["effects"] == ["scale_factor"]
    assert gap["where"][0]["signature"] == "rate"
    assert gap["gap"]["shrink"] > 0.8
    assert gap["yaw"]["e_sim_after_deg"] == pytest.approx(gap["yaw"]["e_real_deg"], rel=0.3)


def test_effects_are_exported_for_other_simulators(exported: tuple[Path, dict[str, Any], str]) -> None:
    """Files, page and output say the same of them."""
    out, gap, statement = exported
    content = json.loads((out / "export" / "effects.json").read_text())
    (entry,) = content["effects"]
    size = gap["causes"][0]["parameters"]["error_percent"]
    assert entry["parameters"]["error_percent"] == size["value"]
    assert entry["intervals"]["error_percent"] == [size["low"], size["high"]]
    assert "NOT in this file: scale_factor" in (out / "export" / "gazebo.sdf").read_text()
    assert "export: export/imu.yaml: no effect, with the measured noise; not scale_factor: Kalibr knows" in statement
    assert "effects that it cannot express" in words((out / "report.html").read_text())


def test_sessions_of_another_simulator_are_a_baseline(
    two: Path, plain: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """With columns of their own, exact values, and neither counter, host times nor temperature."""
    tables = tmp_path / "tables"
    tables.mkdir()
    for path in sorted(plain.iterdir())[:2]:
        session = load_session(path)
        assert session.encoder_deg is not None
        columns = np.column_stack([1000.0 * session.t_device_s, session.encoder_deg, -np.deg2rad(session.rate_dps)])
        columns[:, 1:] += 1e-9 * np.random.default_rng(1).random((len(columns), 2))
        np.savetxt((tables / path.name).with_suffix(".txt"), columns, fmt="%.12f", delimiter=",")
    baseline = [word for path in sorted(tables.iterdir()) for word in ("--baseline", str(path))]
    stated = ("--baseline-columns", "t_ms, encoder, rate:rads:-")
    gap = diagnosed(two, tmp_path / "out", *baseline, *stated, *ITEM)
    assert (gap["verdict"], gap["contradictions"]) == ("effect", [])
    assert gap["causes"][0]["parameters"]["error_percent"]["value"] == pytest.approx(1.2, rel=0.15)
    assert {"counter", "host times", "temperature"} <= set(gap["lacking"]["baseline"])
    assert "clock_drift" in gap["untestable"]
    assert not {"temp_bias", "sample_drop"} & gap["untestable"].keys()
    statement = capsys.readouterr().err
    assert "only one of both sets has counter and host times: this is no gap" in statement
    assert "it has no temperature, which counts as constant" in statement
    assert "only one of both sets has counter" in words((tmp_path / "out" / "report.html").read_text())
    assert main(["diagnose", str(two), "--out", str(tmp_path / "none"), *stated]) == 2


@pytest.mark.evaluation
def test_a_reference_that_is_read_at_its_own_times_is_no_gap(scaled: Path, plain: Path, tmp_path: Path) -> None:
    for seed, folder in enumerate((scaled, plain)):
        (tmp_path / f"slow-{seed}").mkdir()
        for path in sorted(folder.iterdir()):
            session = load_session(path)
            assert session.encoder_deg is not None
            rows = np.arange(len(session.encoder_deg))
            times = np.arange(-0.3 - seed, len(rows), 100.0 / 15.0)
            latest = np.maximum(np.searchsorted(times, rows, side="right") - 1, 0)
            held_deg = np.interp(times, rows, session.encoder_deg)[latest]
            slow = replace(session, encoder_deg=held_deg, seq=None, temp_c=None, t_host_s=None)
            write_session(tmp_path / f"slow-{seed}" / path.name, [slow])
    lagging = only("scale_factor", "latency", "bandwidth")
    gap = diagnosed(tmp_path / "slow-0", tmp_path / "out", "--baseline", str(tmp_path / "slow-1"), *lagging)
    assert gap["verdict"] == "effect"
    (cause,) = gap["causes"]
    assert cause["effect"] == "scale_factor"
    assert cause["parameters"]["error_percent"]["value"] == pytest.approx(1.2, rel=0.15)


@pytest.mark.parametrize("withheld", [ITEM, pytest.param((), marks=pytest.mark.evaluation)], ids=["one", "all"])
def test_no_gap_is_an_answer_with_what_would_have_been_seen(
    plain: Path, tmp_path: Path, withheld: tuple[str, ...]
) -> None:
    gap = diagnosed(plain, tmp_path, *withheld)
    assert gap["verdict"] == "none"
    assert gap["causes"] == gap["where"] == gap["leftover"] == []
    assert 0.02 < gap["detectable"]["scale_factor"]["error_percent"] < 0.5
    assert gap["calibration"]["noise_dps_rthz"]["data"] == pytest.approx(0.0035, rel=0.1)
    assert gap["calibration"]["bias_dps"]["data"] == pytest.approx(0.35, abs=0.01)


@pytest.mark.evaluation
def test_an_effect_that_is_withheld_is_not_named(two: Path, tmp_path: Path) -> None:
    gap = diagnosed(two, tmp_path, *REST)
    assert "scale_factor" not in [cause["effect"] for cause in gap["causes"]]
    assert gap["verdict"] in {"unknown", "partly"}
    assert gap["where"][0]["signature"] == "rate"


def test_one_bare_session_gives_what_it_can(scaled: Path, tmp_path: Path) -> None:
    bare = tmp_path / "bare.csv"
    write_session(bare, [replace(load_session(min(scaled.iterdir())), t_host_s=None, temp_c=None, seq=None)])
    gap = diagnosed(bare, tmp_path / "out", *FEW)
    lacking = "clock_drift usb_batching temp_bias temp_scale misalignment"
    assert set(gap["untestable"]) == set(lacking.split())
    assert gap["causes"][0]["effect"] == "scale_factor"
    assert "one session only" in gap["remarks"][-1]
    html = (tmp_path / "out" / "report.html").read_text()
    statement = words(html)
    assert "one session only" in statement
    assert "clock_drift: no host times" in statement
    assert row(html, "1. bare")[-1] == "nothing"
    assert len(charts(tmp_path / "out")) > 3
    assert not any("°C" in chart for chart in charts(tmp_path / "out"))
    assert f"gyrodrift diagnose {bare}" in statement


@pytest.mark.evaluation
def test_sign_and_unit_are_told_before_anything_else(two: Path, tmp_path: Path) -> None:
    turn = tmp_path / "turned"
    turn.mkdir()
    for path in sorted(two.iterdir()):
        session = load_session(path)
        write_session(turn / path.name, [replace(session, rate_dps=-np.deg2rad(session.rate_dps))])
    gap = diagnosed(turn, tmp_path / "out", *ITEM)
    assert sum("the sign opposite" in remark for remark in gap["remarks"]) == 2
    assert sum("in radians per second" in remark for remark in gap["remarks"]) == 2
    assert gap["causes"][0]["effect"] == "scale_factor"


@pytest.mark.parametrize(
    ("arguments", "status", "message"),
    [
        (["{plain}", "--withhold", "gremlins"], 2, "--withhold gremlins: there is no such effect"),
        (["{plain}", "--rig", "{tmp}/none.yaml"], 2, "none.yaml"),
        (["{tmp}/nothing"], 4, "there is no such session or folder"),
        (["{tmp}/blind.csv"], 4, "has no encoder"),
        (["{tmp}/dead.csv"], 4, "the encoder does not move while the gyro does"),
    ],
)
def test_mistakes_are_one_line(
    plain: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], status: int, message: str
) -> None:
    session = load_session(next(plain.iterdir()))
    write_session(tmp_path / "blind.csv", [replace(session, encoder_deg=None)])
    write_session(tmp_path / "dead.csv", [replace(session, encoder_deg=np.zeros(len(session.rate_dps)))])
    words = [word.format(plain=plain, tmp=tmp_path) for word in arguments]
    assert main(["diagnose", *words, "--out", str(tmp_path / "out")]) == status
    statement = capsys.readouterr().err
    assert message in statement
    assert len(statement.splitlines()) == 1
    assert not (tmp_path / "out" / "gap.json").exists()
