"""`gyrodrift filter`: the recursion over a recording, column by column."""

import csv
import io
import json
import subprocess
import sys
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest
from hdr_reference import CASES, COLUMNS, as_printed
from support import Command

from gyrodrift.cli import main
from gyrodrift.filters.hdr_filter import HDR as HDR_FILTER
from gyrodrift.filters.restlevel.model import RestlevelParams
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.session.mcap.write import McapWriter
from gyrodrift.values.sample import Sample

SESSION = "t_device_s,rate_dps\n0,0.5\n0.01,0.25\n0.01,9\n0.02,nan\n0.03,-0.125\n"


def rows_of(path: Path) -> list[dict[str, float]]:
    with path.open() as file:
        return [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]


def test_a_worked_case_comes_out_of_the_command(tmp_path: Path) -> None:
    """Session and config in, all columns out, to a billionth."""
    p, stream = CASES["other_parameters"]
    (tmp_path / "c.yaml").write_text(json.dumps({"hdr": asdict(p)}))
    (tmp_path / "s.csv").write_text("t_device_s,rate_dps\n" + "".join(f"{t_s},{dps}\n" for t_s, dps in stream))
    out = tmp_path / "out.csv"
    assert main(["filter", str(tmp_path / "s.csv"), "--config", str(tmp_path / "c.yaml"), "--out", str(out)]) == 0
    got, expected = rows_of(out), as_printed(p, stream)
    assert list(got[0]) == ["t_device_s", "rate_dps", *COLUMNS, "correction_deg"]
    assert len(got) == len(expected) == 3000
    for row, sample, columns in zip(got, stream, expected, strict=True):
        assert list(row.values()) == pytest.approx([*sample, *columns, 0.0], abs=1e-9)


def test_the_filter_of_the_config_brings_its_own_columns(tmp_path: Path) -> None:
    """Restlevel: drift estimate, certainty, and yaw that stands still at rest."""
    rates = np.random.default_rng(1).normal(0.4, 0.05, 3000).tolist()
    (tmp_path / "s.csv").write_text("t_device_s,rate_dps\n" + "".join(f"{n / 100},{rates[n]}\n" for n in range(3000)))
    (tmp_path / "c.yaml").write_text(f"filter: restlevel\nrestlevel: {json.dumps(asdict(RestlevelParams()))}\n")
    out = tmp_path / "out.csv"
    assert main(["filter", str(tmp_path / "s.csv"), "--config", str(tmp_path / "c.yaml"), "--out", str(out)]) == 0
    rows = rows_of(out)
    assert list(rows[0]) == [*("t_device_s", "rate_dps"), *RESTLEVEL.columns, "correction_deg"]
    assert rows[-1]["bias_dps"] == pytest.approx(0.4, abs=0.02)
    assert rows[-1]["rest_probability"] > 0.9
    assert abs(rows[-1]["yaw_deg"]) < 0.1


def test_what_it_writes_is_a_session_too(tmp_path: Path) -> None:
    (tmp_path / "s.csv").write_text(SESSION)
    once, twice = tmp_path / "once.csv", tmp_path / "twice.csv"
    assert main(["filter", str(tmp_path / "s.csv"), "--out", str(once)]) == 0
    for _ in range(2):
        assert main(["filter", str(once), "--out", str(twice)]) == 0
    assert twice.read_text() == once.read_text()


@pytest.mark.parametrize(("options", "columns"), [([], RESTLEVEL.columns), (["--filter", "hdr"], HDR_FILTER.columns)])
def test_a_filter_is_chosen_without_a_file(
    tmp_path: Path, options: list[str], columns: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    """Restlevel where nothing is said; a file that names no more than the filter gives the same."""
    (tmp_path / "s.csv").write_text("t_device_s,rate_dps\n0,0.5\n0.01,0.25\n")
    assert main(["filter", str(tmp_path / "s.csv"), *options]) == 0
    shown = capsys.readouterr()
    assert shown.out.splitlines()[0].split(",")[2:] == [*columns, "correction_deg"]
    assert shown.err == ""
    name = options[1] if options else "restlevel"
    (tmp_path / "c.yaml").write_text(f"filter: {name}\n")
    assert main(["filter", str(tmp_path / "s.csv"), "--config", str(tmp_path / "c.yaml")]) == 0
    again = capsys.readouterr()
    assert again.out == shown.out
    assert again.err.startswith(f"gyrodrift: {tmp_path}/c.yaml: defaults are {name}.")


def test_bad_samples_are_left_out_and_counted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A repeated time and a rate that is no number."""
    (tmp_path / "s.csv").write_text(SESSION)
    assert main(["filter", str(tmp_path / "s.csv")]) == 0
    shown = capsys.readouterr()
    assert [line.split(",")[0] for line in shown.out.splitlines()] == ["t_device_s", "0.0", "0.01", "0.03"]
    assert shown.err == "gyrodrift: s: 2 samples skipped (time or rate)\n"


@pytest.mark.parametrize(
    ("began_with", "reason"),
    [
        (
            '{"hypotheses": {"0": {"weight": 1.0, "bias_var": -1.0}}, "samples": 1}',
            "the filter state in its metadata cannot be continued",
        ),
        ('{"t_s": NaN}', "is damaged or of another version"),
        ('{"t_s":' * 100_000, "is damaged or of another version"),
    ],
    ids=["negative", "nan", "deep"],
)
def test_what_a_recording_began_with_may_be_made_up(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], began_with: str, reason: str
) -> None:
    path, stream = tmp_path / "s.mcap", io.BytesIO()
    writer = McapWriter(stream, {"filter": {"name": "restlevel", "began_with": began_with}})
    for n in range(1000):
        writer.add(Sample(n, n / 100, 0.0, 0.3 + n % 7 / 100))
    writer.finish()
    path.write_bytes(stream.getvalue())
    assert main(["filter", str(path), "--out", str(tmp_path / "out.csv")]) == 4
    assert reason in capsys.readouterr().err
    assert not (tmp_path / "out.csv").exists()


def test_mistakes_end_with_their_status_and_leave_nothing_half_written(tmp_path: Path) -> None:
    (tmp_path / "s.csv").write_text(SESSION)
    (tmp_path / "c.yaml").write_text("hdr: 1\n")
    out = tmp_path / "out.csv"
    assert main(["filter", str(tmp_path / "none.csv"), "--out", str(out)]) == 4
    assert main(["filter", str(tmp_path / "s.csv"), "--config", str(tmp_path / "c.yaml"), "--out", str(out)]) == 2
    assert main(["filter", str(tmp_path / "s.csv"), "--out", str(tmp_path / "no" / "out.csv")]) == 2
    assert sorted(path.name for path in tmp_path.iterdir()) == ["c.yaml", "s.csv"]


@pytest.mark.parametrize("options", ["--out /dev/full", "> /dev/full"])
def test_a_full_disk_is_told_in_one_line(tmp_path: Path, options: str) -> None:
    (tmp_path / "s.csv").write_text(SESSION)
    command = f"{sys.executable} -m gyrodrift filter {tmp_path}/s.csv {options}"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    name = "/dev/full: cannot be written" if "--out" in options else "output"
    assert done.stderr.splitlines()[-1] == f"gyrodrift: {name}: No space left on device"
    assert "Traceback" not in done.stderr


def test_output_may_go_to_a_device(tmp_path: Path) -> None:
    (tmp_path / "s.csv").write_text(SESSION)
    with Command("filter", tmp_path / "s.csv", "--out", "/dev/stdout") as run:
        assert run.end() == 0
    assert len(run.out.splitlines()) == 4
