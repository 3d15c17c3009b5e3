"""Score of the open benchmark: right answers get full marks, wrong ones do not, each figure has its interval."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from gyrogap.answer import AnsweredCause, BenchmarkAnswer
from gyrogap.chance import expected_calibration_error
from gyrogap.figures import ScoreFigure, figures
from gyrogap.gap_closed import GapClosed, gap_closed
from gyrogap.judge import JudgedCase
from gyrogap.physics.kinds import InjectedEffect
from gyrogap.rows import draw_case
from gyrogap.score import score_json, table

TRUTHS: dict[str, dict[str, dict[str, float]]] = {
    "none": {},
    "single": {"latency": {"delay_ms": 8.0}},
    "small": {"latency": {"delay_ms": 1.5}},
    "pair": {"latency": {"delay_ms": 8.0}, "scale_factor": {"error_percent": -1.0}},
    "outside": {},
    "wrong_size": {"temp_scale": {"slope_percent_per_c": 0.02}},
}


def right_answer(row: str) -> BenchmarkAnswer:
    causes = tuple(AnsweredCause(name, 1.0, truth) for name, truth in TRUTHS[row].items())
    return BenchmarkAnswer(causes, none=float(row == "none"), unknown=float(row == "outside"))


def judged(row: str, answer: BenchmarkAnswer | None, axes: int = 1) -> JudgedCase:
    closed = None if row in {"none", "outside"} else GapClosed(4, 0, 1.0)
    return JudgedCase(f"{row}-{axes}", row, axes, "typical", "of a test", TRUTHS[row], answer, closed)


def by_key(cases: list[JudgedCase]) -> dict[str, ScoreFigure]:
    return {figure.key: figure for figure in figures(cases)}


def test_right_answers_are_right_everywhere() -> None:
    """Every share is 1, and every error 0."""
    cases = [judged(row, right_answer(row), axes) for row in TRUTHS for axes in (1, 3)]
    for figure in figures(cases):
        assert figure.value == pytest.approx(0.0 if figure.is_less_better else 1.0), figure.key
        assert figure.value is not None
        assert figure.low is not None
        assert figure.high is not None
        assert figure.low - 1e-9 <= figure.value <= figure.high + 1e-9
    assert all(case.is_right for case in cases)


@pytest.mark.parametrize("answer", [None, BenchmarkAnswer(none=1.0), BenchmarkAnswer(unknown=1.0)])
def test_who_says_nothing_names_nothing(answer: BenchmarkAnswer | None) -> None:
    cases = [judged(row, answer) for row in TRUTHS]
    assert sum(case.is_right for case in cases) == (0 if answer is None else 1)
    figure = by_key(cases)
    assert (figure["single_group"].value, figure["sure_wrong"].value) == (0.0, 0.0)
    assert figure["abstention"].value == float(answer is not None and answer.unknown == 1.0)
    assert figure["missed"].value == float(answer is not None and answer.none == 1.0)


def cause(effect: str, probability: float, **parameters: float) -> AnsweredCause:
    return AnsweredCause(effect, probability, parameters)


def test_a_cause_of_the_right_group_is_half_right() -> None:
    """A low-pass for a delay: group first, effect not; above 0.8 it is sure and wrong, though not of a wrong group."""
    case = judged("single", BenchmarkAnswer((cause("bandwidth", 0.9),)))
    assert (case.effect_first, case.group_first) == (False, True)
    assert (case.is_sure_and_wrong, case.is_sure_of_wrong_group) == (True, False)
    assert not judged("single", BenchmarkAnswer((cause("bandwidth", 0.8),))).is_sure_and_wrong


def test_a_pair_needs_both_and_no_third() -> None:
    """A third cause counts if it is above 0.8."""
    pair = right_answer("pair").causes
    assert not judged("pair", BenchmarkAnswer(pair[:1])).is_right
    assert judged("pair", BenchmarkAnswer((*pair, cause("spikes", 0.7)))).is_right
    assert not judged("pair", BenchmarkAnswer((*pair, cause("spikes", 0.9)))).is_right


def test_a_wrong_size_needs_the_new_size() -> None:
    for slope, is_right in ((0.023, True), (0.025, False), (-0.02, False)):
        answer = BenchmarkAnswer((cause("temp_scale", 1.0, slope_percent_per_c=slope),))
        assert judged("wrong_size", answer).is_right == is_right
    assert judged("wrong_size", BenchmarkAnswer((cause("temp_scale", 1.0),))).parameter_errors == [1.0]


def test_calibration_is_the_distance_of_probability_and_outcome() -> None:
    """Ten statements of 0.9 of which six are true are off by 0.3; all bins are weighed by their statements."""
    stated = [(0.9, number < 6) for number in range(10)]
    assert expected_calibration_error(stated) == pytest.approx(0.3)
    assert expected_calibration_error([*stated, *[(0.0, False)] * 10]) == pytest.approx(0.15)


def test_the_result_is_machine_readable_and_a_table() -> None:
    """A figure without a case has no value, in either."""
    cases = [judged("none", BenchmarkAnswer(none=0.7)), judged("single", None)]
    result = score_json(cases)
    assert (result["cases"], result["answered"]) == (2, 1)
    values = {figure["key"]: figure["value"] for figure in result["figures"]}
    assert (values["false_alarms"], values["single_effect"], values["pair_both"]) == (0.0, 0.0, None)
    assert result["by_case"][0]["verdict"] == "none"
    lines = table(cases)
    assert lines[0] == "2 cases, 1 answered"
    assert next(line for line in lines if line.startswith("pair: both named")).endswith(" -")


def scaled(error_percent: float) -> InjectedEffect:
    return InjectedEffect("scale_factor", {"error_percent": error_percent})


def test_the_truth_closes_the_gap_and_a_wrong_cause_does_not() -> None:
    case = replace(draw_case(2, "none", 0), row="single", effects=(scaled(2.0),))

    def share(*answered: InjectedEffect) -> Any:
        return gap_closed(case, answered).share

    assert share(scaled(2.0)) == pytest.approx(1.0, abs=0.1)
    assert share() == 0.0
    assert 0.2 < share(scaled(1.0)) < 0.8
    assert share(InjectedEffect("clock_drift", {"ppm": 20000.0})) < 0.1


def test_an_answer_replaces_the_effect_that_the_simulator_has() -> None:
    case = replace(draw_case(2, "none", 0), effects=(scaled(2.0),), stated=(scaled(4.0),))
    closed = gap_closed(case, (scaled(2.0),))
    assert closed.share == pytest.approx(1.0, abs=0.1)
    assert closed.gaps > 0


def test_an_effect_too_small_to_see_is_not_counted() -> None:
    case = replace(draw_case(2, "none", 0), effects=(scaled(0.0005),))
    assert gap_closed(case, (scaled(0.0005),)).share is None
    assert not Path("openings.log").exists()
