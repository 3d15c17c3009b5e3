"""Table of several methods on the cases that all of them answered, as Markdown for benchmark/gyrogap.md.

python -m benchmark evaluate.gyrogap_methods.table DATA NAME=ANSWERS ... [--no-gap-closed]
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

from gyrogap.data_set import SEALS
from gyrogap.figures import ScoreFigure, figures
from gyrogap.judge import JudgedCase
from gyrogap.score import judge_answers


def cell(figure: ScoreFigure) -> str:
    """Value and interval, in percent."""
    if figure.value is None or figure.low is None or figure.high is None:
        return "–"
    return f"{100.0 * figure.value:.0f} ({100.0 * figure.low:.0f}–{100.0 * figure.high:.0f})"


def table(methods: dict[str, Sequence[JudgedCase]]) -> list[str]:
    """Lines of the table: a row for each figure, a column for each method."""
    answered = [{case.case for case in cases if case.answer is not None} for cases in methods.values()]
    common = set.intersection(*answered)
    columns = [figures([case for case in cases if case.case in common]) for cases in methods.values()]
    lines = [f"| figure, % | cases | {' | '.join(methods)} |", f"|---|---|{'---|' * len(methods)}"]
    for row in zip(*columns, strict=True):
        better = " (less is better)" if row[0].is_less_better else ""
        count = max(figure.count for figure in row)
        lines.append(f"| {row[0].about}{better} | {count} | {' | '.join(map(cell, row))} |")
    return [f"{len(common)} cases", "", *lines]


def main() -> None:
    """Score each method on all cases and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path)
    parser.add_argument("answers", nargs="+", metavar="NAME=ANSWERS")
    parser.add_argument("--no-gap-closed", action="store_true")
    arguments = parser.parse_args()
    methods: dict[str, Sequence[JudgedCase]] = {}
    for pair in arguments.answers:
        name, _, folder = pair.partition("=")
        methods[name] = judge_answers(
            arguments.data,
            arguments.data / SEALS,
            Path(folder),
            lambda done, total: None,
            has_gap=not arguments.no_gap_closed,
        )
    print("\n".join(table(methods)))


if __name__ == "__main__":
    main()
