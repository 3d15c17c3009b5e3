"""The posterior with all that a report and further questions take from it."""

from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.inference.evidence import Evidence
from gyrodrift.diagnose.inference.posterior import RARE, Posterior
from gyrodrift.diagnose.inference.sets import EffectSet, Placed, Scorer, fitted


@dataclass(frozen=True)
class Explanation:
    """What was found.

    best
        The most probable set that holds all named effects; it may hold more, such as a form that no effect has.
    named
        Effects that are named.
    """

    evidence: Evidence
    scorer: Scorer
    posterior: Posterior
    best: EffectSet
    named: tuple[str, ...]

    def placed(self, names: Collection[str]) -> list[Placed]:
        """Some of the effects of the best set."""
        return [placed for placed in self.best.placed if placed.template.name in names]

    def change(self, names: Collection[str]) -> Floats:
        """(S, F) what some of the effects of the best set change, in the units of the features."""
        change: Floats = self.scorer.change(self.placed(names)) * self.scorer.observation.unit
        return change

    @cached_property
    def held_out(self) -> tuple[Floats, Floats]:
        """(S, F) change and variance by the named effects, in units of the observation.

        Each session is predicted with sizes that were fitted on the others; a single one with its own.
        """
        observation = self.scorer.observation
        change, variance = np.zeros_like(observation.difference), np.zeros_like(observation.difference)
        for row in range(observation.sessions if self.named else 0):
            placed = self._fitted_without(row)
            own, covariance = self.scorer.change(placed), self.scorer.prediction(placed)[1]
            change[row] = own[row]
            total = covariance[:, row, row] + sum(
                one.variance[row] - one.template.scatter[one.point][row] for one in placed
            )
            variance[row] = total - observation.covariance[:, row, row]
        return change, variance

    @cached_property
    def held_out_z(self) -> Floats:
        """(S, F) what each session leaves unexplained, in standard deviations."""
        observation = self.scorer.observation
        if not self.named:
            return self.evidence.z
        change, variance = self.held_out
        sigma = np.sqrt(np.diagonal(observation.covariance, axis1=1, axis2=2).T + variance)
        left: Floats = np.where(observation.is_compared, (observation.difference - change) / sigma, 0.0)
        return left

    def possible(self, *, least: float = RARE) -> list[Placed]:
        """Effects of the catalog that are not named but may act, the most probable first, where they fit best."""
        inclusion = self.posterior.inclusion
        names = [name for name, mass in inclusion.items() if mass > least and not name.startswith("?")]
        others = sorted((name for name in names if name not in self.named), key=lambda name: -inclusion[name])
        return [placed for placed in map(self.where_best, others) if placed is not None]

    def where_best(self, name: str) -> Placed | None:
        """An effect in the most probable set that holds it."""
        holding = [item for item in self.posterior.hypotheses if name in item.names]
        if not holding:
            return None
        best = max(holding, key=lambda item: item.probability)
        return next(placed for placed in best.effect_set.placed if placed.template.name == name)

    def _fitted_without(self, row: int) -> list[Placed]:
        placed = self.placed(self.named)
        others = [other for other in range(self.scorer.observation.sessions) if other != row]
        if not others:
            return placed
        scorer = self.scorer.of_sessions(others)
        begun = tuple(one._replace(template=one.template.of_sessions(others)) for one in placed)
        own = fitted(scorer, EffectSet(begun, 0.0, 0.0)).placed
        found = []
        for one in own:
            template = self.scorer.templates[one.template.name]
            found.append(Placed(*template.place(int(one.template.response[one.point]), one.size), one.form_error))
        return found
