"""The pictures of the README: the chart shows the committed figures, the demo moves and rests where it should."""

import re
from pathlib import Path

import numpy as np
import pytest
from pictures import comparison_chart, moving_demo

DOCS = Path(__file__).parents[2] / "docs"
RUN = moving_demo.DemoRun(np.arange(0.0, 60.01, 0.01), np.linspace(0.0, 21.0, 6001), np.zeros(6001))


def test_the_chart_shows_the_figures_of_the_results_page() -> None:
    """`make pictures` was run after the last change of a table."""
    assert (DOCS / "comparison.svg").read_text(encoding="utf-8") == comparison_chart.picture()


def test_a_case_is_tinted_if_another_method_is_better() -> None:
    rows = comparison_chart.rows_of(comparison_chart.REAL)
    assert [row.name for row in rows if row.is_lost] == ["BROAD 01", "BROAD 14"]


def test_a_cell_with_two_errors_is_read_by_its_column(tmp_path: Path) -> None:
    table = tmp_path / "hard.csv"
    table.write_text(
        "case,Euler,start calibration,x-io Fusion,VQF,restlevel\n"
        "drive,1 / 2,3 / 4,5 / 6,7 / 8,9 / 10\nmean of all,1,1,1,1,1\n"
    )
    assert [row.errors_deg["restlevel"] for row in comparison_chart.rows_of(table, 1)] == [10.0]


def test_yaw_errors_are_those_against_the_encoder() -> None:
    lines = [
        {"t_s": index * 0.01, "rate_dps": 10.5, "yaw_deg": index * 0.1, "encoder_deg": 90.0 + index * 0.1}
        for index in range(101)
    ]
    run = moving_demo.run_of(lines)
    assert run.at(1.0) == pytest.approx((0.5, 0.0))


def test_a_reader_who_wants_less_motion_sees_the_end_of_the_minute() -> None:
    """Animations stand under the media query; the needle rests at the last error."""
    picture = moving_demo.draw(RUN)
    still, animated = picture.split("@media (prefers-reduced-motion: no-preference)", 1)
    assert "animation" not in still
    assert "rotate(-21.00deg)" in animated.partition("</style>")[2]


@pytest.mark.parametrize("name", ["demo-moving.svg", "comparison.svg"])
def test_a_picture_fetches_nothing_and_is_small(name: str) -> None:
    text = (DOCS / name).read_text(encoding="utf-8")
    assert re.findall(r"https?://(?!www\.w3\.org/2000/svg)", text) == []
    assert len(text) < 60_000
