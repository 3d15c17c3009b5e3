"""`gyrodrift diagnose` on a sample of the open benchmark gyrogap: shares of its score."""

from collections.abc import Callable
from pathlib import Path

from gyrogap.data_set import MANIFEST, SEALS, chosen_cases, make_data_set
from gyrogap.figures import figures
from gyrogap.score import judge_answers

from evaluate.figures import Figure, share_figure
from evaluate.gyrogap_methods import diagnose

SHARES = (
    "false_alarms",
    "single_effect",
    "single_group",
    "small_effect",
    "pair_both",
    "outside_unknown",
    "wrong_size_near",
    "sure_wrong",
    "sure_wrong_group",
)


def measure(seed: int, count: int, folder: Path, say: Callable[[str], None]) -> list[Figure]:
    """Shares from `count` cases of each row; an interrupted run goes on."""
    data, answers = folder / "data", folder / "answers"
    if not (data / MANIFEST).exists():
        make_data_set(data, data / SEALS, list(chosen_cases(seed, [], count)), lambda done, total: None)
    diagnose.main(data, answers)
    cases = judge_answers(data, data / SEALS, answers, lambda done, total: None, has_gap=False)
    chosen = [figure for figure in figures(cases) if figure.key in SHARES]
    say(f"{len(cases)} cases of gyrogap")
    return [
        share_figure(
            figure.about, round(figure.value * figure.count), figure.count, is_less_better=figure.is_less_better
        )
        for figure in chosen
        if figure.value is not None
    ]
