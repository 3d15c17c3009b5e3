"""Deviations of features, and the gap over all of them: its size and the share that is closed, on held-out sessions.

The gap is a distance between recordings and simulator in each feature, in standard deviations of chance. A named cause
does not widen the unit, so a cause that predicts nothing closes nothing. A random cause predicts a spread between
sessions and no values. Its features are compared as distributions, by the squared Wasserstein distance of two normal
distributions (D. C. Dowson and B. V. Landau, The Frechet distance between multivariate normal distributions, 1982):

    d = (mean_y - mean_x)^2 + (sigma_y - sigma_x)^2                                                 (16)

y are the recordings and x the runs of the corrected simulator. The distance that S runs of the corrected simulator have
to the corrected simulator is subtracted. An even shift of all sessions stays a shift, however wide a cause is.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.special import gammaln

from gyrodrift.diagnose.features.vector import FEATURES
from gyrodrift.diagnose.inference.evidence import SEED, Evidence
from gyrodrift.values.arrays import Floats

WORST_Z = 20.0
"""Limit of a z in sums. Chosen: a z of hundreds says no more than a z of twenty."""


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


NO_GAP = 1.05
"""Ratio of gap and floor up to which there is no gap to close. Chosen: a smaller difference is too small to divide
by."""

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


class HeldOut(NamedTuple):
    """Recordings against the corrected simulator, fitted to the other sessions.

    z
        (S, F) difference to the mean of the simulator, in standard deviations of chance.
    variance
        (S, F) variance of the simulator by random causes, in units of the variance by chance.
    """

    z: Floats
    variance: Floats


def unchanged(evidence: Evidence) -> HeldOut:
    """The simulator without any cause."""
    return HeldOut(evidence.z, np.zeros_like(evidence.z))


def gap_of(evidence: Evidence, held_out: HeldOut) -> SimToRealGap:
    """The gap before and after the causes."""
    before = by_session(_present(evidence, evidence.z))
    after = np.sqrt(remaining_squares(evidence, held_out))
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


def remaining_squares(evidence: Evidence, held_out: HeldOut) -> Floats:
    """(sessions,) mean squared distance to the corrected simulator, in variances of chance.

    A z beyond WORST_Z before the causes is scaled down to it, and the remaining z by the same factor. So the share that
    is closed is that of the error itself.
    """
    scale = np.minimum(1.0, WORST_Z / np.maximum(np.abs(_present(evidence, evidence.z)), WORST_Z))
    z = np.clip(_present(evidence, held_out.z) * scale, -WORST_Z, WORST_Z)
    variance = np.minimum(_present(evidence, held_out.variance) * np.square(scale), WORST_Z**2)
    squares = np.square(z)
    as_distributions = distribution_squares(z, variance)
    # The distance of a feature belongs to all sessions; the squares of a session show how they scatter.
    squares = squares + np.where(variance.mean(axis=0) > SPREADS, as_distributions - squares.mean(axis=0), 0.0)
    remaining: Floats = np.maximum(squares.mean(axis=1), 0.0)
    return remaining


SPREADS = 0.01
"""Variance by random causes, in variances of chance, from which on a feature is compared as a distribution. Chosen:
less is negligible beside chance."""


def distribution_squares(z: Floats, variance: Floats) -> Floats:
    """(F,) equation (16), minus its expectation, plus 1 as the mean square by chance; a single session has no spread.

    The expected distance of S values x to their own distribution is sigma_x^2 (1/S + 2 - 2 c). Here c is the expected
    standard deviation of S values of unit variance.
    """
    sessions = len(z)
    if sessions == 1:
        single: Floats = np.square(z[0])
        return single
    c = np.sqrt(2.0 / (sessions - 1.0)) * np.exp(gammaln(0.5 * sessions) - gammaln(0.5 * (sessions - 1.0)))
    sigma = np.sqrt(1.0 + variance.mean(axis=0))
    distance = np.square(z.mean(axis=0)) + np.square(z.std(axis=0, ddof=1) - sigma)
    beyond: Floats = 1.0 + distance - np.square(sigma) * (1.0 / sessions + 2.0 - 2.0 * c)
    return beyond


def no_gap(evidence: Evidence) -> SimToRealGap:
    """The gap of sessions that the simulator explains: chance leaves nothing to close."""
    before = total_of(by_session(_present(evidence, evidence.z)))
    return SimToRealGap(before, before, floor_of(evidence), None, None, None)


def floor_of(evidence: Evidence) -> float:
    """RMS of the simulator against itself; with a baseline, of the device against itself on another day."""
    by_chance = total_of(by_session(_present(evidence, evidence.nulls.reshape(-1, evidence.nulls.shape[-1]))))
    by_device = np.broadcast_to(evidence.device_variance, evidence.z.shape) * evidence.is_compared
    return float(np.sqrt(by_chance**2 + _present(evidence, by_device).mean()))


def returning_share(evidence: Evidence, without: HeldOut, with_causes: HeldOut) -> float:
    """Share of the squared gap that returns without a cause."""
    before = float(np.square(by_session(_present(evidence, evidence.z))).mean())
    lost = float((remaining_squares(evidence, without) - remaining_squares(evidence, with_causes)).mean())
    return min(max(lost, 0.0) / before, 1.0) if before else 0.0


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
