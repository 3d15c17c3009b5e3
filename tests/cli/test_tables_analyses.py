"""`--columns` reaches every command that reads sessions, and the library."""

import json
from math import radians
from pathlib import Path

import pytest
from tables_support import samples, table, written

from gyrodrift import compare, load_session
from gyrodrift.cli import main

pytestmark = pytest.mark.xdist_group("restlevel_kernel")  # its compilation takes seconds

SPEC = "t_ms, _, rate:rads, encoder, temp"


def with_encoder(folder: Path, name: str = "odd.txt") -> Path:
    turned_deg = dict(enumerate(_encoder()))
    return written(
        folder / name,
        table(lambda n, t, r: f"{t * 1000:.0f};7;{radians(r):.6f};{turned_deg[n]:.3f};25.5".replace(".", ",")),
    )


def _encoder() -> list[float]:
    return [min(max(30.0 * (t - 12.0), 0.0), 90.0) for _, t, _ in samples()]


def test_compare_and_the_library_take_columns(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = with_encoder(tmp_path)
    assert main(["compare", str(path), "--columns", SPEC, "--jobs", "1", "--out", str(tmp_path / "out")]) == 0
    report = json.loads((tmp_path / "out" / "compare.json").read_text())
    assert len(report["sessions"]) == 1
    assert main(["compare", str(path)]) == 4
    assert "which column is the rate" in capsys.readouterr().err
    assert compare(path, columns=SPEC).sessions[0].session.minutes == pytest.approx(0.5, abs=0.01)
    assert load_session(path, columns=SPEC).encoder_deg is not None


def test_tune_takes_columns(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    paths = [str(with_encoder(tmp_path, f"{name}.txt")) for name in "ab"]
    out = str(tmp_path / "my.yaml")
    assert main(["tune", *paths, "--out", out, "--columns", SPEC, "--iterations", "60", "--jobs", "1"]) == 0
    assert main(["tune", *paths, "--out", out, "--iterations", "60"]) == 4
    assert "which column is the rate" in capsys.readouterr().err


def test_diagnose_and_doctor_take_columns(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = str(with_encoder(tmp_path))
    main(["diagnose", path, "--out", str(tmp_path / "out"), "--columns", SPEC, "--jobs", "1"])
    assert "which column is the rate" not in capsys.readouterr().err
    assert main(["doctor", path, "--columns", SPEC, "--json"]) in {0, 3}
    assert main(["doctor", path]) == 4
