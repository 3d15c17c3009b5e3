"""Gap between held-out sessions and a simulation of them by the benchmark's own physics, before and after an answer.

Real and simulated sessions have the same motion and other noise. A feature shows a gap if its difference is far above
its scatter: the standard deviation over repeated simulations, of the healthy device and of the true one.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrogap.case import BenchmarkCase
from gyrogap.features import features_of, resolution_of
from gyrogap.physics.kinds import InjectedEffect
from gyrogap.physics.motion import Floats

REPEATS = 3
"""Repeated simulations with other noise."""

GAP_Z = 5.0
"""Difference in units of scatter from which a feature shows a gap. Chosen: the scatter of so few repeats is rough."""

Features = list[dict[str, float]]


@dataclass(frozen=True, slots=True)
class GapClosed:
    """Features of the sessions, by what an answer does to them.

    gaps
        Features that show a gap to the simulator as it is.
    created
        Features that show one only with the answer.
    share
        Mean over the gaps of the share that is closed, less one for each that is created, at least -1. None without
        gaps: the effect is too small for held-out sessions.
    """

    gaps: int
    created: int
    share: float | None


def gap_closed(case: BenchmarkCase, answered: Sequence[InjectedEffect]) -> GapClosed:
    """Gap of a case whose answer names these effects with these parameters."""
    return HeldOutGap(case).closed(answered)


class HeldOutGap:
    """Held-out sessions of a case, and the distances that no answer changes; several answers share them."""

    def __init__(self, case: BenchmarkCase) -> None:
        self._case = case
        self._real = _features(case, case.effects, "real")
        true = [_features(case, case.effects, f"true {number}") for number in range(REPEATS)]
        healthy = [_features(case, (), f"healthy {number}") for number in range(REPEATS)]
        self._scatter = _scatter([self._real, *true], healthy)
        self._names = [sorted(name for name in session if name in self._scatter) for session in self._real]
        self._least = GAP_Z * np.maximum(1.0, self._z(true))
        self._before = self._z(_simulated(case, case.stated))

    def closed(self, answered: Sequence[InjectedEffect]) -> GapClosed:
        """Gap with these effects in the simulator; one that it has gets the answered size."""
        is_gap = self._before > self._least
        gaps = int(is_gap.sum())
        if not gaps or not answered:
            return GapClosed(gaps, 0, 0.0 if gaps else None)
        names = {effect.name for effect in answered}
        corrected = (*(effect for effect in self._case.stated if effect.name not in names), *answered)
        after = self._z(_simulated(self._case, corrected))
        created = int(((after > self._least) & ~is_gap).sum())
        shares = np.clip(1.0 - after[is_gap] / self._before[is_gap], -1.0, 1.0)
        return GapClosed(gaps, created, max(-1.0, float(shares.sum() - created) / gaps))

    def _z(self, simulated: list[Features]) -> Floats:
        """Root mean square difference of each feature of each session over repeats, in units of scatter."""
        squares = [
            [
                ((session[name] - repeated[index].get(name, session[name])) / self._scatter[name]) ** 2
                for index, session in enumerate(self._real)
                for name in self._names[index]
            ]
            for repeated in simulated
        ]
        z: Floats = np.sqrt(np.mean(squares, axis=0))
        return z


def _simulated(case: BenchmarkCase, effects: tuple[InjectedEffect, ...]) -> list[Features]:
    return [_features(case, effects, f"simulated {number}") for number in range(REPEATS)]


def _features(case: BenchmarkCase, effects: tuple[InjectedEffect, ...], noise: str) -> Features:
    batch = case.held_out(effects, noise)
    return [features_of(batch.columns(number)) for number in range(len(batch.plans))]


def _scatter(*groups: list[Features]) -> dict[str, float]:
    """Scatter of each feature, pooled over sessions: the larger one of the groups."""
    names = {name for features in groups[0] for session in features for name in session}
    return {name: max(_spread(group, name) for group in groups) + resolution_of(name) for name in names}


def _spread(group: list[Features], name: str) -> float:
    """Pooled standard deviation over the repeated simulations of each session."""
    sessions = ([session[name] for session in repeated if name in session] for repeated in zip(*group, strict=True))
    variances = [float(np.var(values, ddof=1)) for values in sessions if len(values) > 1]
    return float(np.sqrt(np.mean(variances))) if variances else 0.0
