"""Deviations of features, and the gap over all of them: its size and the share that is closed, on held-out sessions."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gyrodrift.diagnose.features.vector import FEATURES
from gyrodrift.diagnose.inference.evidence import Evidence
from gyrodrift.values.arrays import Floats

WORST_Z = 20.0
"""Limit of a z in sums: a z of hundreds says no more than a z of twenty."""


@dataclass(frozen=True, slots=True)
class Deviation:
    """A deviating feature; z is pooled over all sessions.

    share
        Share of the sum of squares over the listed features.
    is_beyond_chance
        Whether z exceeds the threshold.
    """

    stage: str
    feature: str
    regime: str
    says: str
    z: float
    share: float = 0.0
    is_beyond_chance: bool = True


def deviations(z: Floats, threshold: float, least: int = 0) -> tuple[Deviation, ...]:
    """Features with a pooled z, (F,), beyond a threshold, the worst first; `least` of them in any case."""
    order = np.argsort(-np.abs(z)).tolist()
    numbers = [number for rank, number in enumerate(order) if abs(z[number]) > threshold or rank < least]
    return listed(numbers, z, threshold)


def listed(numbers: Sequence[int], z: Floats, threshold: float = 0.0) -> tuple[Deviation, ...]:
    """Deviations of some features in this order; see `shared`."""
    return shared([_deviation(number, float(z[number]), threshold) for number in numbers])


def _deviation(number: int, z: float, threshold: float) -> Deviation:
    feature = FEATURES[number]
    return Deviation(feature.stage, feature.name, feature.regime, feature.says, z, is_beyond_chance=abs(z) > threshold)


def shared(every: Sequence[Deviation]) -> tuple[Deviation, ...]:
    """Deviations with their shares of the sum of squares."""
    squares = [min(abs(deviation.z), WORST_Z) ** 2 for deviation in every]
    total = sum(squares) or 1.0
    return tuple(replace(deviation, share=square / total) for deviation, square in zip(every, squares, strict=True))


SEED = 0
NO_GAP = 1.05
"""Ratio of gap and floor up to which there is no gap to close."""

CLOSED = 0.85
"""Share of the gap from which on it counts as closed. Chosen, not measured."""


@dataclass(frozen=True, slots=True)
class SimToRealGap:
    """Root mean square of the z of all features, each limited to WORST_Z, on held-out sessions.

    floor
        RMS of the simulator against itself.
    shrink, shrink_low, shrink_high
        Closed share of the gap above the floor, and its interval; None if there is nothing to close.
    """

    before: float
    after: float
    floor: float
    shrink: float | None
    shrink_low: float | None
    shrink_high: float | None

    @property
    def is_closed(self) -> bool:
        """Whether the causes close enough of the gap, or there is no gap to close."""
        return self.shrink is None or self.shrink >= CLOSED


def gap_of(evidence: Evidence, after_z: Floats) -> SimToRealGap:
    """The gap before and after the causes; `after_z`, (sessions, F), are z of held-out sessions with the causes."""
    before, after = (by_session(_present(evidence, z)) for z in (evidence.z, after_z))
    floor = floor_of(evidence)
    rng = np.random.default_rng(SEED)
    drawn = rng.integers(len(before), size=(2000, len(before)))
    spread = [shrink_of(before[rows], after[rows], floor) for rows in drawn]
    defined = [value for value in spread if value is not None]
    whole = shrink_of(before, after, floor)
    if whole is None or not defined:
        return SimToRealGap(total_of(before), total_of(after), floor, whole, None, None)
    low, high = np.quantile(defined, (0.05, 0.95))  # a 90 % interval
    return SimToRealGap(total_of(before), total_of(after), floor, whole, float(low), float(high))


def no_gap(evidence: Evidence) -> SimToRealGap:
    """The gap of sessions that the simulator explains: chance leaves nothing to close."""
    before = total_of(by_session(_present(evidence, evidence.z)))
    return SimToRealGap(before, before, floor_of(evidence), None, None, None)


def floor_of(evidence: Evidence) -> float:
    """RMS of the simulator against itself."""
    return total_of(by_session(_present(evidence, evidence.nulls.reshape(-1, evidence.nulls.shape[-1]))))


def returning_share(evidence: Evidence, without_z: Floats, with_z: Floats) -> float:
    """Share of the squared gap that returns without a cause; z of held-out sessions without and with it, (S, F)."""
    before, without, after = (total_of(by_session(_present(evidence, z))) ** 2 for z in (evidence.z, without_z, with_z))
    return max(without - after, 0.0) / before if before else 0.0


def _present(evidence: Evidence, z: Floats) -> Floats:
    """(…, some) columns of the features that the sessions have."""
    return np.compress(evidence.is_present, z, axis=1)


def by_session(z: Floats) -> Floats:
    """(sessions,) root mean squares over features, each z limited to WORST_Z."""
    rms: Floats = np.sqrt(np.square(np.minimum(np.abs(z), WORST_Z)).mean(axis=1))
    return rms


def total_of(by_session: Floats) -> float:
    """The root mean square over sessions."""
    return float(np.sqrt(np.square(by_session).mean()))


def shrink_of(before: Floats, after: Floats, floor: float) -> float | None:
    """Closed share of the gap above the floor; None without a gap."""
    high = total_of(before)
    return (high - max(total_of(after), floor)) / (high - floor) if high > floor * NO_GAP else None
