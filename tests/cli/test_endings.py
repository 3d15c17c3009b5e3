"""The ending of an output decides its format, and an ending that is none of those is refused."""

import json
from pathlib import Path

import numpy as np
import pytest
from tables_support import samples, written

from gyrodrift.cli import main
from gyrodrift.session.files import load_session

WRITABLE = (".csv", ".json", ".jsonl", ".mcap", ".parquet", ".JSON")


def recorded(folder: Path) -> Path:
    lines = [f"{t!r},{rate!r},{number},{'' if number % 3 else 25.5}" for number, t, rate in samples(0.5)]
    return written(folder / "in.csv", "\n".join(["t_device_s,rate_dps,seq,temp_c", *lines]) + "\n")


@pytest.mark.promise("Files of other programs")
@pytest.mark.parametrize("ending", WRITABLE)
def test_a_session_goes_through_every_format_with_all_its_digits(tmp_path: Path, ending: str) -> None:
    """A session passes through every format with all its digits."""
    if ending == ".parquet":
        pytest.importorskip("pyarrow")
    source, out, back = recorded(tmp_path), tmp_path / f"out{ending}", tmp_path / "back.csv"
    assert main(["convert", str(source), str(out)]) == 0
    assert main(["convert", str(out), str(back)]) == 0
    first, last = load_session(source), load_session(back)
    for name in ("t_device_s", "rate_dps", "seq", "temp_c"):
        np.testing.assert_array_equal(getattr(first, name), getattr(last, name))


@pytest.mark.parametrize("ending", WRITABLE)
def test_what_a_filter_writes_is_of_the_format_of_its_ending(tmp_path: Path, ending: str) -> None:
    """Every one can be read again."""
    if ending == ".parquet":
        pytest.importorskip("pyarrow")
    source, out = recorded(tmp_path), tmp_path / f"out{ending}"
    assert main(["filter", str(source), "--out", str(out)]) == 0
    beginnings = {
        ".csv": b"t_device_s,",
        ".json": b'[{"t_dev',
        ".jsonl": b'{"t_dev',
        ".mcap": b"\x89MCAP",
        ".parquet": b"PAR1",
    }
    assert out.read_bytes().startswith(beginnings[ending.lower()])
    np.testing.assert_array_equal(load_session(out).rate_dps, load_session(source).rate_dps)


def test_json_is_json(tmp_path: Path) -> None:
    """An array of objects, with null for what is missing."""
    out = tmp_path / "out.json"
    assert main(["convert", str(recorded(tmp_path)), str(out)]) == 0
    rows = json.loads(out.read_text(), parse_constant=pytest.fail)
    assert len(rows) == 60
    assert rows[1]["temp_c"] is None


@pytest.mark.promise("Files of other programs")
@pytest.mark.parametrize("command", [["filter", "in.csv", "--out"], ["convert", "in.csv"]])
@pytest.mark.parametrize("name", ["out.xlsx", "out.txt", "out", "out.csv.gz"])
def test_an_ending_that_is_none_is_refused_with_the_list(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: list[str], name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """An unknown ending of an output is refused, with the list of endings."""
    monkeypatch.chdir(tmp_path)
    recorded(tmp_path)
    assert main([*command, name]) == 2
    assert f"{name}: the ending decides the format, expected one of .csv, .json" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["in.csv"]


@pytest.mark.parametrize("name", ["kept.json", "kept.jsonl", "kept.parquet"])
def test_a_table_that_is_there_is_replaced_with_force_only(tmp_path: Path, name: str) -> None:
    if name.endswith("parquet"):
        pytest.importorskip("pyarrow")
    kept = written(tmp_path / name, '[{"t_device_s": 1}]')
    assert main(["filter", str(recorded(tmp_path)), "--out", str(kept)]) == 2
    assert kept.read_text() == '[{"t_device_s": 1}]'
    assert main(["filter", str(recorded(tmp_path)), "--out", str(kept), "--force"]) == 0
