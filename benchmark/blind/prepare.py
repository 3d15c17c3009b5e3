"""A set before its first run: labels sealed, hashes published, the plan written."""

from collections.abc import Sequence

from blind.folder import Plan, PlannedCase, SetFolder
from blind.seals import seal
from blind.sets import cases_of


class OtherSetError(Exception):
    """The folder holds another set."""


def prepare(
    folder: SetFolder,
    set_name: str,
    seed: int,
    only: Sequence[str] = (),
    rows: Sequence[str] = (),
    count: int | None = None,
) -> None:
    """Seal what is asked for and not sealed yet; no seal is ever made anew.

    Parameters
    ----------
    folder, set_name, seed
        Where, which, with which numbers.
    only
        Parts of titles (`single/latency`) that a case must have one of; empty for the whole set.
    rows, count
        Of the set `bench`: which rows (empty for all), and how many cases of each.

    Raises
    ------
    OtherSetError
        Where the folder belongs to another set or seed, or there is nothing to seal.
    """
    planned = _planned(folder, set_name, seed)
    known = {case.name for case in planned}
    asked = [case for case in cases_of(set_name, seed, rows, count) if case.name not in known]
    new = [case for case in asked if not only or any(part in case.title for part in only)]
    if not new and not planned:
        raise OtherSetError(f"{folder.root}: there is no such case in the set {set_name}")
    if not new:
        return
    seal(folder, (case.label() for case in new))
    cases = [*planned, *(PlannedCase(case.name, case.withhold, case.then) for case in new)]
    folder.write_plan(Plan(set_name, seed, tuple(sorted(cases, key=lambda case: case.name))))


def _planned(folder: SetFolder, set_name: str, seed: int) -> tuple[PlannedCase, ...]:
    if not folder.is_planned():
        return ()
    plan = folder.plan()
    if (plan.set_name, plan.seed) != (set_name, seed):
        raise OtherSetError(f"{folder.root}: holds the set {plan.set_name} of seed {plan.seed}; give another --out")
    return plan.cases
