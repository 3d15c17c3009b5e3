"""A recording whose clock, unit, sign or axis is not what it says is refused or asked for, never filtered silently."""

import csv
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import degrees, radians
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.cli import main
from gyrodrift.session.checks.examine import examined
from gyrodrift.session.files import write_session
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats

TURN_DEG = 165.0
HZ = 50.0


def turned(hz: float = HZ, noise_dps: float = 0.06, bias_dps: float = 0.5, seed: int = 1) -> Session:
    """A rest of 15 s, a turn of 165 deg within 3 s, and a rest; without a reference."""
    t_s = np.arange(round(35.0 * hz)) / hz
    motion_dps = np.where((t_s >= 15.0) & (t_s < 18.0), TURN_DEG / 3.0, 0.0)
    noise = np.random.default_rng(seed).standard_normal(len(t_s))
    return Session("s", t_s, np.round(motion_dps + bias_dps + noise_dps * noise, 4))


def swung(seed: int = 1) -> Session:
    """Swings of 90 deg with an encoder that sees them, and host times."""
    t_s = np.arange(round(40.0 * HZ)) / HZ
    angle_deg = 45.0 * np.sin(0.8 * t_s)
    rate_dps = np.gradient(angle_deg, 1.0 / HZ) + 0.4 + 0.06 * np.random.default_rng(seed).standard_normal(len(t_s))
    return Session("s", t_s, rate_dps, t_host_s=1e9 + t_s, encoder_deg=angle_deg)


def in_file(folder: Path, session: Session) -> Path:
    path = folder / "s.csv"
    write_session(path, [session])
    return path


def filtered(path: Path, out: Path, *options: str) -> tuple[int, float]:
    """Status of `filter`, and the yaw at the end; NaN without one."""
    status = main(["filter", str(path), "--out", str(out), "--force", *options])
    if status:
        assert not out.exists()
        return status, float("nan")
    with out.open() as file:
        return status, float(list(csv.DictReader(file))[-1]["yaw_deg"])


@dataclass(frozen=True, slots=True)
class Wrong:
    """A recording that is not what it says.

    id
        Of the finding.
    option
        That mends it, as the message says it; empty where none does.
    """

    session: Session
    id: str
    option: str = ""


WRONG = {
    **{
        name: Wrong(
            replace(turned(), t_device_s=np.round(turned().t_device_s * per_s)), "clock_unit", f"--time-unit {unit}"
        )
        for name, per_s, unit in (("milliseconds", 1e3, "ms"), ("microseconds", 1e6, "us"), ("nanoseconds", 1e9, "ns"))
    },
    "a thousand a second": Wrong(
        replace(turned(1000.0), t_device_s=np.arange(35_000.0)), "clock_unit", "--time-unit ms"
    ),
    "whole seconds": Wrong(replace(turned(), t_device_s=np.floor(turned().t_device_s)), "clock_stamps"),
    "no clock": Wrong(replace(turned(), t_device_s=np.zeros(len(turned().t_device_s))), "clock_stamps"),
    "sawtooth": Wrong(replace(turned(), t_device_s=turned().t_device_s % 0.2), "clock_unit"),
    "rad/s": Wrong(replace(turned(), rate_dps=np.deg2rad(turned().rate_dps)), "rate_unit", "--rate-unit rads"),
    "rad/s of two digits": Wrong(
        replace(turned(), rate_dps=np.round(turned().rate_dps * radians(1.0), 2)), "rate_unit", "--rate-unit rads"
    ),
    "mdps": Wrong(replace(turned(), rate_dps=turned().rate_dps * 1e3), "rate_unit", "--rate-unit mdps"),
    "57.3 times": Wrong(replace(turned(), rate_dps=np.rad2deg(turned().rate_dps)), "rate_unit", "--rate-unit lsb/57.3"),
}


@pytest.mark.promise("Files of other programs")
@pytest.mark.parametrize("name", WRONG)
def test_a_recording_that_is_not_what_it_says_is_refused(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A recording whose clock or rate contradicts its stated unit is refused, with the option that corrects it."""
    wrong = WRONG[name]
    path, out = in_file(tmp_path, wrong.session), tmp_path / "yaw.csv"
    assert filtered(path, out)[0] == 4
    statement = capsys.readouterr().err
    assert wrong.option in statement
    assert main(["info", str(path)]) == 4
    assert f"! {wrong.id} " in capsys.readouterr().out
    assert main(["doctor", str(path), "--json"]) == 3
    result = {item["id"]: item["severity"] for item in json.loads(capsys.readouterr().out)["findings"]}
    assert result[wrong.id] == "error"
    if wrong.option:
        status, yaw_deg = filtered(path, out, *wrong.option.split())
        assert status == 0
        assert yaw_deg == pytest.approx(TURN_DEG, abs=3.0)


def test_a_recording_that_is_what_it_says_is_left_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for session in (turned(), swung(), turned(20.0), turned(1000.0)):
        assert filtered(in_file(tmp_path, session), tmp_path / "yaw.csv")[0] == 0
        assert [" written: " in line for line in capsys.readouterr().err.splitlines()] == [True]


AGAINST_ENCODER: Mapping[str, tuple[Callable[[Floats], Floats], str]] = {
    "rad/s": (lambda rate: rate * radians(1.0), "--rate-unit rads"),
    "57.3 times": (lambda rate: rate * degrees(1.0), "--rate-unit lsb/57.3"),
    "counts": (lambda rate: np.round(rate * 131.0), "--rate-unit lsb/131"),
    "counts with decimals": (lambda rate: rate * 16.4, "--rate-unit lsb/16.4"),
    "half a range": (lambda rate: rate / 2.1, "--rate-unit lsb/0.47"),
    "sign": (lambda rate: -rate, "--flip"),
    "another axis": (lambda rate: rate[::-1] ** 2 / 150.0, "--columns"),
}


@pytest.mark.promise("Files of other programs")
@pytest.mark.parametrize("name", AGAINST_ENCODER)
@pytest.mark.parametrize("command", ["filter", "compare"])
def test_an_encoder_tells_unit_sign_and_axis(
    command: str, name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """An encoder reveals a wrong unit, sign or axis."""
    as_said, option = AGAINST_ENCODER[name]
    session = swung()
    path = in_file(tmp_path, replace(session, rate_dps=as_said(session.rate_dps)))
    assert main([command, str(path)]) == 4
    statement = capsys.readouterr().err
    assert option in statement
    assert "the encoder turned by" in statement


@pytest.mark.parametrize("command", ["filter", "compare", "tune"])
def test_a_stated_unit_is_taken_by_every_command(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Rate, time and sign at once."""
    session = swung()
    wrong = replace(session, rate_dps=-np.deg2rad(session.rate_dps), t_device_s=session.t_device_s * 1e3)
    (tmp_path / "other").mkdir()
    paths = [in_file(tmp_path, wrong), in_file(tmp_path / "other", wrong)]
    words = {
        "filter": [str(paths[0]), "--out", str(tmp_path / "yaw.csv")],
        "compare": [str(paths[0])],
        "tune": [*map(str, paths), "--out", str(tmp_path / "my.yaml"), "--iterations", "30"],
    }[command]
    assert main([command, *words, "--rate-unit", "rads", "--time-unit", "ms", "--flip"]) == 0
    assert "the rate" not in capsys.readouterr().err


@pytest.mark.promise("Files of other programs")
def test_a_logger_that_restarts_goes_on_as_a_port_does(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A recording whose clock restarts continues one period later, and the time is reported."""
    session = turned()
    t_s = np.where(np.arange(len(session.t_device_s)) < 700, session.t_device_s, session.t_device_s - 13.9)
    path = in_file(tmp_path, replace(session, t_device_s=t_s))
    status, yaw_deg = filtered(path, tmp_path / "yaw.csv")
    assert status == 0
    assert yaw_deg == pytest.approx(TURN_DEG, abs=3.0)
    assert "its clock restarts at sample 701" in capsys.readouterr().err
    assert main(["doctor", str(path), "--json"]) == 0
    result = {item["id"]: item for item in json.loads(capsys.readouterr().out)["findings"]}
    assert (result["restarts"]["severity"], "the 20.98 s after it" in result["restarts"]["says"]) == ("warning", True)


def test_one_damaged_stamp_does_not_end_a_recording(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for stamp_s in (4e5, 1e-3):
        t_s = turned().t_device_s.copy()
        t_s[300] = stamp_s
        status, yaw_deg = filtered(in_file(tmp_path, replace(turned(), t_device_s=t_s)), tmp_path / "yaw.csv")
        assert status == 0
        assert yaw_deg == pytest.approx(TURN_DEG, abs=3.0)
        assert "1 of its times are invalid" in capsys.readouterr().err


def test_samples_that_come_again_are_no_restart() -> None:
    """A logger that writes its last buffer twice."""
    rows = np.concatenate([np.arange(900), np.arange(800, 1750)])
    session = turned()
    again = replace(session, t_device_s=session.t_device_s[rows], rate_dps=session.rate_dps[rows])
    assert [finding.id for finding in examined(again).findings] == []


def test_a_clock_that_stands_gives_way_to_the_times_of_the_log(tmp_path: Path) -> None:
    session = replace(turned(), t_device_s=np.full(len(turned().t_device_s), 7.0), t_host_s=turned().t_device_s + 1e9)
    status, yaw_deg = filtered(in_file(tmp_path, session), tmp_path / "yaw.csv")
    assert status == 0
    assert yaw_deg == pytest.approx(TURN_DEG, abs=3.0)


@pytest.mark.promise("Files of other programs")
def test_a_filter_that_takes_hardly_a_sample_does_not_end_well(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """If a filter accepts fewer than half of the samples, the status is not 0."""
    (tmp_path / "s.csv").write_text("t_device_s,rate_dps\n1,2\n" + "".join(f"{1 - i},2\n" for i in range(10)))
    assert filtered(tmp_path / "s.csv", tmp_path / "yaw.csv")[0] == 4
    assert "the rest is too little for a yaw" in capsys.readouterr().err


def as_counts(rate_dps: Floats) -> Floats:
    return np.round(rate_dps * 65.5)


CHANGES: Sequence[str] = ("57.3", "rad", "ms", "counts")


@pytest.mark.promise("Files of other programs")
@given(
    change=st.sampled_from(CHANGES),
    hz=st.floats(20.0, 900.0),
    noise_dps=st.floats(0.03, 0.3),
    bias_dps=st.floats(-3.0, 3.0),
    seed=st.integers(0, 1000),
    has_encoder=st.booleans(),
)
def test_a_wrong_unit_is_found_or_asked_for(
    change: str, hz: float, noise_dps: float, bias_dps: float, seed: int, *, has_encoder: bool
) -> None:
    """A wrong unit is detected, or leads to a question."""
    session = turned(hz, noise_dps, bias_dps, seed)
    angle_deg = np.interp(session.t_device_s, [15.0, 18.0], [0.0, TURN_DEG])
    session = replace(session, encoder_deg=angle_deg if has_encoder else None)
    assert examined(session).findings == ()
    factor = {"57.3": degrees(1.0), "rad": radians(1.0)}.get(change, 1.0)
    rate_dps = as_counts(session.rate_dps) if change == "counts" else session.rate_dps * factor
    t_s = session.t_device_s * (1e3 if change == "ms" else 1.0)
    findings = examined(replace(session, rate_dps=rate_dps, t_device_s=t_s)).findings
    assert {finding.id for finding in findings} & {"rate_unit", "clock_unit"}
    if has_encoder or change == "ms":
        assert any(finding.is_error for finding in findings)
