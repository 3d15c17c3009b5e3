"""Figures of the score: shares with Wilson's interval; medians and calibration with a bootstrap over cases."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from gyrogap.chance import expected_calibration_error, wilson
from gyrogap.judge import NEAR, JudgedCase

RESAMPLES = 1000
"""Samples of a bootstrap: percentiles need a thousand (Efron and Tibshirani 1993, chapter 13)."""

EFFECT_ROWS = ("single", "small", "pair", "wrong_size")


@dataclass(frozen=True, slots=True)
class ScoreFigure:
    """A figure with its 95 % interval.

    key
        Name in `score.json`.
    value, low, high
        None without cases.
    count
        Number of cases, or of values for a median.
    is_less_better
        Whether a smaller value is better.
    """

    key: str
    about: str
    value: float | None
    low: float | None
    high: float | None
    count: int
    is_less_better: bool = False

    def as_json(self) -> dict[str, Any]:
        """Fields, rounded to four digits."""
        fields = asdict(self)
        return {name: float(f"{value:.4g}") if isinstance(value, float) else value for name, value in fields.items()}


def figures(cases: Sequence[JudgedCase]) -> list[ScoreFigure]:
    """All figures of a set of answers."""
    with_effect = [case for case in cases if case.row in EFFECT_ROWS]
    return [
        *_row_figures(cases),
        _share("sure_wrong", "a cause above 0.8 that is not there", cases, _sure_wrong, is_less_better=True),
        _share(
            "sure_wrong_group",
            "a cause above 0.8 of a group that is not there",
            cases,
            lambda case: case.is_sure_of_wrong_group,
            is_less_better=True,
        ),
        _share("abstention", "known effects: the answer is unknown", with_effect, _abstains, is_less_better=True),
        _share("missed", "known effects: the answer is none", with_effect, _quiet, is_less_better=True),
        _calibration(cases),
        *_parameter_figures(with_effect),
        _gap_figure(with_effect),
    ]


def _row_figures(cases: Sequence[JudgedCase]) -> list[ScoreFigure]:
    def of(row: str, axes: int | None = None) -> list[JudgedCase]:
        return [case for case in cases if case.row == row and axes in (None, case.axes)]

    single, small, pair, wrong = of("single"), of("small"), of("pair"), of("wrong_size")
    return [
        _share("false_alarms", "no gap: the answer is not none", of("none"), _alarm, is_less_better=True),
        _share("single_effect", "single: effect first", single, _effect_first),
        _share("single_group", "single: group first", single, _group_first),
        _share("single_effect_1_axis", "single, one axis: effect first", of("single", 1), _effect_first),
        _share("single_effect_3_axes", "single, three axes: effect first", of("single", 3), _effect_first),
        _share("small_effect", "small: effect first", small, _effect_first),
        _share("small_group", "small: group first", small, _group_first),
        _share("pair_both", "pair: both named, nothing else above 0.8", pair, _right),
        _share("pair_one", "pair: one of them first", pair, _effect_first),
        _share("outside_unknown", "outside: unknown", of("outside"), _abstains),
        _share("wrong_size_effect", "wrong size: effect first", wrong, _effect_first),
        _share("wrong_size_near", "wrong size: effect first, size within 20 %", wrong, _right),
    ]


def _alarm(case: JudgedCase) -> bool:
    return not case.is_quiet


def _quiet(case: JudgedCase) -> bool:
    return case.is_quiet


def _effect_first(case: JudgedCase) -> bool:
    return case.effect_first


def _group_first(case: JudgedCase) -> bool:
    return case.group_first


def _right(case: JudgedCase) -> bool:
    return case.is_right


def _abstains(case: JudgedCase) -> bool:
    return case.abstains


def _sure_wrong(case: JudgedCase) -> bool:
    return case.is_sure_and_wrong


def _share(
    key: str,
    about: str,
    cases: Sequence[JudgedCase],
    rule: Callable[[JudgedCase], bool],
    *,
    is_less_better: bool = False,
) -> ScoreFigure:
    hits, total = sum(map(rule, cases)), len(cases)
    low, high = wilson(hits, total)
    value = hits / total if total else None
    return ScoreFigure(key, about, value, low if total else None, high if total else None, total, is_less_better)


def _calibration(cases: Sequence[JudgedCase]) -> ScoreFigure:
    stated = [case.stated for case in cases if case.stated]

    def error(chosen: Iterable[Sequence[tuple[float, bool]]]) -> float:
        return expected_calibration_error([pair for pairs in chosen for pair in pairs])

    about = "expected calibration error of all stated probabilities"
    return _bootstrapped("ece", about, stated, error, is_less_better=True)


def _parameter_figures(cases: Sequence[JudgedCase]) -> list[ScoreFigure]:
    errors = [case.parameter_errors for case in cases if case.parameter_errors]
    values = [error for of_case in errors for error in of_case]
    hits = sum(error <= NEAR for error in values)
    low, high = wilson(hits, len(values))
    median = _bootstrapped(
        "parameter_error",
        "median relative error of the size of true effects that are named",
        errors,
        lambda chosen: float(np.median([error for of_case in chosen for error in of_case])),
        is_less_better=True,
    )
    share = hits / len(values) if values else None
    return [median, ScoreFigure("parameter_near", "sizes within 20 %", share, low, high, len(values))]


def _gap_figure(cases: Sequence[JudgedCase]) -> ScoreFigure:
    """A share below 0 counts as 0: such an answer makes the simulator worse, however much."""
    closed = [
        [max(0.0, case.closed.share)] for case in cases if case.closed is not None and case.closed.share is not None
    ]
    about = "mean share of the gap that the answer closes on held-out sessions"
    return _bootstrapped(
        "gap_closed",
        about,
        closed,
        lambda chosen: float(np.mean([shares[0] for shares in chosen])),
        is_less_better=False,
    )


def _bootstrapped(
    key: str, about: str, values: Sequence[Any], statistic: Callable[[Sequence[Any]], float], *, is_less_better: bool
) -> ScoreFigure:
    """A statistic over cases, with the percentile interval of a bootstrap."""
    if not values:
        return ScoreFigure(key, about, None, None, None, 0, is_less_better)
    drawn = np.random.default_rng(0).integers(0, len(values), (RESAMPLES, len(values)))
    resampled = [statistic([values[index] for index in indices]) for indices in drawn.tolist()]
    low, high = np.percentile(resampled, [2.5, 97.5]).tolist()
    return ScoreFigure(key, about, statistic(values), low, high, len(values), is_less_better)
