"""`tune`, `diagnose` and `compare` as functions: what the commands find, and what they say where something is wrong."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from turntable_sessions import write_turntables

from gyrodrift import compare, diagnose, tune
from gyrodrift.cli import main
from gyrodrift.filters.hdr import HdrParams
from gyrodrift.io.progress import ignore_progress
from gyrodrift.values.errors import DataError, UsageError

pytest.importorskip("numba", reason="the analyses need the workstation extra")
from gyrodrift.diagnose.stages import DiagnosisRequest

pytestmark = pytest.mark.xdist_group("restlevel_kernel")  # its compilation takes seconds


@pytest.fixture(scope="module")
def sessions(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("library") / "sessions"
    write_turntables(folder, 3, minutes=0.5)
    return folder


def test_tune_finds_what_the_command_finds(sessions: Path, tmp_path: Path) -> None:
    test = min(sessions.iterdir())
    report: list[str] = []
    result = tune(
        sessions,
        filter="hdr",
        tests=test,
        iterations=40,
        ranges={"tau_s": (0.01, 2.0)},
        on_progress=lambda what, _done, _total: report.append(what),
    )
    assert {"sessions read", "seed 0"} <= set(report)
    options = [
        "--filter",
        "hdr",
        "--test",
        str(test),
        "--iterations",
        "40",
        "--range",
        "tau_s=0.01:2",
        "--report",
        str(tmp_path),
    ]
    assert main(["tune", str(sessions), "--out", str(tmp_path / "c.yaml"), *options]) == 0
    params = result.run.params
    assert isinstance(params, HdrParams)
    assert json.loads((tmp_path / "tune.json").read_text())["parameters"]["tau_s"] == params.tau_s


def test_tune_without_a_filter_gives_the_better_one(sessions: Path) -> None:
    result = tune(sessions, tests=min(sessions.iterdir()), iterations=32)
    best = min((way for way in result.alternatives if way.filter), key=lambda way: way.judged_pi)
    assert (result.filter, result.params) == (best.filter, best.params)


def test_compare_finds_what_the_command_finds(sessions: Path, tmp_path: Path) -> None:
    config = tmp_path / "c.yaml"
    config.write_text("filter: hdr\nhdr: {i_c_dps: 0.01}\n")
    result = compare([sessions], config=config)
    assert main(["compare", str(sessions), "--config", str(config), "--out", str(tmp_path)]) == 0
    report = json.loads((tmp_path / "compare.json").read_text())
    assert [entry["e_deg"] for entry in report["methods"]] == [mean.e_deg for mean in result.means]


def test_diagnose_asks_what_the_command_asks(sessions: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    requested: list[DiagnosisRequest] = []

    def stop(request: DiagnosisRequest) -> None:
        requested.append(request._replace(progress=ignore_progress))
        raise DataError("asked")

    monkeypatch.setattr("gyrodrift.diagnose.diagnosis.diagnose", stop)
    first = min(sessions.iterdir())
    with pytest.raises(DataError, match="asked"):
        diagnose([sessions], baseline=first, withhold=["scale_factor"], jobs=2)
    options = ["--baseline", str(first), "--withhold", "scale_factor", "--jobs", "2", "--out", str(tmp_path)]
    assert main(["diagnose", str(sessions), *options]) == DataError.exit_status
    assert requested[0] == requested[1]


@pytest.mark.parametrize(
    ("call", "kind", "statement"),
    [
        (lambda index: tune(index, filter="kalman"), UsageError, "'kalman': there is no such filter; there are hdr"),
        (lambda index: tune(index, method="luck"), UsageError, "'luck': there is no such method"),
        (lambda index: tune(index, seeds=()), UsageError, "at least one"),
        (lambda index: tune(index, iterations=0), UsageError, "iterations 0: expected a whole number from 1"),
        (lambda index: tune(index / "none"), DataError, "there is no such session or folder"),
        (lambda index: compare(index, seed=-1), UsageError, "expected whole numbers from 0"),
        (lambda index: diagnose(index, rig=index / "rig.yaml"), UsageError, "rig.yaml"),
        (lambda index: diagnose(index, withhold=["gremlins"]), UsageError, "'gremlins': there is no such effect"),
        (lambda index: diagnose(index / "none"), DataError, "there is no such session or folder"),
    ],
)
def test_what_is_wrong_is_said(
    sessions: Path, call: Callable[[Path], Any], kind: type[Exception], statement: str
) -> None:
    with pytest.raises(kind, match=statement):
        call(sessions)
