"""`gyrodrift diagnose` on cases of benchmark/blind: every row that this machine has data for."""

from collections.abc import Callable
from pathlib import Path

from blind.bench_rows import bench_rows
from blind.folder import SetFolder
from blind.prepare import prepare
from blind.rows.table import ROWS
from blind.run import Options, run_set
from blind.tried import open_all

from evaluate.figures import Figure, share_figure

TIMEOUT_S = 3000.0
"""A run that takes longer has failed; on a machine with much else to do, ten minutes are not enough to tell."""


def measure(seed: int, count: int, folder: Path, say: Callable[[str], None]) -> list[Figure]:
    """Shares of the rows that were tried, from `count` cases of each; an interrupted run goes on."""
    cases = SetFolder(folder)
    prepare(cases, seed, rows=[row for row in ROWS if ROWS[row].is_possible()], count=count)
    run_set(cases, Options(oracle=False, timeout_s=TIMEOUT_S), say)
    return [
        share_figure(row.what, row.hits, row.total, is_less_better=row.is_most)
        for row in bench_rows(open_all(cases))
        if row.total
    ]
