"""Methods on the open benchmark: what they read, and what becomes of a diagnosis."""

import json
from pathlib import Path

import numpy as np
import pytest
from evaluate.gyrogap_methods.cases import case_features, read_case
from evaluate.gyrogap_methods.diagnose import answer_of
from evaluate.gyrogap_methods.rate_error import rate_error
from evaluate.gyrogap_methods.table import table
from evaluate.gyrogap_methods.training import training_line
from gyrogap.answer import BenchmarkAnswer
from gyrogap.answer import answer_of as checked
from gyrogap.judge import JudgedCase
from gyrogap.rows import draw_case


def test_a_diagnosis_becomes_an_answer() -> None:
    """Causes with their values; the probabilities of no gap and of an unknown cause."""
    gap = {
        "verdict": "effect",
        "probability_of_no_gap": 0.01,
        "probability_of_unknown": 0.04,
        "causes": [
            {
                "effect": "latency",
                "probability": 0.95,
                "parameters": {"delay_ms": {"value": 8.2, "low": 7.9, "high": 8.5, "unit": "ms"}},
            }
        ],
    }
    answer = checked(json.loads(json.dumps(answer_of(gap))), Path("a.json"))
    assert answer.top is not None
    assert (answer.top.effect, answer.top.parameters) == ("latency", {"delay_ms": 8.2})
    assert (answer.none, answer.unknown) == (0.01, 0.04)


@pytest.mark.parametrize("number", [0, 3])
def test_a_method_reads_what_was_written(number: int, tmp_path: Path) -> None:
    """The columns of the files, with one axis and with three; features as for a training case."""
    case = draw_case(8, "wrong_size", number)
    case.write(tmp_path / case.name)
    public = read_case(tmp_path / case.name)
    assert len(public.sessions) == 3
    assert (public.sessions[0].axes is None) == (case.axes == 1)
    features = case_features(public.sessions, public.simulator)
    trained = training_line(8, "wrong_size", number)["features"]
    assert features.keys() == trained.keys()
    assert features["scale"] == pytest.approx(trained["scale"], abs=1e-6)
    assert features[f"stated {case.effects[0].name}"] != 0.0


def test_regressors_are_the_rate_error_of_an_effect_of_size_1() -> None:
    """A scale error of 2 % is twice its regressor."""
    case = draw_case(8, "none", 1)
    columns = case.stand.batch((), case.path).columns(0)
    simulator = {"base": {"noise_dps_rthz": 0.004, "encoder_cpr": 36000}, "effects": []}
    before = rate_error(columns, simulator)
    twice = rate_error(columns, {**simulator, "effects": [{"name": "scale_factor", "error_percent": 2.0}]})
    assert before.error_dps - twice.error_dps == pytest.approx(2.0 * before.regressors["scale_factor"])
    still = before.error_dps[:50]
    assert np.std(still) == pytest.approx(before.sigma_dps, rel=1.0)


def test_the_table_compares_methods_on_the_cases_that_all_answered() -> None:
    cases = [JudgedCase(name, "none", 1, "", "", {}, BenchmarkAnswer(none=1.0)) for name in ("a", "b")]
    lines = table({"ours": cases, "theirs": [cases[0], JudgedCase("b", "none", 1, "", "", {}, None)]})
    assert lines[0] == "1 cases"
    assert lines[2] == "| figure, % | cases | ours | theirs |"
    assert lines[4].startswith("| no gap: the answer is not none (less is better) | 1 | 0 (0–79) |")
