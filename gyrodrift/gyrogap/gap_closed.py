"""Gap between held-out sessions and a simulation of them by the benchmark's own physics, before and after an answer.

Real and simulated sessions have the same motion and other noise. Their features are compared in units of scatter: the
standard deviation of a feature over repeated simulations, of the healthy device and of the true one.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.gyrogap.case import BenchmarkCase
from gyrodrift.gyrogap.features import features_of, resolution_of
from gyrodrift.gyrogap.physics.kinds import InjectedEffect
from gyrodrift.gyrogap.physics.motion import Floats

REPEATS = 3
"""Repeated simulations with other noise."""

MOST_Z = 100.0
"""Largest difference of a feature, in units of its scatter. Chosen: otherwise a single feature is the whole gap."""

LEAST_GAP = 1.5
"""Least gap of the simulator as it is, over the gap of the truth, of a case that counts. Chosen."""

Features = list[dict[str, float]]


@dataclass(frozen=True, slots=True)
class GapClosed:
    """Root mean squares over features: of the simulator as it is, with the answer, and with the truth.

    share
        Share of the gap that the answer closes; None where the effect is too small for held-out sessions.
    """

    before: float
    after: float
    floor: float
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
        self._floor = self._distance(true)
        self._before = self._distance(_simulated(case, case.stated))

    def closed(self, answered: Sequence[InjectedEffect]) -> GapClosed:
        """Gap with these effects in the simulator; one that it has gets the answered size."""
        names = {effect.name for effect in answered}
        corrected = (*(effect for effect in self._case.stated if effect.name not in names), *answered)
        is_visible = self._before >= LEAST_GAP * self._floor
        after = self._distance(_simulated(self._case, corrected)) if answered and is_visible else self._before
        share = 1.0 - (after - self._floor) / (self._before - self._floor) if is_visible else None
        return GapClosed(self._before, after, self._floor, share)

    def _distance(self, simulated: list[Features]) -> float:
        return float(np.mean([_rms_z(self._real, features, self._scatter) for features in simulated]))


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


def _rms_z(real: Features, simulated: Features, scatter: dict[str, float]) -> float:
    z = [
        np.clip((ours[name] - theirs[name]) / scatter[name], -MOST_Z, MOST_Z)
        for ours, theirs in zip(real, simulated, strict=True)
        for name in sorted(scatter)
        if name in ours and name in theirs
    ]
    values: Floats = np.array(z)
    return float(np.sqrt(np.mean(values**2)))
