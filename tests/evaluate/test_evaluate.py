"""The evaluation: what counts as worse, what is printed and kept, and small cases of what it measures."""

from dataclasses import replace
from pathlib import Path

import pytest

pytest.importorskip("numba", reason="comparing needs the workstation extra")
from evaluate import command
from evaluate.everyday_motions import session
from evaluate.everyday_part import error_of
from evaluate.figures import Figure, mean_figure, share_figure
from evaluate.last import LAST, Measured, is_worse, read_last, worse_than, write_last
from evaluate.parts import PARTS, Part
from evaluate.round_trip_part import effect_text, names_first_or_tied

pytestmark = pytest.mark.xdist_group("restlevel_kernel")

RESULT = share_figure("effect named first", 18, 20)
ALARMS = share_figure("false alarms", 2, 20, is_less_better=True)
ERROR = mean_figure("E in deg", [1.0, 2.0, 3.0])


@pytest.mark.parametrize(
    ("before", "value", "verdict"),
    [
        (RESULT, 0.85, False),
        (RESULT, 0.84, True),
        (RESULT, 1.0, False),
        (ALARMS, 0.15, False),
        (ALARMS, 0.16, True),
        (ALARMS, 0.0, False),
        (ERROR, 2.19, False),
        (ERROR, 2.21, True),
        (ERROR, 0.1, False),
    ],
)
def test_a_figure_is_worse_beyond_its_margin_in_its_bad_direction(
    before: Figure, value: float, *, verdict: bool
) -> None:
    assert is_worse(before, replace(before, value=value)) is verdict


def test_a_figure_that_is_gone_is_worse_and_other_cases_are_not_compared() -> None:
    last = Measured("2026-01-01", 1, 20, (RESULT, ALARMS))
    assert worse_than(last, replace(last, figures=(RESULT,))) == ["false alarms"]
    assert worse_than(last, replace(last, seed=2, figures=(RESULT,))) == []


def test_intervals_are_of_wilson_and_of_a_bootstrap() -> None:
    assert (RESULT.low, RESULT.high) == pytest.approx((0.699, 0.972), abs=1e-3)
    assert ERROR.low < ERROR.value < ERROR.high
    assert mean_figure("E in deg", [2.0]).low == mean_figure("E in deg", [2.0]).high == 2.0


def test_the_command_compares_keeps_and_fails_where_something_became_worse(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    hits = iter([18, 18, 10, 1])
    part = Part("of a test", 1, 20, lambda seed, count, folder, say: [share_figure("right", next(hits), count)])
    monkeypatch.setattr(command, "PARTS", {"toy": part})
    words = ["--last", str(tmp_path / "last.json"), "--out", str(tmp_path)]
    assert command.main([*words, "--update"]) == 0
    assert command.main(["toy", *words]) == 0
    assert "last 90 %" in capsys.readouterr().out
    assert command.main(words) == 1
    printed = capsys.readouterr()
    assert "50 %" in printed.out
    assert "WORSE" in printed.out
    assert "worse than the last figure by more than the margin: toy: right" in printed.err
    assert command.main([*words, "--count", "30"]) == 0


def test_a_part_that_there_is_not_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        command.main(["yaw"])
    assert "there is no part yaw; there are diagnose" in capsys.readouterr().err


def test_the_committed_figures_are_of_parts_that_there_are(tmp_path: Path) -> None:
    last = read_last()
    assert last.keys() <= PARTS.keys()
    write_last(last, tmp_path / "again.json")
    assert (tmp_path / "again.json").read_bytes() == LAST.read_bytes()


@pytest.mark.parametrize("motion", ["car", "robot arm", "turntable"])
def test_after_a_rest_an_everyday_motion_keeps_its_yaw(motion: str) -> None:
    item = session(motion, 1, is_still=True, seed=3)
    assert error_of("restlevel", item) < max(0.5, 0.5 * error_of("euler", item))


def test_a_round_trip_counts_an_effect_that_comes_first_or_is_tied_with_the_first() -> None:
    """A second cause, and none, are misses; the option has the parameters of the size."""
    causes = [{"effect": "latency", "tied_with": ["bandwidth"]}, {"effect": "spikes", "tied_with": []}]
    hits = {name: names_first_or_tied({"causes": causes}, name) for name in ("latency", "bandwidth", "spikes")}
    assert hits == {"latency": True, "bandwidth": True, "spikes": False}
    assert not names_first_or_tied({"causes": []}, "latency")
    assert effect_text("spikes", "typical") == "spikes:height_dps=50.0,share_percent=0.1"
