"""A case of the benchmark through the real program; `make evaluate` counts how many of many come out right."""

from pathlib import Path

import pytest
from evaluate.gyrogap_methods import diagnose
from gyrogap.data_set import SEALS, make_data_set
from gyrogap.rows import ROWS, draw_case
from gyrogap.score import judge_answers

pytestmark = [pytest.mark.evaluation, pytest.mark.timeout(3600)]


def test_an_effect_of_another_generator_is_named(tmp_path: Path) -> None:
    """A delay, among all effects of the vocabulary."""
    cases = (draw_case(2611, "single", number) for number in range(ROWS["single"].count))
    delayed = next(case for case in cases if [effect.name for effect in case.effects] == ["latency"])
    folder, answers = tmp_path / "set", tmp_path / "answers"
    make_data_set(folder, folder / SEALS, [delayed], lambda done, total: None)
    diagnose.main(folder, answers)
    (judged,) = judge_answers(folder, folder / SEALS, answers, lambda done, total: None, has_gap=False)
    assert judged.is_right, judged.answer
