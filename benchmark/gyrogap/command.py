"""Make or score the open benchmark of causes of the gap between a simulator and recordings.

  make DIR --seed N     write cases with sealed labels; the same seed gives the same bytes.
  score DIR ANSWERS     open the seals, score one JSON file per case, print the table and write score.json.

A case has three recordings of a device and the file of a simulator that does not agree with them. The method under test
reads them and names the cause, or says that there is none, or that it is unknown. benchmark/gyrogap.md has the rules.
"""

import argparse
import sys
from pathlib import Path

from gyrodrift.cli import numbers, options
from gyrodrift.values.errors import UsageError, visible

ACTIONS = ("make", "score")
ROW_NAMES = ("none", "single", "small", "pair", "outside", "wrong_size")
"""Rows of the benchmark; listed here so that the help needs no numerical package."""

EXAMPLES = """\
gyrodrift gyrogap make gyrogap-1 --seed 1
gyrodrift gyrogap make gyrogap-1 --seed 1 --rows none,single --count 3
gyrodrift gyrogap score gyrogap-1 answers
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("action", choices=ACTIONS, help="action of the list above")
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of the data set")
    parser.add_argument("answers", type=Path, nargs="?", metavar="ANSWERS", help="folder of CASE.json files, for score")
    parser.add_argument(
        "--seed", type=numbers.seed, metavar="N", help="seed of the data set, which make needs (default: none)"
    )
    parser.add_argument("--rows", type=_rows, default=[], metavar="ROW,...", help="rows to make (default: all six)")
    parser.add_argument(
        "--count", type=numbers.whole(10000), metavar="N", help="cases of each row (default: 300 cases in all rows)"
    )
    parser.add_argument("--seals", type=Path, metavar="DIR", help="folder of the labels (default: DIR/seals)")
    parser.add_argument(
        "--no-gap-closed", action="store_true", help="leave out the simulation of answers, which takes the longest"
    )
    parser.add_argument("--out", type=Path, metavar="FILE", help="file of the score (default: ANSWERS/score.json)")


def _rows(text: str) -> list[str]:
    rows = [row.strip() for row in text.split(",")]
    unknown = [row for row in rows if row not in ROW_NAMES]
    if unknown:
        raise UsageError(f"--rows: there is no row {unknown[0]}; there are {', '.join(ROW_NAMES)}")
    return rows


def run(arguments: argparse.Namespace) -> int:
    """Make or score; 0 when everything is written."""
    return _make(arguments) if arguments.action == "make" else _score(arguments)


def _make(arguments: argparse.Namespace) -> int:
    if arguments.seed is None or arguments.answers is not None:
        raise UsageError(
            "gyrogap make: needs one folder and --seed N, as in: gyrodrift gyrogap make gyrogap-1 --seed 1"
        )
    from gyrogap.data_set import CASES, SEALS, chosen_cases, make_data_set

    cases = list(chosen_cases(arguments.seed, arguments.rows, arguments.count))
    with options.progress_of(arguments) as progress:
        make_data_set(
            arguments.folder,
            arguments.seals or arguments.folder / SEALS,
            cases,
            lambda done, total: progress.report(CASES, done, total),
        )
    if not arguments.quiet:
        print(f"gyrodrift: {arguments.folder}: {len(cases)} cases written", file=sys.stderr)
    return 0


def _score(arguments: argparse.Namespace) -> int:
    if arguments.answers is None:
        raise UsageError(
            "gyrogap score: needs the folder of the answers, as in: gyrodrift gyrogap score gyrogap-1 answers"
        )
    from gyrogap.data_set import CASES, SEALS
    from gyrogap.json_files import write_json
    from gyrogap.score import SCORE, judge_answers, score_json, table, unused_answers

    with options.progress_of(arguments) as progress:
        cases = judge_answers(
            arguments.folder,
            arguments.seals or arguments.folder / SEALS,
            arguments.answers,
            lambda done, total: progress.report(CASES, done, total),
            has_gap=not arguments.no_gap_closed,
        )
    write_json(arguments.out or arguments.answers / SCORE, score_json(cases))
    unused = unused_answers(arguments.folder, arguments.answers)
    if unused:
        files = f"{arguments.answers}: {len(unused)} JSON files answer no case of {arguments.folder}"
        print(visible(f"gyrodrift: note: {files}, such as {unused[0]}"), file=sys.stderr)
    for line in table(cases):
        print(line)
    return 0
