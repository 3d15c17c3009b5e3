"""Progress of a whole tuning: searches of several filters, as one total."""

from gyrodrift.io.progress import TOTAL, OnProgress
from gyrodrift.tune.tuning import REDUCED_EVALUATIONS, Plan

WEIGHTS = {"hdr": 1, "restlevel": 3}
"""Duration of an evaluation relative to HDR by CARLA: measured, `gyrodrift tune` on 6 sessions of 10 minutes."""


class TotalProgress:
    """Passes on the progress of each search, and adds the total of all searches.

    Parameters
    ----------
    sessions
        Number of sessions if each is held out in turn, else 0.
    """

    def __init__(self, plans: tuple[Plan, ...], sessions: int, progress: OnProgress) -> None:
        self._progress = progress
        self._total = sum(_weight(plan) * _evaluations(plan, sessions) for plan in plans)
        self._done: dict[tuple[str, str], int] = {}

    def of_plan(self, plan: Plan) -> OnProgress:
        """Progress for the searches of a plan."""

        def report(search: str, done: int, total: int) -> None:
            self._progress(search, done, total)
            self._done[plan.filter.name, search] = _weight(plan) * done
            self._progress(TOTAL, min(sum(self._done.values()), self._total), self._total)

        return report


def _weight(plan: Plan) -> int:
    return WEIGHTS.get(plan.filter.name, max(WEIGHTS.values()))


def _evaluations(plan: Plan, sessions: int) -> int:
    """Evaluations of all searches: of each seed, of the reduced model, and without each session."""
    model = plan.filter.reduced_model
    is_reduced = {axis.name for axis in plan.axes} != set(model.names)
    reduced = min(REDUCED_EVALUATIONS, plan.evaluations) if is_reduced else 0
    return (len(plan.seeds) + sessions) * plan.evaluations + reduced
