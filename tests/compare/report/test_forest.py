"""Forest plot: positions of dots and bars on a logarithmic axis."""

import re
from xml.etree import ElementTree as ET

import pytest

from gyrodrift.compare.report.tables import DOTS, ForestAxis, forest_axis, scale, strip

AXIS = ForestAxis(0.1, 1000.0)


def positions(svg: str, kind: str, name: str) -> list[float]:
    return [float(str(element.get(name)).rstrip("%")) for element in ET.fromstring(svg).iter(kind)]


def test_factors_are_equally_far_apart() -> None:
    """An error outside of the axis is drawn at its end."""
    percents = [AXIS.percent(error_deg) for error_deg in (0.1, 1.0, 10.0, 100.0, 1000.0)]
    assert percents == pytest.approx([3.0, 26.5, 50.0, 73.5, 97.0])
    assert AXIS.percent(0.0) == 3.0
    assert AXIS.percent(float("inf")) == 97.0


def test_a_row_has_a_dot_a_session_and_a_bar_for_the_mean() -> None:
    """A line goes from the smallest to the largest error, and a dot has a title."""
    svg = strip(AXIS, ["a<b", "c", "d"], [1.0, 100.0, 10.0], 10.0, "two")
    assert sorted(positions(svg, "circle", "cx")) == [26.5, 50.0, 73.5]
    assert positions(svg, "rect", "x") == [50.0]
    (spread,) = (line for line in ET.fromstring(svg).iter("line") if line.get("class") == "spread")
    assert (spread.get("x1"), spread.get("x2")) == ("26.50%", "73.50%")
    assert [title.text for title in ET.fromstring(svg).iter("title")] == ["a<b: 1 deg", "d: 10 deg", "c: 100 deg"]
    assert "mean 10 deg, from 1 to 100" in svg


def test_of_many_sessions_the_best_and_the_worst_are_drawn() -> None:
    """Other dots are drawn at even steps."""
    errors_deg = [0.2 + 0.1 * index for index in range(5000)]
    dots = positions(strip(AXIS, [""] * 5000, errors_deg, 250.0, "two"), "circle", "cx")
    assert len(dots) == DOTS
    assert dots[0] == pytest.approx(AXIS.percent(errors_deg[0]), abs=0.01)
    assert dots[-1] == pytest.approx(AXIS.percent(errors_deg[-1]), abs=0.01)


@pytest.mark.parametrize(
    ("errors_deg", "marks"),
    [
        ([0.02, 30.0], ["0.1", "1", "10"]),
        ([0.3, 0.9], ["0.5", "1"]),
        ([5.0], ["5", "10"]),
        ([0.0, float("inf")], ["0.1", "0.2", "0.5", "1"]),
        ([1e-6, 1e5], ["10⁻⁶", "10⁻⁴", "0.01", "1", "100", "10⁴"]),
    ],
)
def test_an_axis_covers_all_errors_and_has_few_marks(errors_deg: list[float], marks: list[str]) -> None:
    """Marks are at decades, or at 1, 2 and 5."""
    axis = forest_axis(errors_deg)
    assert all(axis.low_deg < error_deg < axis.high_deg for error_deg in errors_deg if 0.0 < error_deg < float("inf"))
    assert re.findall(r">([^<>]+)</text>", scale(axis)) == marks
