"""The horizon of text: which side is the ground."""

import pytest

from gyrodrift.top.view import horizon

ROWS = 9
FULL = chr(0x28FF)


def ground_of(roll_deg: float, pitch_deg: float) -> list[str]:
    return [row.plain for row in horizon(roll_deg, pitch_deg, ROWS)]


def share(rows: list[str]) -> float:
    text = "".join(rows)
    return sum(character not in " ─┼" for character in text) / len(text)


def test_a_level_device_has_sky_above_and_ground_below() -> None:
    rows = ground_of(0.0, 0.0)
    assert [len(row) for row in rows] == [2 * ROWS] * ROWS
    assert rows[:4] == [" " * 2 * ROWS] * 4
    assert rows[5:] == [FULL * 2 * ROWS] * 4
    assert "┼" in rows[4]


def test_the_horizon_rises_on_the_right_when_the_right_side_is_down() -> None:
    for roll_deg, raised, sunk in ((30.0, slice(-4, None), slice(0, 4)), (-30.0, slice(0, 4), slice(-4, None))):
        rows = ground_of(roll_deg, 0.0)
        assert share([row[raised] for row in rows]) > share([row[sunk] for row in rows]) + 0.2


def test_the_nose_goes_up_into_the_sky() -> None:
    up, level, down = (share(ground_of(0.0, pitch_deg)) for pitch_deg in (-20.0, 0.0, 20.0))
    assert up < level - 0.1 < level + 0.1 < down


def test_upside_down_the_ground_is_above() -> None:
    rows = ground_of(180.0, 0.0)
    assert rows[0] == FULL * 2 * ROWS
    assert rows[-1] == " " * 2 * ROWS


@pytest.mark.parametrize("pitch_deg", [-90.0, 90.0])
def test_straight_up_or_down_there_is_one_of_them_alone(pitch_deg: float) -> None:
    rows = ground_of(0.0, pitch_deg)
    assert rows[0] == (FULL if pitch_deg > 0.0 else " ") * 2 * ROWS
    assert rows[-1] == (FULL if pitch_deg > 0.0 else " ") * 2 * ROWS
