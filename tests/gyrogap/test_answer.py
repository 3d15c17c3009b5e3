"""Answers to the open benchmark: read strictly; verdict and named causes follow from the probabilities."""

from pathlib import Path
from typing import Any

import pytest
from gyrogap.answer import BenchmarkAnswer, answer_of, read_answer
from gyrogap.physics.bench import measure
from gyrogap.physics.scene import scene_of
from gyrogap.rows import draw_case
from gyrogap.vocabulary import GROUP_OF, PARAMETERS, effect_of_answer

from gyrodrift.values.errors import DataError

PATH = Path("answers/c0ffee.json")


def answer(*causes: tuple[str, float], none: float = 0.0, unknown: float = 0.0) -> BenchmarkAnswer:
    stated = [{"effect": effect, "probability": probability, "parameters": {}} for effect, probability in causes]
    return answer_of({"causes": stated, "none": none, "unknown": unknown}, PATH)


def test_the_largest_probability_is_the_verdict() -> None:
    assert answer(("latency", 0.6), none=0.3).verdict == "cause"
    assert answer(("latency", 0.3), none=0.3, unknown=0.3).verdict == "none"
    assert answer(("latency", 0.3), unknown=0.3).verdict == "unknown"
    assert answer().verdict == "none"


def test_causes_are_sorted_and_named_from_one_half() -> None:
    """The top cause is named however small its probability is."""
    three = answer(("latency", 0.5), ("warmup", 0.9), ("spikes", 0.4))
    assert [cause.effect for cause in three.named] == ["warmup", "latency"]
    assert three.top is not None
    assert three.top.effect == "warmup"
    assert [cause.effect for cause in answer(("spikes", 0.3), ("latency", 0.2)).named] == ["spikes"]
    assert answer(("spikes", 0.3), none=0.6).named == ()


def test_a_cause_can_be_named_beside_an_unknown_part() -> None:
    partly = answer(("latency", 0.9), unknown=1.0)
    assert partly.verdict == "unknown"
    assert partly.top is not None
    assert answer(("latency", 0.4), unknown=1.0).top is None
    assert answer(("latency", 0.6), none=0.7).top is None


@pytest.mark.parametrize(
    ("stated", "message"),
    [
        ([], "needs an object with the keys causes"),
        ({"causes": {}, "none": 0, "unknown": 0}, "needs an object with the keys causes"),
        ({"causes": [], "none": 0}, "the probability of unknown is None, expected a number from 0 to 1"),
        ({"causes": [], "none": 1.2, "unknown": 0}, "the probability of none is 1.2"),
        ({"causes": [], "none": True, "unknown": 0}, "the probability of none is True"),
        (
            {"causes": [{"effect": "magic", "probability": 1}], "none": 0, "unknown": 0},
            "'magic' is not in effects.json",
        ),
        ({"causes": ["latency"], "none": 0, "unknown": 0}, "effect None is not in effects.json"),
        (
            {"causes": [{"effect": "latency", "probability": 1, "parameters": {"delay_ms": "8"}}]},
            "parameters of latency must be numbers by name",
        ),
        (
            {"causes": [{"effect": "latency", "probability": 1, "parameters": {"delay": 8}}]},
            "latency has no parameter 'delay'; it has delay_ms",
        ),
        ({"causes": [{"effect": "latency", "probability": 0.5}] * 2, "none": 0, "unknown": 0}, "names an effect twice"),
    ],
)
def test_a_malformed_answer_is_an_error_that_names_the_file(stated: Any, message: str) -> None:
    with pytest.raises(DataError, match=r"answers/c0ffee\.json: ") as error:
        answer_of(stated, PATH)
    assert message in str(error.value)


def test_a_file_that_is_not_there_is_no_answer(tmp_path: Path) -> None:
    """A file that is no JSON is an error."""
    assert read_answer(tmp_path / "a.json") is None
    (tmp_path / "a.json").write_text("{")
    with pytest.raises(DataError, match="is no JSON"):
        read_answer(tmp_path / "a.json")


@pytest.mark.parametrize("name", PARAMETERS)
def test_every_effect_of_an_answer_can_be_simulated(name: str) -> None:
    case = draw_case(1, "none", 3)
    plan, device = case.stand.plans[0], case.stand.device
    for value in (None, -1e9, 1e9):
        stated = {} if value is None else {parameter.name: value for parameter in PARAMETERS[name]}
        scene = scene_of(plan, device.sample_hz, ("answer",), device.physics_hz)
        columns = measure(scene, device, 0, (effect_of_answer(name, stated),), ("answer",))
        assert len(columns.seq) > 1000


def test_the_page_has_the_vocabulary() -> None:
    page = (Path(__file__).parents[2] / "benchmark" / "gyrogap.md").read_text()
    rows = {line.split("`")[1]: line for line in page.splitlines() if line.startswith("| `") and line.count("|") == 4}
    for name, parameters in PARAMETERS.items():
        assert all(f"`{parameter.name}` {parameter.unit}: {parameter.about}" in rows[name] for parameter in parameters)
        members = [effect for effect, group in GROUP_OF.items() if group == GROUP_OF[name]]
        assert rows[name].split("|")[2].strip() == (GROUP_OF[name] if len(members) > 1 else "–")
