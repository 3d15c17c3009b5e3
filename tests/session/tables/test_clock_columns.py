"""Clocks of tables that are none, that are written in another way, or that nobody has: told with what to state."""

import json
from itertools import pairwise
from math import radians
from pathlib import Path

import numpy as np
import pytest
from tables_support import BIAS_DPS, END_S, TURN_DEG, Row, filtered_yaw_deg, samples, table, written

from gyrodrift import load_session
from gyrodrift.cli import main
from gyrodrift.columns.spec import columns_of
from gyrodrift.facts.session_facts import SessionFacts
from gyrodrift.session.checks.examine import examined
from gyrodrift.session.checks.stated import ReadingOptions, session_as_stated
from gyrodrift.session.session import Session
from gyrodrift.values.errors import DataError

STEP_S = 0.05
RATE_HZ = "20"


def hms(t_s: float) -> str:
    seconds, ms = divmod(round(1e3 * t_s) + 35_990_000, 1000)
    return f"{seconds // 3600:02d}{seconds // 60 % 60:02d}{seconds % 60:02d}.{ms:03d}"


WRONG: dict[str, tuple[str, Row, str, str, tuple[str, ...]]] = {
    "counter": (
        "Packet,gz (deg/s)\n",
        lambda n, t, r: f"{(65_500 + n) % 65_536},{r:.3f}",
        "Packet=t_ms, gz (deg/s)=rate",
        "Packet steps by 1 in each row, so it is a counter and no clock; call it seq and state --sample-rate HZ",
        ("--columns", "Packet=seq, gz (deg/s)=rate", "--sample-rate", RATE_HZ),
    ),
    "unpadded": (
        "time (s),gz (deg/s)\n",
        lambda n, t, r: f"{t // 1:.0f}.{t % 1 * 1e6 + 77:.0f},{r:.3f}",
        "",
        r"time \(s\) has no leading zeros in its fraction \(%ld.%ld\): state --time-unit s.us",
        ("--time-unit", "s.us"),
    ),
    "HHMMSS": (
        "time,gz (deg/s)\n",
        lambda n, t, r: f"{hms(t)},{r:.3f}",
        "time=t_s, gz (deg/s)=rate",
        "time jumps by 40 at each minute, so it is a time of day as HHMMSS; state --time-unit hms",
        ("--columns", "time=t_s, gz (deg/s)=rate", "--time-unit", "hms"),
    ),
    "days": (
        "when,gz (deg/s)\n",
        lambda n, t, r: f"{739_373.5 + t / 86_400:.10f},{r:.3f}",
        "when=t_s, gz (deg/s)=rate",
        r"if they are days, use --time-unit days \(20 Hz\)$",
        ("--columns", "when=t_s, gz (deg/s)=rate", "--time-unit", "days"),
    ),
    "part of a second": (
        "ms,gz (deg/s)\n",
        lambda n, t, r: f"{t % 1 * 1e3:.0f},{r:.3f}",
        "ms=t_ms, gz (deg/s)=rate",
        "its times restart 29 times in 600 samples: they are no clock, or a part of one; .*--sample-rate HZ",
        ("--columns", "ms=t_ms, gz (deg/s)=rate", "--sample-rate", RATE_HZ),
    ),
}


@pytest.mark.parametrize("form", WRONG)
def test_what_is_no_clock_is_told_and_what_it_names_helps(form: str, tmp_path: Path) -> None:
    head, row, spec, message, options = WRONG[form]
    path = written(tmp_path / "s.csv", table(row, head, STEP_S))
    stated = ReadingOptions(columns_of(spec) if spec else None)
    with pytest.raises(DataError, match=message):
        examined(session_as_stated(path, stated), stated).refuse_errors(str(path))
    assert filtered_yaw_deg(path, *options) == pytest.approx(TURN_DEG, abs=2.0)


def test_milliseconds_of_a_gyro_of_1_khz_are_no_counter(tmp_path: Path) -> None:
    path = written(tmp_path / "s.csv", table(lambda n, t, r: f"{n},{r:.3f}", "millis,gz\n", 0.001))
    assert filtered_yaw_deg(path, "--columns", "millis=t_ms, gz=rate:dps") == pytest.approx(TURN_DEG, abs=2.0)


def test_without_a_clock_the_sample_rate_is_asked_for_and_counts_lost_rows(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The counter wraps, and a second is missing at rest."""
    rows = [f"{(65_500 + n) % 65_536};{radians(r):.5f}" for n, t, r in samples(STEP_S) if not 5.0 <= t < 6.0]
    path = written(tmp_path / "s.csv", "n;w\n" + "\n".join(rows))
    assert main(["info", str(path), "--columns", "n=seq, w=rate:rads"]) == 2
    assert "state the sample rate with --sample-rate HZ" in capsys.readouterr().err
    session = load_session(path, columns="n=seq, w=rate:rads", sample_rate_hz=20.0)
    assert np.ptp(session.t_device_s) == pytest.approx(END_S - STEP_S)
    assert np.diff(session.t_device_s).max() == pytest.approx(1.0 + STEP_S)


def test_labels_that_state_the_rate_need_the_sample_rate_only(tmp_path: Path) -> None:
    path = written(tmp_path / "s.csv", table(lambda n, t, r: f"{n},{r:.3f}", "packet,gyro_z (deg/s)\n"))
    assert filtered_yaw_deg(path, "--sample-rate", RATE_HZ) == pytest.approx(TURN_DEG, abs=2.0)


@pytest.mark.parametrize(
    ("row", "spec"),
    [
        (lambda n, t, r: f'"{1e3 * t + 900:,.0f}","{r:,.3f}"', "t_ms, rate"),
        (lambda n, t, r: f"{1e3 * t + 900:,.1f};{r:.3f}".replace(",", "'"), "t_ms, rate"),
        (lambda n, t, r: f"{1e3 * t + 900:,.1f};{r:.3f}".translate({44: 46, 46: 44}), "t_ms, rate"),
        (lambda n, t, r: f"{1e3 * t + 900:,.1f};{r:.3f}".translate({44: 160, 46: 44}), "t_ms, rate"),
    ],
)
def test_marks_between_thousands_are_removed(row: Row, spec: str, tmp_path: Path) -> None:
    path = written(tmp_path / "s.csv", table(row, "a,b\n" if '"' in row(0, 0.0, 0.0) else "a;b\n"))
    assert filtered_yaw_deg(path, "--columns", spec) == pytest.approx(TURN_DEG, abs=2.0)


def test_an_angle_between_rows_has_the_unit_of_its_label_and_lost_rows_keep_the_rate(tmp_path: Path) -> None:
    """The angles of two rows with one stamp add up."""
    rows = [f"{n // 2 / 10:.1f},{radians(r * STEP_S):.8f}" for n, t, r in samples(STEP_S) if not 13.0 <= t < 14.0]
    path = written(tmp_path / "s.csv", "t_s,dtheta_z (rad)\n" + "\n".join(rows))
    session = load_session(path, columns="t_s=t_s, dtheta_z (rad)=delta")
    turned_deg = np.sum(session.rate_dps[1:] * np.diff(session.t_device_s))
    assert turned_deg == pytest.approx(TURN_DEG + BIAS_DPS * END_S, abs=1.0)


def test_rows_of_another_value_are_named(tmp_path: Path) -> None:
    path = written(tmp_path / "s.csv", table(lambda n, t, r: f"{'AB'[n % 2]},{t:.3f},{r:.3f}", "node,t_s,gz\n"))
    with pytest.raises(DataError, match="no row has node = C; there are A, B"):
        load_session(path, columns="node=C, t_s=t_s, gz=rate")
    assert len(load_session(path, columns="node=b, t_s=t_s, gz=rate").rate_dps) == 300


def test_a_clock_that_cannot_be_read_is_told_with_the_forms_that_are(tmp_path: Path) -> None:
    path = written(tmp_path / "s.csv", table(lambda n, t, r: f"week 7 {t},{r:.3f}", "when,gz\n"))
    with pytest.raises(
        DataError, match=r"when is 'week 7 0.0', expected a time: a number, 14:15:00.250, .*01-May-2024"
    ):
        load_session(path, columns="when=t_s, gz=rate:dps")


def test_quaternions_in_counts_are_told_with_their_scale(tmp_path: Path) -> None:
    path = written(tmp_path / "s.csv", table(lambda n, t, r: f"{t:.3f},16384,0,0,0", "t_s,w,x,y,z\n"))
    with pytest.raises(
        DataError, match=r"its quaternions have the length 1.638e.04, not 1; .* write :lsb/16384 after q.w"
    ):
        load_session(path, columns="t_s, q.w, q.x, q.y, q.z")


def test_a_sample_rate_that_halves_is_no_run_of_gaps() -> None:
    t_s = np.concatenate([np.arange(3000) * 0.01, 30.0 + np.arange(1500) * 0.02])
    gaps = SessionFacts(Session("s", np.delete(t_s, 1000), np.zeros(4499))).gaps
    assert (gaps.count, gaps.missing) == (1, 1)


@pytest.mark.parametrize("form", ["lines", "list", "columns"])
def test_nanoseconds_in_json_keep_all_their_digits(tmp_path: Path, form: str) -> None:
    """Steps of 1,000,003 ns at a Unix time of 19 digits, which a float rounds to 256 ns."""
    stamps = [1_700_000_000_123_456_789 + 1_000_003 * i for i in range(2000)]
    rows = [{"t_ns": stamp, "rate_dps": 0.5 + i % 2} for i, stamp in enumerate(stamps)]
    text = {
        "lines": "".join(json.dumps(row) + "\n" for row in rows),
        "list": json.dumps(rows, indent=1),
        "columns": json.dumps({name: [row[name] for row in rows] for name in ("t_ns", "rate_dps")}),
    }[form]
    path = tmp_path / "a.json"
    path.write_text(text)
    t_s = load_session(path).t_device_s
    assert len(t_s) == 2000
    assert [round((b - a) * 1e9) for a, b in pairwise(t_s.tolist())] == [1_000_003] * 1999
