"""The posterior with its named effects, and predictions by them."""

from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gyrodrift.diagnose.inference.evidence import Evidence
from gyrodrift.diagnose.inference.gap import HeldOut, unchanged
from gyrodrift.diagnose.inference.posterior import RARE, Posterior
from gyrodrift.diagnose.inference.scorer import EffectSet, Placed, Scorer
from gyrodrift.diagnose.inference.sets import fitted
from gyrodrift.values.arrays import Floats


@dataclass(frozen=True)
class Explanation:
    """The named effects, and the posterior behind them.

    best
        The most probable set with all named effects. It may hold more, such as an out-of-catalog form.
    named
        Names of the named effects.
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
        """(S, F) change by some effects of the best set, in the units of the features."""
        change: Floats = self.scorer.change(self.placed(names)) * self.scorer.observation.unit
        return change

    @cached_property
    def held_out(self) -> tuple[Floats, Floats]:
        """(S, F) change and variance by the named effects, in units of the observation.

        Each session is predicted with sizes fitted on the other sessions; a single session with its own.
        """
        observation = self.scorer.observation
        change, variance = np.zeros_like(observation.difference), np.zeros_like(observation.difference)
        for row, placed in enumerate(self._fitted_without_each):
            own, covariance = self.scorer.change(placed), self.scorer.prediction(placed)[1]
            change[row] = own[row]
            total = covariance[:, row, row] + sum(
                item.variance[row] - item.template.scatter[item.point][row] for item in placed
            )
            variance[row] = total - observation.covariance[:, row, row]
        return change, variance

    @cached_property
    def held_out_gap(self) -> HeldOut:
        """Each session against the corrected simulator, in units of chance without an allowance for the causes."""
        if not self.named:
            return unchanged(self.evidence)
        observation = self.scorer.observation
        by_chance = observation.is_compared * observation.unit / self.evidence.sigma
        variance = np.zeros_like(observation.difference)
        for row, placed in enumerate(self._fitted_without_each):
            variance[row] = sum(item.variance[row] for item in placed)
        z = (observation.difference - self.held_out[0]) * by_chance
        return HeldOut(z, variance * np.square(by_chance))

    @cached_property
    def _fitted_without_each(self) -> list[list[Placed]]:
        """For each session: the named effects with sizes fitted to the other sessions; empty without a named effect."""
        return [self._fitted_without(row) for row in range(self.scorer.observation.sessions if self.named else 0)]

    @cached_property
    def held_out_z(self) -> Floats:
        """(S, F) unexplained residual of each session, in standard deviations of its prediction, causes included."""
        observation = self.scorer.observation
        if not self.named:
            return self.evidence.z
        change, variance = self.held_out
        sigma = np.sqrt(np.diagonal(observation.covariance, axis1=1, axis2=2).T + variance)
        unexplained: Floats = np.where(observation.is_compared, (observation.difference - change) / sigma, 0.0)
        return unexplained

    def possible(self, *, least: float = RARE) -> list[Placed]:
        """Effects of the catalog that are not named but may act, the most probable first, at their best sizes."""
        inclusion = self.posterior.inclusion
        names = [name for name, mass in inclusion.items() if mass > least and not name.startswith("?")]
        rest = sorted((name for name in names if name not in self.named), key=lambda name: -inclusion[name])
        return [placed for placed in map(self.where_best, rest) if placed is not None]

    def where_best(self, name: str) -> Placed | None:
        """An effect as placed in the most probable set with it; None if it was not simulated."""
        if name not in self.posterior.inclusion:
            return None
        placed_of_best = self.posterior.best_with({name}).placed
        return next((placed for placed in placed_of_best if placed.template.name == name), None)

    def _fitted_without(self, row: int) -> list[Placed]:
        """The named effects with sizes fitted on the other sessions; a single session keeps its own sizes."""
        placed = self.placed(self.named)
        other_rows = [index for index in range(self.scorer.observation.sessions) if index != row]
        if not other_rows:
            return placed
        scorer = self.scorer.of_sessions(other_rows)
        initial = tuple(item._replace(template=item.template.of_sessions(other_rows)) for item in placed)
        own = fitted(scorer, EffectSet(initial, 0.0, 0.0)).placed
        refitted = []
        for item in own:
            template = self.scorer.templates[item.template.name]
            refitted.append(
                Placed(*template.nearest_point(int(item.template.response[item.point]), item.size), item.form_error)
            )
        return refitted
