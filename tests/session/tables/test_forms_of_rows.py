"""Rows in other orders and forms: newest first, senders in blocks, axes of quaternions, counts without a sign."""

from collections.abc import Callable
from math import cos, radians, sin
from pathlib import Path

import pytest
from tables_support import BIAS_DPS, TURN_DEG, filtered_yaw_deg, samples, written

from gyrodrift.columns.spec import columns_of
from gyrodrift.session.checks.stated import AS_WRITTEN, ReadingOptions, session_as_stated
from gyrodrift.values.errors import DataError

STEP_S = 0.05
Line = Callable[[int, float, float], str]


def lines(row: Line) -> list[str]:
    return [row(n, t, r) for n, t, r in samples(STEP_S)]


def yaw_deg(path: Path, spec: str = "") -> float:
    """Yaw of `gyrodrift filter`; the question is an exception of the reader."""
    options = ReadingOptions(columns_of(spec)) if spec else AS_WRITTEN
    session_as_stated(path, options)
    return filtered_yaw_deg(path, *(["--columns", spec] if spec else []))


def clock(t_s: float) -> str:
    seconds, ms = divmod(round(1e3 * t_s) + 35_990_000, 1000)
    return f"{seconds // 3600},{seconds // 60 % 60},{seconds % 60},{ms}"


def compact(t_s: float) -> str:
    hour, minute, second, ms = map(int, clock(t_s).split(","))
    return f"{hour}{minute:02d}{second:02d}{ms:03d}"


READ: dict[str, tuple[str, Line, int]] = {
    "newest first": ("t_ms,gz_dps", lambda n, t, r: f"{1e3 * t:.0f},{r:.3f}", -1),
    "hour to millisecond": ("hour,minute,second,ms,gz_dps", lambda n, t, r: f"{clock(t)},{r:.3f}", 1),
    "minus of typography": ("t_s;gz_dps", lambda n, t, r: f"{t:.3f};{r - 1.0:.3f}".replace("-", "\u2212"), 1),
    "kinds of rows": (
        "IMU,t_ms,gz_dps\nGPS,t_ms,lat,lon",
        lambda n, t, r: f"IMU,{1e3 * t:.0f},{r:.3f}" + f"\nGPS,{1e3 * t:.0f},48.1,11.5" * (n % 3 == 0),
        1,
    ),
}


@pytest.mark.parametrize("form", READ)
def test_it_is_read(form: str, tmp_path: Path) -> None:
    head, row, order = READ[form]
    path = written(tmp_path / "s.csv", "\n".join([head, *lines(row)[::order]]) + "\n")
    assert yaw_deg(path) == pytest.approx(TURN_DEG, abs=2.0)


def pair(n: int, r: float) -> float:
    return r if n % 2 else 0.3


ASKED: dict[str, tuple[str, Callable[[], list[str]], str, str]] = {
    "senders in blocks": (
        "t_ms,device,gz_dps",
        lambda: [
            *(f"{1e3 * t:.0f},A,{r:.3f}" for _, t, r in samples(0.02)),
            *lines(lambda n, t, r: f"{1e3 * t:.0f},B,0.2"),
        ],
        r"its times start again where device changes \(A, B\)",
        "t_ms=t_ms, device=A, gz_dps=rate:dps",
    ),
    "HHMMSSmmm": (
        "time,gz_dps",
        lambda: lines(lambda n, t, r: f"{compact(t)},{r:.3f}"),
        "jumps where a minute ends, so it is HHMMSS",
        "time=t:hms, gz_dps=rate:dps",
    ),
    "address of the sender": (
        "",
        lambda: lines(lambda n, t, r: f"24:6F:28:AE:0{1 + n % 2}:10 t_ms:{1e3 * t:.0f} gz:{pair(n, r):.3f} dps"),
        "the sender that you mean .24:6F:28:AE:01:10",
        "t_ms=t_ms, gz=rate:dps, sender=24:6F:28:AE:02:10",
    ),
    "a label twice": (
        "t_ms,gz_dps,gz_dps.1",
        lambda: lines(lambda n, t, r: f"{1e3 * t:.0f},0.2,{r:.3f}"),
        r"gz_dps and gz_dps.1 may each be the yaw rate",
        "t_ms=t_ms, gz_dps.1=rate",
    ),
    "counts without a sign": (
        "t_ms,gz_raw",
        lambda: lines(lambda n, t, r: f"{1e3 * t:.0f},{round(131 * (r - BIAS_DPS - 0.4)) % 65_536}"),
        "does not say which column is the rate and in which unit",
        "t_ms=t_ms, gz_raw=rate:lsb/131",
    ),
}


@pytest.mark.parametrize("form", ASKED)
def test_it_is_asked_and_the_answer_is_read(form: str, tmp_path: Path) -> None:
    head, rows, message, spec = ASKED[form]
    path = written(tmp_path / "s.csv", "\n".join([head, *rows()]).lstrip("\n") + "\n")
    with pytest.raises(DataError, match=message):
        yaw_deg(path)
    assert yaw_deg(path, spec) == pytest.approx(TURN_DEG, abs=2.0)


@pytest.mark.parametrize(
    ("labels", "order", "spec"),
    [
        ("qw,qx,qy,qz", "w0s0", "qw=q.w, qx=q.y, qy=q.z, qz=q.x"),
        ("q0,q1,q2,q3", "00sw", "q0=q.x, q1=q.y, q2=q.z, q3=q.w"),
    ],
    ids=["y up", "scalar last"],
)
def test_a_quaternion_that_turns_about_another_axis_is_asked(
    labels: str, order: str, spec: str, tmp_path: Path
) -> None:
    angle_deg = 0.0
    rows = [f"time_s,{labels}"]
    for _, t, r in samples(STEP_S):
        angle_deg += (r - BIAS_DPS) * STEP_S
        half = radians(0.5 * angle_deg)
        parts = {"w": cos(half), "s": sin(half), "0": 0.001}
        rows.append(",".join([f"{t:.3f}", *(f"{parts[part]:.6f}" for part in order)]))
    path = written(tmp_path / "s.csv", "\n".join(rows) + "\n")
    with pytest.raises(DataError, match=r"its quaternion turns about [xy], not about z: ") as error:
        yaw_deg(path, "" if labels == "qw,qx,qy,qz" else "time_s=t_s, q0=q.w, q1=q.x, q2=q.y, q3=q.z")
    assert f"--columns 'time_s=t_s, {spec}'" in str(error.value)
    assert yaw_deg(path, f"time_s=t_s, {spec}") == pytest.approx(TURN_DEG, abs=2.0)
