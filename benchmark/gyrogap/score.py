"""Score of a folder of answers: open the seals, judge each case, write `score.json`, and draw a table."""

from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

from gyrodrift.values.errors import DataError
from gyrogap.answer import BenchmarkAnswer, is_number, read_answer
from gyrogap.data_set import OnCase, read_manifest
from gyrogap.figures import EFFECT_ROWS, ScoreFigure, figures
from gyrogap.gap_closed import GapClosed, HeldOutGap
from gyrogap.judge import JudgedCase, judged_case
from gyrogap.rows import ROWS, draw_case
from gyrogap.seals import open_seal
from gyrogap.vocabulary import JUDGED_BY, PARAMETERS

MOST_CASES = 10_000
"""Largest number of cases of a row, as of `--count`."""

SCORE = "score.json"
"""The score of a folder of answers, written beside them."""


def judge_answers(folder: Path, seals: Path, answers: Path, on_case: OnCase, *, has_gap: bool) -> list[JudgedCase]:
    """Judge all cases of a data set; `has_gap` simulates the answers on held-out sessions.

    Raises
    ------
    DataError
        There is no answer at all, an answer is malformed, or a seal is broken.
    """
    listed = read_manifest(folder)
    read = {case.case: read_answer(answers / f"{case.case}.json") for case in listed}
    if not any(read.values()):
        raise DataError(f"{answers}: has no answer to a case of {folder}; an answer is CASE.json")
    judged = []
    for number, case in enumerate(listed):
        on_case(number, len(listed))
        label = open_seal(folder, seals, case.case, f"score {answers.name}")
        _check_label(label, seals / f"{case.case}.json")
        answer = read[case.case]
        closed = _closed(label, answer) if has_gap and label["row"] in EFFECT_ROWS else None
        judged.append(judged_case(label, answer, closed))
    on_case(len(listed), len(listed))
    return judged


def _check_label(label: dict[str, Any], path: Path) -> None:
    """Check that a label, which a stranger may have sealed, can be judged.

    Raises
    ------
    DataError
        It is of no row, or its effects cannot be.
    """
    row, effects = label["row"], {effect["name"]: effect["parameters"] for effect in label["effects"]}
    if row not in ROWS or not 0 <= label["number"] < MOST_CASES:
        raise DataError(f"{path}: there is no case {label['number']} of a row {row!r}")
    truths = {name: parameters for name, parameters in effects.items() if name in PARAMETERS}
    if row in EFFECT_ROWS and not truths:
        raise DataError(f"{path}: a case of the row {row} needs an effect of effects.json")
    for name, parameters in truths.items():
        if not all(is_number(value) for value in parameters.values()):
            raise DataError(f"{path}: parameters of {name} must be numbers by name")
        if name in JUDGED_BY and not parameters.get(JUDGED_BY[name]):
            raise DataError(f"{path}: {name} needs the parameter {JUDGED_BY[name]}, and not 0")


def unused_answers(folder: Path, answers: Path) -> list[str]:
    """Names of the JSON files beside the answers that answer no case of a data set; the score is none of them."""
    used = {f"{case.case}.json" for case in read_manifest(folder)} | {SCORE}
    return sorted(path.name for path in answers.glob("*.json") if path.name not in used)


def _closed(label: dict[str, Any], answer: BenchmarkAnswer | None) -> GapClosed:
    """Gap closed by the named causes; an answer of none or unknown alone changes nothing."""
    named = answer.named if answer and answer.verdict != "none" else ()
    return _held_out(label["seed"], label["row"], label["number"]).closed([cause.injected for cause in named])


@cache
def _held_out(seed: int, row: str, number: int) -> HeldOutGap:
    """Held-out sessions of a case, for all answers that are scored in this process."""
    return HeldOutGap(draw_case(seed, row, number))


def score_json(cases: Sequence[JudgedCase]) -> dict[str, Any]:
    """Content of `score.json`."""
    return {
        "cases": len(cases),
        "answered": sum(case.answer is not None for case in cases),
        "figures": [figure.as_json() for figure in figures(cases)],
        "by_case": [_case_json(case) for case in cases],
    }


def _case_json(case: JudgedCase) -> dict[str, Any]:
    top = case.answer.top if case.answer else None
    return {
        "case": case.case,
        "row": case.row,
        "axes": case.axes,
        "size": case.size,
        "truth": {name: dict(parameters) for name, parameters in case.truths.items()},
        "about": case.about,
        "verdict": case.answer.verdict if case.answer else None,
        "causes": {cause.effect: cause.probability for cause in case.answer.causes} if case.answer else {},
        "top": top.effect if top else None,
        "is_right": case.is_right,
        "is_sure_and_wrong": case.is_sure_and_wrong,
        "gap_closed": None if case.closed is None or case.closed.share is None else round(case.closed.share, 3),
    }


def table(cases: Sequence[JudgedCase]) -> list[str]:
    """Lines of a table: figure, value with interval, number of cases."""
    answered = sum(case.answer is not None for case in cases)
    return [f"{len(cases)} cases, {answered} answered", *(_line(figure) for figure in figures(cases))]


def _line(figure: ScoreFigure) -> str:
    if figure.value is None or figure.low is None or figure.high is None:
        return f"{figure.about:68}      -"
    better = "less is better" if figure.is_less_better else ""
    numbers = f"{figure.value:6.3f}  ({figure.low:.3f} to {figure.high:.3f})  {figure.count:4d}"
    return f"{figure.about:68} {numbers}  {better}".rstrip()
