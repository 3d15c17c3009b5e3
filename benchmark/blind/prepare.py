"""A set before its first run: labels sealed, hashes published, the plan written."""

import secrets
from collections.abc import Sequence

from gyrogap.seals import HASHES, seal_label

from blind.folder import Plan, PlannedCase, SetFolder
from blind.rows.table import draw_rows

SALT_BYTES = 16


class OtherSetError(Exception):
    """The folder holds another set."""


def prepare(
    folder: SetFolder, seed: int, rows: Sequence[str] = (), count: int | None = None, only: Sequence[str] = ()
) -> None:
    """Seal what is asked for and not sealed yet; no seal is ever made anew.

    Parameters
    ----------
    folder, seed
        Where, with which numbers.
    rows, count
        Which rows (empty for all), and how many cases of each.
    only
        Parts of titles (`single/3/latency`) that a case must have one of; empty for all cases.

    Raises
    ------
    OtherSetError
        Where the folder belongs to another seed, or there is nothing to seal.
    """
    planned = _planned(folder, seed)
    known = {case.name for case in planned}
    asked = [case for case in draw_rows(seed, list(rows), count) if case.name not in known]
    new = [case for case in asked if not only or any(part in case.title for part in only)]
    if not new and not planned:
        raise OtherSetError(f"{folder.root}: there is no such case")
    if not new:
        return
    hashes = folder.hashes()
    for case in new:
        hashes[case.name] = seal_label(folder.seals, secrets.token_hex(SALT_BYTES), case.label())
    folder.write(HASHES, dict(sorted(hashes.items())))
    cases = [*planned, *(PlannedCase(case.name, case.draft.withhold, case.draft.then) for case in new)]
    folder.write_plan(Plan(seed, tuple(sorted(cases, key=lambda case: case.name))))


def _planned(folder: SetFolder, seed: int) -> tuple[PlannedCase, ...]:
    if not folder.is_planned():
        return ()
    plan = folder.plan()
    if plan.seed != seed:
        raise OtherSetError(f"{folder.root}: holds cases of seed {plan.seed}; give another --out")
    return plan.cases
