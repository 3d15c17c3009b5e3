"""`gyrodrift simulate`: sessions without waiting, the same samples as the device plays, and twins of a table."""

from pathlib import Path

import numpy as np
import pytest
from support import Command

from gyrodrift.cli import main
from gyrodrift.session.files import load_session
from gyrodrift.simulation.sessions import euler_error_deg

BRIEF = ("--minutes", "0.2", "--format", "csv")


def simulated(folder: Path, *options: str) -> Path:
    assert main(["simulate", "--out", str(folder), *BRIEF, *options]) == 0
    return folder


def test_the_same_seed_gives_the_same_bytes_and_another_seed_others(tmp_path: Path) -> None:
    item, two, peer = (
        simulated(tmp_path / str(n), "--seed", seed, "--sessions", "2") for n, seed in enumerate(["7", "7", "8"])
    )
    first = [(folder / "session-01.csv").read_bytes() for folder in (item, two, peer)]
    assert first[0] == first[1] != first[2]
    assert (item / "session-02.csv").read_bytes() == (two / "session-02.csv").read_bytes() != first[0]


def test_a_session_is_what_the_played_device_says_through_the_whole_serial_path(tmp_path: Path) -> None:
    """Sample for sample, with effects on, over the native protocol into `serve` and its digits."""
    effects = [
        "--effect",
        "scale_factor",
        "--effect",
        "bandwidth",
        "--effect",
        "sample_drop",
        "--effect",
        "clock_drift",
    ]
    session = load_session(simulated(tmp_path / "s", "--seed", "5", *effects) / "session-01.csv")
    port = tmp_path / "gyro"
    options = ["--seed", "5", "--speed", "max", "--duration", "30", *effects]
    with Command("--link", port, *options, module="firmware_sim") as device:
        device.until_log("native on")
        with Command("serve", "--port", port) as serve:
            lines = serve.take_lines(len(session.rate_dps))
            serve.stop()
    assert session.seq is not None
    assert session.encoder_deg is not None
    assert [line["seq"] for line in lines] == session.seq.tolist()
    assert [line["t_s"] for line in lines] == session.t_device_s.tolist()
    assert [line["rate_dps"] for line in lines] == session.rate_dps.round(5).tolist()
    assert [line["encoder_deg"] for line in lines] == session.encoder_deg.round(4).tolist()


def test_the_rig_beside_the_sessions_gives_them_again(tmp_path: Path) -> None:
    first = simulated(tmp_path / "a", "--effect", "popcorn:step_dps=0.5,dwell_s=3", "--effect", "temp_bias")
    second = simulated(tmp_path / "b", "--rig", str(first / "rig.yaml"))
    assert (first / "session-01.csv").read_bytes() == (second / "session-01.csv").read_bytes()


def test_both_formats_hold_the_same_samples(tmp_path: Path) -> None:
    """MCAP is the one that is written where nothing is said."""
    text = load_session(simulated(tmp_path / "a") / "session-01.csv")
    assert main(["simulate", "--out", str(tmp_path / "b"), "--minutes", "0.2"]) == 0
    binary = load_session(tmp_path / "b" / "session-01.mcap")
    for name in ("t_device_s", "t_host_s", "seq", "rate_dps", "encoder_deg", "temp_c"):
        assert np.array_equal(getattr(text, name), getattr(binary, name))


def test_the_length_is_the_one_asked_for(tmp_path: Path) -> None:
    session = load_session(simulated(tmp_path) / "session-01.csv")
    assert len(session.rate_dps) == 1200
    assert session.t_device_s[-1] == 11.99


def test_a_twin_drifts_as_far_as_its_row_says(tmp_path: Path) -> None:
    """Split, length and E, for a still session and a moving one."""
    table = tmp_path / "table.csv"
    table.write_text("# mine\nsplit,session,minutes,e_euler_deg\ntrain,day 1 (still),1.5,4.5\ntest,day 2,2.25,3.1\n")
    assert main(["simulate", "--twin", str(table), "--out", str(tmp_path / "t"), "--format", "csv"]) == 0
    for path, minutes, e_deg in (("train/01-day-1-still.csv", 1.5, 4.5), ("test/02-day-2.csv", 2.25, 3.1)):
        session = load_session(tmp_path / "t" / path)
        assert len(session.rate_dps) == minutes * 6000
        assert np.mean(np.abs(euler_error_deg(session))) == pytest.approx(e_deg, abs=5e-4)
    still = load_session(tmp_path / "t" / "train/01-day-1-still.csv")
    assert still.encoder_deg is not None
    assert not still.encoder_deg.any()
    assert (tmp_path / "t" / "twin.csv").read_text().count("\n") == 3


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--effect", "popcron"], "--effect popcron: there is no effect 'popcron'; did you mean popcorn?"),
        (
            ["--effect", "popcorn:step_dps=wide"],
            "--effect popcorn:step_dps=wide: step_dps is 'wide'; expected a number",
        ),
        (["--effect", "popcorn:step_dps=99"], "step_dps is 99; input should be less than or equal to 20"),
        (["--minutes", "0"], "--minutes 0: expected a number above 0"),
        (["--sessions", "0"], "--sessions 0: expected a number above 0"),
        (["--seed", "-1"], "--seed -1: expected a whole number from 0"),
        (["--profile", "nowhere"], "--profile nowhere: there is no such profile or file; there are constant-spin"),
        (["--rig", "nowhere.yaml"], "nowhere.yaml: cannot be read: No such file or directory"),
        (["--twin", "nowhere.csv"], "nowhere.csv: cannot be read"),
        (["--out", "/dev/null/x"], "/dev/null/x: cannot be written: Not a directory"),
    ],
)
def test_mistakes_are_told(
    tmp_path: Path, options: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["simulate", "--out", str(tmp_path / "s"), *BRIEF, *options]) in (2, 4)
    assert message in capsys.readouterr().err


def test_a_rig_with_mistakes_is_told_line_by_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Unknown effects and parameters, values out of range."""
    rig = tmp_path / "rig.yaml"
    rig.write_text(
        "base: {bias_dps: 1e-1}\neffects:\n  - {name: wobble}\n  - {name: latency, delay: 3}\n"
        "  - {name: latency, delay_ms: -3}\n"
    )
    assert main(["simulate", "--out", str(tmp_path / "s"), "--rig", str(rig)]) == 2
    report = capsys.readouterr().err
    assert f"{rig}:3:5 effects.0: 'wobble' is not known; there are " in report
    assert f"{rig}:4:21 effects.1.delay: is not known here" in report
    assert f"{rig}:4:5 effects.1.delay_ms: is missing" in report
    assert f"{rig}:5:21 effects.2.delay_ms: is -3; " in report
    assert not (tmp_path / "s").exists()


def test_a_table_of_twins_leads_nowhere_else(tmp_path: Path) -> None:
    table = tmp_path / "table.csv"
    table.write_text("split,session,minutes,e_euler_deg\n../../away,../x,0.5,1.0\n")
    out = tmp_path / "a" / "b" / "twin"
    assert main(["simulate", "--twin", str(table), "--out", str(out), "--format", "csv", "--quiet"]) == 0
    written = {str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.is_file()}
    assert written == {"table.csv", *(f"a/b/twin/{n}" for n in ("away/01-x.csv", "away/01-x.rig.yaml", "twin.csv"))}


@pytest.mark.parametrize("e_deg", ["1e300", "1e-300"])
def test_a_twin_that_no_rig_can_be_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str], e_deg: str) -> None:
    table = tmp_path / "table.csv"
    table.write_text(f"minutes,e_euler_deg,session,split\n0.05,{e_deg}\n")
    assert main(["simulate", "--twin", str(table), "--out", str(tmp_path / "t"), "--quiet"]) == 4
    assert "no bias track of this rig gives E = 1e" in capsys.readouterr().err


@pytest.mark.parametrize(
    "values", ["inf,1", "nan,1", "-1,1", "1e9,1", "1e-300,1", "1,nan", "1,inf", '"' + "x" * 200_000 + '",1']
)
def test_a_table_of_twins_that_makes_no_sense_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], values: str
) -> None:
    table = tmp_path / "table.csv"
    table.write_text(f"split,session,minutes,e_euler_deg\ntest,s,{values}\n")
    assert main(["simulate", "--twin", str(table), "--out", str(tmp_path / "t")]) == 4
    report = capsys.readouterr().err
    assert report.startswith(f"gyrodrift: {table}: ")
    assert len(report) < 1200
