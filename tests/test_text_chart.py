"""Charts of text: axes with round numbers, and lines that differ without color."""

import pytest

from gyrodrift.io.text_chart import AxisRange, ChartLine, chart, legend, padded_range, tick_step, ticks


@pytest.mark.parametrize(
    ("span", "most", "step"), [(10.0, 5, 2.0), (10.0, 10, 1.0), (0.31, 4, 0.1), (1.0, 1, 1.0), (700.0, 4, 200.0)]
)
def test_steps_are_1_2_or_5_times_a_power_of_ten(span: float, most: int, step: float) -> None:
    """The smallest of them with no more ticks than asked for."""
    assert tick_step(span, most) == pytest.approx(step)


def test_a_range_holds_all_values_and_ends_at_ticks() -> None:
    assert padded_range([-3.3, 41.0], 1.0) == (-10.0, 50.0)
    assert padded_range([], 2.0) == (-1.0, 1.0)
    low, high = padded_range([5.0, 5.0], 1.0)
    assert low <= 4.5
    assert high >= 5.5
    assert ticks(AxisRange(-1.0, 1.0), 4) == pytest.approx([-1.0, -0.5, 0.0, 0.5, 1.0])


def test_a_chart_has_the_size_that_was_asked_for_and_labels_on_both_axes() -> None:
    """A line from corner to corner."""
    line = ChartLine("rate", [(float(x), float(x)) for x in range(101)], "green")
    rows = [text.plain for text in chart([line], AxisRange(0.0, 100.0), AxisRange(0.0, 100.0), 60, 12)]
    assert [len(row) for row in rows] == [60] * 12
    assert rows[0].startswith("100 ┤")
    assert rows[9].startswith("  0 ┤")
    assert rows[0][-1] not in " ┈"
    assert rows[9][5] not in " ┈"
    assert rows[10].startswith("    └┬")
    assert "50" in rows[11]


def test_lines_differ_without_color() -> None:
    """A dashed line has gaps where a solid one has none."""
    points = [(float(x), 1.0) for x in range(50)]
    plots = []
    for is_dashed in (False, True):
        line = ChartLine("yaw", points, "red", is_dashed=is_dashed)
        plots.append(chart([line], AxisRange(0.0, 49.0), AxisRange(0.0, 2.0), 40, 8)[3].plain)
    assert plots[0] != plots[1]
    assert len(set(plots[0][3:])) == 1
    assert (
        legend([ChartLine("a", [], "red"), ChartLine("b", [], "red", is_dashed=True)], "t:").plain == "t:   ── a   ╌╌ b"
    )
