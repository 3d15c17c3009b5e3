"""`gyrodrift info`: the table, the JSON, the picture and the page of what sessions hold."""

import json
import os
import re
import subprocess
import sys
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from page_support import row, words
from recordings_support import Recordings
from support import quick

from gyrodrift.cli import main
from gyrodrift.io.installation import extra_command
from gyrodrift.session.files import write_session
from gyrodrift.session.mcap.write import McapWriter
from gyrodrift.session.session import Session
from gyrodrift.values.sample import Sample

ABOUT = {
    "device": {"id": "bench-7", "note": "left on the table\x1b[31m over night"},
    "simulation": {"rig": "base:\n  sample_rate_hz: 100\n  bias_dps: 0.35\n", "long": "x" * 300},
    "empty": {},
}


def written(folder: Path, name: str = "s.mcap") -> Path:
    """Forty seconds of rest with a bias, and three gaps."""
    seq = np.setdiff1d(np.arange(4000), [500, *range(900, 910), 2000])
    t_s = seq / 100.0
    rng = np.random.default_rng(1)
    session = Session(
        name="s",
        t_device_s=t_s,
        rate_dps=0.35 + 0.05 * rng.standard_normal(len(seq)),
        t_host_s=1.7e9 + t_s * (1.0 - 200e-6) + rng.exponential(0.002, len(seq)),
        seq=seq,
        encoder_deg=np.full(len(seq), 12.5),
        temp_c=np.linspace(20.0, 23.0, len(seq)),
    )
    write_session(folder / name, [session], ABOUT)
    return folder / name


def described(capsys: pytest.CaptureFixture[str], *arguments: str | Path) -> list[str]:
    """Lines on stdout; stderr only names the files that were written."""
    assert main(["info", *map(str, arguments)]) == 0
    shown = capsys.readouterr()
    assert all(" written: " in line or line.startswith("page: ") for line in shown.err.splitlines())
    return shown.out.splitlines()


def line_of(lines: list[str], name: str) -> str:
    (line,) = [line for line in lines if line[2:].startswith(f"{name} ")]
    return line


def test_the_table_tells_what_the_session_holds(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lines = described(capsys, path := written(tmp_path))
    assert lines[0] == str(path)
    assert line_of(lines, "samples").split() == ["samples", "3988"]
    assert line_of(lines, "duration").endswith("  39.99 s")
    assert any(line.startswith("  rate ") and line.endswith("  100 Hz") for line in lines)
    assert line_of(lines, "gaps").startswith("! gaps")
    assert line_of(lines, "gaps").endswith("  3: 12 samples missing, the longest gap 0.11 s")
    assert " ppm, clock of the device against the host's" in line_of(lines, "drift")
    assert line_of(lines, "encoder").endswith("  12.5 deg, never moves")
    assert line_of(lines, "temperature").endswith("20.00 … 23.00 °C, 20.00 → 23.00 °C from start to end")
    assert line_of(lines, "rests").split()[1:3] == ["1:", "39.9"]
    assert "at rest, by the encoder" in lines
    assert re.search(r"  0\.\d+ °/√h \(0\.00\d+ deg/√s\)$", line_of(lines, "angle random walk"))
    assert [line for line in lines if line.startswith("!")] == [line_of(lines, "gaps")]


def test_values_stand_in_one_column(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lines = described(capsys, written(tmp_path))
    column = line_of(lines, "samples").index("3988")
    assert all(
        line[column - 2 : column] == "  " and line[column] != " "
        for line in lines
        if line.startswith("  ") and line.strip() != "empty"
    )


def test_what_was_kept_beside_the_samples_is_shown_in_brief(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The first line of a long text, and nothing that a terminal would obey."""
    lines = described(capsys, written(tmp_path))
    assert {"metadata: device", "metadata: simulation", "metadata: empty"} <= set(lines)
    assert line_of(lines, "id").endswith("  bench-7")
    assert line_of(lines, "note").endswith("  left on the table?[31m over night")
    assert line_of(lines, "rig").endswith("  base:  (3 lines)")
    assert line_of(lines, "long").endswith("x…")
    assert max(map(len, lines)) < 130


def test_the_bytes_of_the_link_are_mentioned(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with (tmp_path / "raw.mcap").open("wb") as file:
        writer = McapWriter(file)
        writer.add(Sample(0, 1.0, 5.0, 2.0))
        for content in (b"\x00" * 300, b"\x01" * 1200):
            writer.add_read(content, 5.0)
        writer.finish()
    assert line_of(described(capsys, tmp_path / "raw.mcap"), "raw").endswith(
        "  2 reads, 1.5 kB; replay --raw plays them again"
    )
    assert line_of(described(capsys, written(tmp_path)), "raw").endswith("  none recorded; record --raw keeps them")
    (line,) = described(capsys, "--json", tmp_path / "raw.mcap")
    assert json.loads(line)["raw"] == {"reads": 2, "total_bytes": 1500}


def test_json_has_finite_numbers_only(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (line,) = described(capsys, "--json", path := written(tmp_path))
    about: dict[str, Any] = json.loads(line, parse_constant=pytest.fail)
    assert about["session"] == str(path)
    assert about["samples"] == 3988
    assert about["gaps"] == {"count": 3, "missing": 12, "longest_s": pytest.approx(0.11)}
    assert about["host"]["drift_ppm"] == pytest.approx(200.0, abs=4.0 * about["host"]["drift_sd_ppm"])
    assert about["still_by"] == "encoder"
    assert about["stretches"][0]["mean_dps"] == pytest.approx(0.35, abs=0.005)
    assert about["allan"]["angle_random_walk_deg_rts"] == pytest.approx(0.005, rel=0.1)
    assert len(about["allan"]["taus_s"]) == len(about["allan"]["deviations_dps"]) > 5
    assert about["metadata"] == ABOUT
    (tmp_path / "odd.csv").write_text("t_device_s,rate_dps\n-1e308,1\n1e308,nan\n1.1e308,1e308\n1.2e308,1e308\n")
    (line,) = described(capsys, "--json", tmp_path / "odd.csv")
    odd = json.loads(line, parse_constant=pytest.fail)
    assert odd["rates_not_finite"] == 3  # two that no gyro gives are among them
    assert [value["column"] for value in odd["impossible"]] == ["rate_dps", "t_device_s"]


def test_several_sessions_are_a_table_with_a_summary(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A line per session without the folder that they share; what deserves a second look is marked."""
    written(tmp_path, "a.mcap")
    written(tmp_path, "b.csv")
    (tmp_path / "short.csv").write_text("t_device_s,rate_dps\n0,1\n0.01,2\n")
    lines = described(capsys, tmp_path)
    headings, *rows = lines[:4]
    names = "session duration rate gaps rests noise °/√h °/h end error raw corrected second look at"
    assert " ".join(headings.split()) == names
    assert [row.split()[:2] for row in rows] == [["!", "a.mcap"], ["!", "b.csv"], ["!", "short.csv"]]
    assert re.fullmatch(
        r"! a.mcap +40 s +100 Hz +3: 12 missing +1: 39.9 s +0.\d+ .* +\+1\d.\d° +-?\+?0.\d+° +gaps", rows[0]
    )
    assert re.fullmatch(r"! short.csv +0.01 s +100 Hz +none +none +– +– +– +– +rests", rows[2])
    assert line_of(lines, "3 sessions").endswith("  80 s, 7,978 samples")
    assert line_of(lines, "gaps").endswith("  6 in 2 sessions, 24 samples missing")
    assert "°/√h" in line_of(lines, "angle random walk")
    assert re.search(r"raw 1\d.\d°, restlevel 0.\d+°: .* 2 sessions with an encoder", line_of(lines, "end error"))
    assert max(map(len, lines)) < 130


def test_a_strange_name_takes_one_line_and_stays_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A line break and a control character of 8 bits in the names of files."""
    for name in ("a\nb.csv", "c\x9bd.csv"):
        (tmp_path / name).write_text("t_device_s,rate_dps\n0,1\n0.01,2\n")
    lines = described(capsys, tmp_path)
    assert [line.split()[1] for line in lines[1:3]] == [r"a\nb.csv", r"c\x9bd.csv"]
    names = [json.loads(line)["session"] for line in described(capsys, "--json", tmp_path)]
    assert names == [str(tmp_path / "a\nb.csv"), str(tmp_path / "c\x9bd.csv")]


def test_the_table_corrects_by_the_filter_of_a_config(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    config = tmp_path / "my.yaml"
    config.write_text("filter: hdr\n")
    paths = [written(tmp_path, "a.mcap"), written(tmp_path, "b.mcap")]
    assert ", hdr " in line_of(described(capsys, *paths, "--config", config), "end error")


def test_verbose_gives_the_full_text_of_each_session(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    paths = [written(tmp_path, "a.mcap"), written(tmp_path, "b.csv")]
    lines = described(capsys, "--verbose", *paths)
    assert lines[lines.index(str(paths[1])) - 1] == ""
    assert lines[0] == str(paths[0])
    assert [json.loads(line)["session"] for line in described(capsys, "--json", *paths)] == [
        str(path) for path in paths
    ]


@pytest.mark.promise("Analyses and reports")
def test_an_unreadable_session_does_not_hide_the_others(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """An unreadable session does not hide the others from `info`."""
    written(tmp_path, "a.mcap")
    (tmp_path / "b.csv").write_text("t_device_s,rate_dps\n0,x\n")
    assert main(["info", str(tmp_path)]) == 4
    shown = capsys.readouterr()
    assert "a.mcap" in shown.out
    assert len(shown.err.splitlines()) == 1
    assert "b.csv" in shown.err


@pytest.mark.promise("Analyses and reports")
def test_files_are_written_before_anything_is_printed(tmp_path: Path) -> None:
    """`info` writes its files before it prints, so `info sessions --out page | head` loses none."""
    paths = [written(tmp_path, "a.mcap"), written(tmp_path, "b.mcap")]
    command = [
        sys.executable,
        "-m",
        "gyrodrift",
        "info",
        "--verbose",
        *map(str, paths),
        "--out",
        str(tmp_path / "page"),
    ]
    environment = {**os.environ, "PYTHONUNBUFFERED": "1"}
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment) as process:
        assert process.stdout is not None
        process.stdout.close()
        assert process.stderr is not None
        errors = process.stderr.read().decode()
    assert process.returncode == 0
    assert re.fullmatch(
        r"gyrodrift: \S+/report.html written: 2 sessions, 7,976 samples, \d+ kB\npage: \S+/report.html\n", errors
    )
    assert (tmp_path / "page" / "report.html").stat().st_size > 100_000


@pytest.mark.parametrize(
    ("rows", "odd"),
    [
        ("0,1\n", "unknown: device time never goes forward"),
        ("1,1\n1,2\n1,3\n", "2 steps do not go forward; the filter skips these samples"),
        ("0,nan\n1,nan\n", "2 are not finite; the filter skips these samples"),
        ("0,nan\n1,nan\n", "no finite value"),
        ("0,3\n1,3\n2,3\n", "3 … 3 deg/s, mean 3 deg/s: never changes"),
        ("0,1\n1,2\n1.2,3\n2.2,1\n3.4,1\n", "ms, scatter of the time steps"),
        ("0,1\n1,2\n", "none: the bias is unknown"),
    ],
)
def test_what_is_odd_is_marked(rows: str, odd: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Sessions too small to say much are told all the same."""
    (tmp_path / "s.csv").write_text(f"t_device_s,rate_dps\n{rows}")
    assert any(line.startswith("!") and line.endswith(odd) for line in described(capsys, tmp_path / "s.csv"))


def test_of_many_rests_the_longest_are_shown(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lengths_s = [4, 9, 5, 8, 6, 7, 10, 3]
    rest_and_turn = ([np.repeat(50.0 * i, 100 * s), 50.0 * i + np.arange(100) / 2.0] for i, s in enumerate(lengths_s))
    angle_deg = np.concatenate(list(chain.from_iterable(rest_and_turn)))
    rate_dps = np.gradient(angle_deg, 0.01) + np.random.default_rng(1).standard_normal(len(angle_deg))
    session = Session("s", np.arange(len(angle_deg)) / 100.0, rate_dps, encoder_deg=angle_deg)
    write_session(tmp_path / "s.csv", [session])
    lines = described(capsys, tmp_path / "s.csv")
    starts_s = [float(line.split()[0]) for line in lines if " – " in line]
    assert starts_s == pytest.approx([5.0, 15.0, 21.0, 30.0, 37.0, 45.0], abs=0.6)
    assert line_of(lines, "all 8").endswith(" deg/s; --json has all of them")


@pytest.fixture
def small(tmp_path: Path) -> Path:
    (tmp_path / "small.csv").write_text("t_device_s,rate_dps\n0,1\n0.01,2\n")
    return tmp_path / "small.csv"


PNG = ("png", b"\x89PNG")


@pytest.mark.parametrize(("ending", "magic"), quick([PNG, ("svg", b"<?xml"), ("pdf", b"%PDF")], PNG))
def test_a_picture_is_drawn_beside_the_table(
    ending: str, magic: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    picture = tmp_path / f"s.{ending}"
    assert len(described(capsys, written(tmp_path), "--picture", picture)) > 20
    assert picture.read_bytes().startswith(magic)


def test_the_page_shows_all_sessions_and_where_it_comes_from(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Yaw by the filter that is asked for, restlevel where none is."""
    paths = [written(tmp_path, "a.mcap"), written(tmp_path, "b.csv")]
    config = tmp_path / "my.yaml"
    config.write_text("filter: hdr\nhdr: {i_c_dps: 0.0045, tau_s: 0.001, theta_w_dps: 0.7, c1: 0, c2: 1}\n")
    described(capsys, *paths, "--out", tmp_path / "page")
    html = (tmp_path / "page" / "report.html").read_text()
    statement = words(html)
    assert statement.strip().startswith("gyrodrift info · 2 sessions, 1.33 minutes a and b: mean yaw error ")
    assert "corrected by restlevel" in statement
    assert row(html, "1. a")[1:4] == ["0.666", "100", "12"]
    assert "Worth a second look gaps: 3: 12 samples missing, the longest gap 0.11 s" in statement
    assert f"Command gyrodrift info {paths[0]} {paths[1]} --out {tmp_path / 'page'}" in statement
    described(capsys, paths[0], "--out", tmp_path / "page", "--config", config)
    statement = words((tmp_path / "page" / "report.html").read_text())
    assert "corrected by hdr" in statement
    assert f"Config hdr of {config}" in statement
    assert "theta_w_dps: 0.7" in statement


@pytest.mark.parametrize(
    "table",
    [
        "t_device_s,rate_dps\n0,1\n",
        "t_device_s,rate_dps,t_host_s,encoder_deg\n1,1,nan,nan\n1,nan,nan,nan\n",
        "t_device_s,rate_dps,t_host_s,temp_c\nnan,1,5,20\nnan,2,5,21\n",
        "t_device_s,rate_dps\n" + "".join(f"{i / 10},0\n" for i in range(600)),
        "t_device_s,rate_dps,t_host_s,temp_c\n" + "".join(f"{i},{i % 7},{i},\n" for i in range(5000)),
    ],
)
def test_a_picture_of_next_to_nothing_is_drawn(table: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "s.csv").write_text(table)
    described(capsys, tmp_path / "s.csv", "--picture", tmp_path / "s.png", "--out", tmp_path)
    assert (tmp_path / "s.png").stat().st_size > 5_000
    assert not re.search(r"\b(nan|None|inf)\b", words((tmp_path / "report.html").read_text()))


def test_thinning_keeps_spikes() -> None:
    drawing = pytest.importorskip("gyrodrift.describe.drawing", reason="pictures need the workstation extra")
    y = np.zeros(100_001)
    y[[12_345, 100_000]] = 7.0, -5.0
    y[50_000] = np.nan
    x, low, mean, high = drawing.line_parts(np.arange(100_001.0), y)
    assert len(x) <= drawing.PARTS
    assert (np.max(high), np.min(low)) == (7.0, -5.0)
    assert abs(x[int(np.argmax(high))] - 12_345) <= 251
    assert np.isfinite(mean).all()


def test_without_matplotlib_the_extra_is_named(
    small: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    assert main(["info", str(small), "--picture", str(tmp_path / "s.png")]) == 2
    shown = capsys.readouterr()
    command = extra_command("lab")
    assert (shown.out, shown.err) == ("", f"gyrodrift: --picture needs the package matplotlib: {command}\n")


def test_mistakes_end_with_their_status(small: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    second = tmp_path / "other.csv"
    second.write_bytes(small.read_bytes())
    for arguments, status in (
        ((tmp_path / "none.csv",), 4),
        ((small, "--picture", tmp_path / "s.gif"), 2),
        ((small, second, "--picture", tmp_path / "s.png"), 2),
        ((small, "--picture", tmp_path / "no" / "s.png"), 2),
        ((small, "--config", tmp_path / "none.yaml"), 2),
        ((small, "--config", tmp_path / "none.yaml", "--out", tmp_path), 2),
        ((small, "--out", small), 2),
    ):
        assert main(["info", *map(str, arguments)]) == status
        assert len(capsys.readouterr().err.splitlines()) == 1
    assert {path.name for path in tmp_path.iterdir()} == {"small.csv", "other.csv"}


@pytest.mark.parametrize("name", quick(["broad_01", "mpu6050_still", "temperature_sweep"], "temperature_sweep"))
def test_real_recordings_are_told_and_drawn(
    name: str, recordings: Recordings, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lines = described(capsys, recordings.path(name), "--picture", tmp_path / "s.png")
    assert line_of(lines, "angle random walk").endswith(" deg/√s)")
    assert (tmp_path / "s.png").stat().st_size > 10_000
