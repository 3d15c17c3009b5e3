"""A set before its first run: labels sealed, hashes published, the plan written."""

from blind.folder import Plan, PlannedCase, SetFolder
from blind.generator.recipes import recipes
from blind.seals import seal


class OtherSetError(Exception):
    """The folder holds another set."""


def prepare(folder: SetFolder, set_name: str, seed: int, only: list[str]) -> None:
    """Seal a set once; a folder that has been sealed is left as it is.

    Parameters
    ----------
    folder, set_name, seed
        Where, which, with which numbers.
    only
        Parts of titles (`single/latency`) that a case must have one of; empty for the whole set.

    Raises
    ------
    OtherSetError
        Where the folder belongs to another set or seed.
    """
    if folder.is_planned():
        plan = folder.plan()
        if (plan.set_name, plan.seed) != (set_name, seed):
            raise OtherSetError(f"{folder.root}: holds the set {plan.set_name} of seed {plan.seed}; give another --out")
        return
    chosen = [recipe for recipe in recipes(set_name, seed) if not only or any(part in recipe.title for part in only)]
    seal(folder, (recipe.label() for recipe in chosen))
    cases = sorted((PlannedCase(recipe.name, recipe.withhold) for recipe in chosen), key=lambda case: case.name)
    folder.write_plan(Plan(set_name, seed, tuple(cases)))
