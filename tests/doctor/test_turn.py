"""Columns of a text by one quarter turn: never a wrong column, unit or sign; else a question."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from turn_support import hand_turn, random_board

from gyrodrift.columns.spec import Column, columns_of
from gyrodrift.columns.turn.motion import TurnWindow
from gyrodrift.columns.turn.series import LineTimes, TimedLine, table_of
from gyrodrift.doctor.turn.heard import HeardTurn, TurnResult, result_of
from gyrodrift.doctor.turn.tell import findings_of

Noise = Callable[[float], float]
Lines = Callable[[float, float, float, Noise], str]
"""Lines of one sample: time s, rate deg/s, angle deg, and normal noise of some size."""


def turned(lines_of: Lines, turned_deg: float = 90.0, rate_hz: float = 50.0, lasts_s: float = 1.5) -> TurnResult:
    """The result of a turn to the left of a board that prints such lines."""
    rng = np.random.default_rng(3)
    t_s, rate_dps, angle_deg = hand_turn(rng, turned_deg, rate_hz, lasts_s)
    lines = []
    for now_s, dps, deg in zip(t_s.tolist(), rate_dps.tolist(), angle_deg.tolist(), strict=True):
        text = lines_of(now_s, dps, deg, lambda size: float(rng.normal(0.0, size)))
        lines += [TimedLine(now_s, line.strip()) for line in text.split("\n") if line.strip()]
    return result_of(HeardTurn("board", TurnWindow(0.0, 3.0, float(t_s[-1])), table_of(lines)))


def used(spec: str) -> tuple[str | int, Column]:
    """The column that a SPEC reads yaw by: its label or place, and what it says of it."""
    index, column = next(
        (index, item) for index, item in enumerate(columns_of(spec)) if item.meaning in {"rate", "yaw"}
    )
    return column.label or index, column


@pytest.mark.promise("Text and units")
@given(st.integers(0, 2**32 - 1))
def test_no_form_gives_a_wrong_column_unit_or_sign(seed: int) -> None:
    """`doctor --turn` never prints a wrong column, unit or sign."""
    board = random_board(seed)
    result = result_of(HeardTurn("board", board.window, table_of(board.lines)))
    if not result.is_found:
        assert result.question
        assert not result.spec
        return
    where, column = used(result.spec)
    truth = board.rate if column.meaning == "rate" else board.angle
    assert truth is not None, f"{result.spec}: {board.about}"
    rate = result.verdict.rate
    is_known = rate is None or rate.scale.is_known
    assert where == truth[0], f"{result.spec}: {board.about}"
    assert column.scale / truth[1] == pytest.approx(1.0, rel=0.02 if is_known else 0.25), board.about


@pytest.mark.parametrize("seed", range(6))
def test_a_clean_turn_of_usual_boards_is_told(seed: int) -> None:
    """Questions are for what is not clear: of made-up boards with a rate or an angle most are told."""
    boards = [random_board(1000 * seed + index) for index in range(4)]
    turning = [board for board in boards if board.rate or board.angle]
    actual = [result_of(HeardTurn("board", board.window, table_of(board.lines))).is_found for board in turning]
    assert sum(actual) >= len(actual) - 1


NUMBERS = st.one_of(st.floats(-1e19, 1e19), st.sampled_from([0.0, 1.0, 90.0, -1e17, 1e-300]), st.integers(-999, 999))
ROWS = st.lists(st.one_of(st.lists(NUMBERS, max_size=4).map(lambda row: ",".join(map(str, row))), st.text(max_size=20)))


@given(ROWS, st.sampled_from([0.0, 0.01, 0.5]), st.floats(0.0, 5.0))
def test_any_text_is_told_or_asked_about(rows: list[str], step_s: float, turn_s: float) -> None:
    """Lines of anything, also all at once, never fail, and what is to be pasted is a SPEC."""
    lines = [TimedLine(index * step_s, row.strip()) for index, row in enumerate(rows * 3)]
    result = result_of(HeardTurn("text", TurnWindow(0.0, turn_s, len(lines) * step_s), table_of(lines)))
    assert findings_of(result)
    if result.is_found:
        assert columns_of(result.spec)


def rads(dps: float) -> float:
    return float(np.radians(dps))


REPORT: dict[str, tuple[Lines, str]] = {
    "values under headings of their own": (
        lambda _t, dps, _a, n: (
            f"Accelerometer:\nX = {n(0.01):.2f}\nY = {n(0.01):.2f}\nZ = {1 + n(0.01):.2f}\n"
            f"Gyroscope:\nX = {n(0.1):.2f}\nY = {n(0.1):.2f}\nZ = {n(0.1) - dps:.2f}"
        ),
        "Gyroscope Z=rate:dps:-",
    ),
    "lines of two kinds in turns": (
        lambda _t, dps, _a, n: (
            f"accel {n(0.01):.2f} {n(0.01):.2f} {1 + n(0.01):.2f}\ngyro {n(0.1):.2f} {n(0.1):.2f} {dps + n(0.1):.2f}"
        ),
        "gyro z=rate:dps",
    ),
    "an angle behind a word": (
        lambda _t, _d, deg, n: f"ypr\t{(deg + 330) % 360 - 180 + n(0.01):.2f}\t{n(0.1):.2f}\t{n(0.1):.2f}",
        "ypr x=yaw:deg",
    ),
    "data behind a hash": (
        lambda _t, _d, deg, n: f"#YPR={(200 - deg) % 360 - 180 + n(0.01):.2f},{n(0.1):.2f},{n(0.1):.2f}",
        "YPR x=yaw:deg:-",
    ),
    "a clock of 32 bits that wraps": (
        lambda t_s, dps, _a, n: f"{int(4293e6 + t_s * 1e6) % (1 << 32)},{dps + n(0.1):.2f}",
        "t_us, rate:dps",
    ),
    "a counter beside a clock": (
        lambda t_s, dps, _a, n: f"{round(t_s * 50)},{round(t_s * 1000)},{dps + n(0.1):.2f}",
        "_, t_ms, rate:dps",
    ),
    "a rate beside an angle": (
        lambda _t, dps, deg, n: f"heading:{(40 - deg) % 360:.1f} gz:{dps + n(0.1):.2f}",
        "gz=rate:dps",
    ),
    "counts beside deg/s": (
        lambda _t, dps, _a, n: f"raw:{-131 * dps + n(10):.0f} dps:{-dps + n(0.1):.2f}",
        "dps=rate:dps:-",
    ),
    "counts, and an angle that says how far the turn was": (
        lambda _t, dps, deg, n: f"{131 * dps + n(5):.0f},{deg + 3 + n(0.01):.2f}",
        "rate:lsb/131",
    ),
    "JSON with axes in a list": (
        lambda t_s, dps, _a, n: f'{{"gyro":[{n(0.01):.3f},{n(0.01):.3f},{rads(dps) + n(0.01):.3f}],"ts":{t_s:.3f}}}',
        "gyro.2=rate:rads, ts=t_s",
    ),
    "a dead band that hides all noise": (lambda _t, dps, _a, _n: f"gz:{dps if abs(dps) > 1 else 0:.2f}", "gz=rate:dps"),
    "two values alone, as a slow board says them": (
        lambda _t, dps, _a, _n: f"gx: 0.3 gz: {82.5 if dps > 20 else 0.5}",
        "gz=rate:dps",
    ),
    "a temperature that comes more rarely than the rate": (
        lambda t_s, dps, _a, n: (
            f"gz: {dps + n(0.1):.2f}" + (f"\ntemp: {27 + n(0.1):.1f}" if round(t_s * 50) % 10 == 0 else "")
        ),
        "gz=rate:dps",
    ),
    "a quaternion": (
        lambda _t, _d, deg, _n: f"{np.cos(rads(deg + 200) / 2):.3f},0.01,0.00,{np.sin(rads(deg + 200) / 2):.3f}",
        "q.w, q.x, q.y, q.z",
    ),
    "a quaternion with its scalar last, of a frame that points down": (
        lambda _t, _d, deg, _n: f"0.01,0.00,{-np.sin(rads(deg + 200) / 2):.3f},{np.cos(rads(deg + 200) / 2):.3f}",
        "q.x, q.y, q.z, q.w:-",
    ),
    "two senders, of which one turns": (
        lambda _t, dps, _a, n: f'{{"node":"A","gz":{n(0.1):.2f}}}\n{{"node":"B","gz":{dps + n(0.1):.2f}}}',
        "node=B, gz=rate:dps",
    ),
    "percent of a full scale": (lambda _t, dps, _a, n: f"gz: {0.4 * dps + n(0.04):.2f}", "gz=rate:lsb/0.4"),
    "an angle that drifts": (lambda t_s, _d, deg, n: f"{deg + 0.5 * t_s + n(0.01):.2f},{n(0.1):.2f}", "yaw:deg"),
}


@pytest.mark.parametrize("form", REPORT)
def test_a_form_is_told(form: str) -> None:
    """Column, unit and sign, in the line to paste."""
    lines_of, expected = REPORT[form]
    result = turned(lines_of)
    assert (result.spec, result.question) == (expected, "")


REQUEST: dict[str, tuple[Lines, str]] = {
    "one label for two values of a line": (
        lambda _t, dps, _a, n: f"X: {n(0.01):.2f} Z: {1 + n(0.01):.2f} X: {n(0.1):.2f} Z: {dps + n(0.1):.2f}",
        "more than once",
    ),
    "a device that lies on its edge": (
        lambda _t, dps, _a, n: f"{n(10):.0f},{92 * dps + n(10):.0f},{92 * dps + n(10):.0f}",
        "all turned",
    ),
    "a magnetometer alone": (
        lambda _t, _d, deg, n: (
            f"{100 * np.cos(rads(deg + 30)) + n(1):.0f},{100 * np.sin(rads(deg + 30)) + n(1):.0f},{n(1) - 200:.0f}"
        ),
        "no column shows a quarter turn",
    ),
    "an accelerometer alone, at the end of an arm": (
        lambda _t, dps, deg, n: (
            f"{0.6 * rads(dps) ** 2 + n(0.02):.2f},{0.6 * rads(dps) * np.sign(45 - deg) + n(0.02):.2f},{9.81:.2f}"
        ),
        "",
    ),
    "an angle in a unit that nothing can read": (lambda _t, _d, deg, n: f"{10 * deg + 300 + n(0.5):.0f}", "no column"),
    "nothing that moves": (lambda _t, _d, _a, n: f"gz:{n(0.1):.2f}", "no column moved"),
    "rows of two kinds": (
        lambda _t, dps, _a, n: f"{n(1):.1f},{dps + n(0.1):.2f}\n{n(1):.1f},{5 + n(1):.2f},{7 + n(0.1):.2f}\n",
        "lines of several kinds",
    ),
}


@pytest.mark.promise("Text and units")
@pytest.mark.parametrize("form", REQUEST)
def test_a_form_leaves_a_question(form: str) -> None:
    """`doctor --turn` asks a question if a turn of 80 to 100° is not clear."""
    lines_of, expected = REQUEST[form]
    result = turned(lines_of)
    assert not result.spec, result.spec
    assert expected in result.question
    report = findings_of(result)[0]
    assert (report.severity, report.do != "") == ("error", True)


@pytest.mark.parametrize("turned_deg", [45.0, 180.0, 360.0])
def test_another_turn_than_a_quarter_is_no_unit(turned_deg: float) -> None:
    """A person who turned by something else is asked to do it again."""
    assert "quarter turn" in turned(lambda _t, dps, _a, n: f"{dps + n(0.1):.2f}", turned_deg).question


def test_a_label_that_contradicts_the_turn_is_told() -> None:
    """The turn is a measurement, the label is text."""
    result = turned(lambda _t, dps, _a, n: f"gz: {rads(dps) + n(0.002):.3f} deg/s")
    assert result.spec == "gz=rate:rads"
    assert any("its label says dps" in item.says.lower() for item in findings_of(result))


def test_counts_between_two_sensitivities_are_told_as_measured() -> None:
    """A hand's quarter turn does not tell 131 from 114.28: both are named, and the figure is the measured one."""
    result = turned(lambda _t, dps, _a, n: f"{131 * dps + n(5):.0f}", turned_deg=86.0)
    assert result.spec == "rate:lsb/125"
    report = [item for item in findings_of(result) if item.severity == "warning"]
    assert [("lsb/131" in item.do, "lsb/114.28" in item.do) for item in report] == [(True, True)]


def test_an_upright_axis_is_named() -> None:
    """A board that is mounted on its edge turns about another axis than z."""
    result = turned(lambda _t, dps, _a, n: f"gx:{-dps + n(0.1):.2f} gy:{n(0.1):.2f} gz:{n(0.1):.2f}")
    assert result.spec == "gx=rate:dps:-"
    assert any("x axis of the sensor is vertical" in item.says for item in findings_of(result))


def test_damaged_lines_do_not_move_the_scale() -> None:
    """Numbers that stand out alone by far are passed over."""
    index = iter(range(10_000))
    result = turned(lambda _t, dps, _a, n: "99999" if next(index) % 37 == 5 else f"{rads(dps) + n(0.002):.3f}")
    assert result.spec == "rate:rads"


def test_lines_that_arrive_together_are_spread() -> None:
    """A port that hands on a bunch of lines says when the last of them came."""
    splitter = LineTimes()
    splitter.split(b"0\n", 10.0)
    assert [(line.t_s, line.text) for line in splitter.split(b"1\r\n2\r\n3", 10.4)] == [(10.2, "1"), (10.4, "2")]
    assert [line.text for line in splitter.split(b"4\n", 10.5)] == ["34"]
