"""`diagnose` between sessions of MuJoCo, and its exports back in MuJoCo; nothing of it is written by this project."""

import ast
import importlib.util
import json
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from simulators import benches
from simulators.cases import CASES, LOOPED
from simulators.sessions import write_again, write_set

from firmware_sim.effects.catalogue import CATALOGUE
from gyrodrift.cli import main
from gyrodrift.diagnose.export.exported import Exported, ExportedEffect, MeasuredValue
from gyrodrift.diagnose.export.mujoco import CALLBACK, XML, mujoco
from gyrodrift.session.files import load_session

mj: Any = pytest.importorskip("mujoco", reason="MuJoCo is not installed: pip install '.[simulators]'")

HERE = Path(__file__).parents[2] / "benchmark" / "simulators"
KEPT = ("scale_factor", "scale_asymmetry", "latency", "quantization", "popcorn", "warmup")
FEW = [word for name in CATALOGUE if name not in KEPT for word in ("--withhold", name)]
"""Fewer candidates take less time; `make evaluate` tries all."""


def test_flaws_know_nothing_of_gyrodrift() -> None:
    """Models, motions and flaws are written for any simulator."""
    for name in ("flaws", "motions", "benches"):
        tree = ast.parse((HERE / f"{name}.py").read_text())
        modules = {node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
        assert not {module.split(".")[0] for module in modules} & {"gyrodrift", "firmware_sim"}


def test_there_are_enough_cases() -> None:
    assert sum(bool(case.effect) for case in CASES.values()) >= 24
    assert sum(not case.effect for case in CASES.values()) >= 6
    assert len(LOOPED) >= 8
    assert {case.effect for case in CASES.values()} - {""} <= CATALOGUE.keys()


@pytest.mark.parametrize("bench", ["turntable", "rover"])
def test_a_bench_turns_as_its_gyro_says(bench: str) -> None:
    rate_dps, angle_deg = benches.BENCHES[bench](30.0, 3)
    integral_deg = np.cumsum(rate_dps) / benches.RATE_HZ
    assert np.ptp(integral_deg) > 200.0
    assert np.abs(integral_deg - (angle_deg - angle_deg[0])).max() < 0.02 * np.abs(np.diff(integral_deg)).sum()


def measured(exported: Exported, folder: Path) -> ModuleType:
    """The exported callback as a module, its sensors beside it."""
    for name, text in mujoco(exported).files.items():
        (folder / name).write_text(text)
    spec = importlib.util.spec_from_file_location("mujoco_callback", folder / CALLBACK)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_mujoco_reads_its_export(tmp_path: Path) -> None:
    """The model includes the sensors, and the callback fills the measured gyro: 10 % more, at most 1 rad/s."""
    limit_dps = float(np.degrees(1.0))
    effects = (
        ExportedEffect("scale_factor", {"error_percent": 10.0}, {}, 1.0, (), None),
        ExportedEffect("saturation", {"limit_dps": limit_dps}, {}, 1.0, (), None),
    )
    none = MeasuredValue(0.0, 0.0, 0.0)
    module = measured(Exported("effect: two", effects, 100.0, none, none, {}), tmp_path)
    plate = (HERE / "turntable.xml").read_text()
    sensors = plate[plate.index("<sensor>") : plate.index("</mujoco>")]
    (tmp_path / "table.xml").write_text(plate.replace(sensors, f'<include file="{XML}"/>'))
    model = mj.MjModel.from_xml_path(str(tmp_path / "table.xml"))
    data = mj.MjData(model)
    mj.set_mjcb_sensor(module.Measured(seed=1))
    try:
        for command, expected in ((0.5, 0.55), (-0.3, -0.33), (1.5, 1.0)):
            data.ctrl[:] = command
            for _ in range(1500):
                mj.mj_step(model, data)
            true, read = data.sensor("gyro").data[2], data.sensor("gyro_measured").data[2]
            assert read == pytest.approx(min(1.1 * true, 1.0), rel=1e-6)
            assert read == pytest.approx(expected, rel=0.02)
        mj.mj_resetData(model, data)
        mj.mj_step(model, data)
        assert data.sensor("gyro_measured").data[2] == pytest.approx(0.0, abs=1e-6)
    finally:
        mj.set_mjcb_sensor(None)


def test_sessions_of_a_simulator_are_read_in_any_form(tmp_path: Path) -> None:
    """Csv of numpy and JSON lines hold the same samples."""
    write_set(tmp_path / "csv", CASES["nothing, turntable"], 1, has_flaws=False, count=1)
    session = load_session(tmp_path / "csv" / "0.csv")
    lines = tmp_path / "session.jsonl"
    rows = zip(session.t_device_s.tolist(), session.rate_dps.tolist(), strict=True)
    lines.write_text("".join(json.dumps({"t_device_s": t_s, "rate_dps": rate_dps}) + "\n" for t_s, rate_dps in rows))
    again = load_session(lines)
    assert again.rate_dps == pytest.approx(session.rate_dps, abs=1e-9)


def diagnosed(real: Path, simulator: Path, out: Path) -> dict[str, Any]:
    options = ["--baseline", str(simulator), "--export", "json", "--jobs", "1", "--quiet"]
    assert main(["diagnose", str(real), "--out", str(out), *options, *FEW]) == 0
    gap: dict[str, Any] = json.loads((out / "gap.json").read_text())
    return gap


@pytest.mark.evaluation
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("name", ["late", "steps"])
def test_an_exported_effect_closes_the_gap_in_mujoco(name: str, tmp_path: Path) -> None:
    """Diagnosed beside the simulator, put into the simulator, diagnosed again: none."""
    case = CASES[name]
    write_set(tmp_path / "real", case, 5, has_flaws=True)
    write_set(tmp_path / "simulator", case, 6, has_flaws=False)
    gap = diagnosed(tmp_path / "real", tmp_path / "simulator", tmp_path / "out")
    assert case.effect in {gap["causes"][0]["effect"], *gap["causes"][0]["tied_with"]}
    exported = json.loads((tmp_path / "out" / "export" / "effects.json").read_text())
    write_again(tmp_path / "again", case, 6, exported["effects"] + exported["noise"])
    assert diagnosed(tmp_path / "real", tmp_path / "again", tmp_path / "closed")["verdict"] == "none"


@pytest.mark.evaluation
@pytest.mark.timeout(1800)
def test_two_sets_of_one_simulator_show_no_gap(tmp_path: Path) -> None:
    """Other motions and other noise are none."""
    case = CASES["nothing, rover"]
    write_set(tmp_path / "real", case, 7, has_flaws=True)
    write_set(tmp_path / "simulator", case, 8, has_flaws=False)
    assert diagnosed(tmp_path / "real", tmp_path / "simulator", tmp_path / "out")["verdict"] == "none"
