"""Which features deviate, before anything is added and after: standard normal deviates pooled over sessions."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.features.vector import FEATURES, NUMBER
from gyrodrift.diagnose.inference.family_wise import pooled_z
from gyrodrift.diagnose.inference.fit import CauseSet, fitted_without
from gyrodrift.diagnose.inference.surrogate import Cause, Surrogate, without

UNEXPLAINED = 1.25
"""In units of the family-wise threshold: what causes leave may be off by what is not exact in them."""

WORST_Z = 20.0
"""No feature counts for more than this: a z of hundreds says no more than one of twenty."""


EQUAL_IN_MOTION, EQUAL_AT_REST, REPEATED, SENSOR = "equal_moving", "equal_rest", "equal_quick", "sensor"
"""A link that repeats samples does so while the rate changes, too; where it does not, values that are equal at rest and
in motion are the sensor's."""


@dataclass(frozen=True, slots=True)
class Deviation:
    """A feature that deviates; z pooled over all sessions, and its share of all that deviates."""

    stage: str
    feature: str
    regime: str
    says: str
    z: float
    share: float = 0.0


def held_out_z(surrogate: Surrogate, found: CauseSet) -> Floats:
    """(sessions, F) what each session leaves unexplained under sizes fitted on the others."""
    evidence = surrogate.evidence
    if not found.causes:
        return evidence.z
    z = np.empty_like(evidence.z)
    for held_out in range(len(evidence.names)):
        causes = fitted_without(surrogate, found.causes, held_out)
        z[held_out] = surrogate.standardised_residuals(causes)[held_out]
    return z


def deviations(z: Floats, threshold: float) -> tuple[Deviation, ...]:
    """Features whose pooled z, (F,), is beyond a threshold, the worst first."""
    order = [int(number) for number in np.argsort(-np.abs(z)) if abs(z[number]) > threshold]
    found = [_deviation(number, float(z[number])) for number in order]
    names = {one.feature for one in found}
    if EQUAL_AT_REST in names and REPEATED not in names:
        found = [replace(one, stage=SENSOR) if one.feature == EQUAL_IN_MOTION else one for one in found]
    return shared(found)


def shared_with_unknown(surrogate: Surrogate, found: CauseSet, one: Cause) -> float:
    """Most that what a cause moves has in common with what an out-of-catalogue model beside it moves, 0 to 1.

    The squared cosine between the two, in standard deviations of chance: where it is near 1, both may be parts of one
    form that no effect has.
    """
    strange = [cause for cause in found.causes if cause.is_out_of_catalogue]
    moved = _direction(surrogate, one)
    return max((float(np.square(moved @ _direction(surrogate, cause))) for cause in strange), default=0.0)


def _direction(surrogate: Surrogate, one: Cause) -> Floats:
    """What a cause alone moves in all sessions, as a vector of length 1, or less where chance moves more."""
    alone = surrogate.prediction((one,))
    z = (alone.change / np.sqrt(surrogate.evidence.variance_with(alone.variance))).ravel()
    return z / max(float(np.linalg.norm(z)), 1.0)


def moved_by(surrogate: Surrogate, found: CauseSet, one: Cause) -> float:
    """The largest pooled z of what one of the causes moves beside the others."""
    whole = surrogate.prediction(found.causes)
    moved = whole.change - surrogate.prediction(without(found.causes, one)).change
    z = pooled_z(moved / np.sqrt(surrogate.evidence.variance_with(whole.variance))) / surrogate.evidence.caution
    return float(np.abs(z).max())


def out_of_catalogue(surrogate: Surrogate, found: CauseSet) -> list[Deviation]:
    """What was explained by no effect, by the feature it stands for; its z is what it would be without."""
    strange = [cause for cause in found.causes if cause.is_out_of_catalogue]
    return [_deviation(_own_number(cause), own_z(surrogate, found.causes, cause)) for cause in strange]


def own_z(surrogate: Surrogate, causes: Sequence[Cause], one: Cause) -> float:
    """Pooled z, without an out-of-catalogue model but beside all other causes, of the feature that it stands for."""
    left = surrogate.standardised_residuals(without(causes, one))
    return float((pooled_z(left) / surrogate.evidence.caution)[_own_number(one)])


def feature_of(strange: Cause) -> str:
    """The name of the feature that an out-of-catalogue model stands for."""
    return strange.name.removeprefix("?")


def _own_number(strange: Cause) -> int:
    return NUMBER[feature_of(strange)]


def worst_first(every: Sequence[Deviation]) -> tuple[Deviation, ...]:
    """Each feature once."""
    by_name: dict[str, Deviation] = {}
    for one in sorted(every, key=lambda one: -abs(one.z)):
        by_name.setdefault(one.feature, one)
    return shared(list(by_name.values()))


def shared(every: Sequence[Deviation]) -> tuple[Deviation, ...]:
    """With the share that each has in the squares of all of them."""
    squares = [min(abs(one.z), WORST_Z) ** 2 for one in every]
    total = sum(squares) or 1.0
    return tuple(replace(one, share=square / total) for one, square in zip(every, squares, strict=True))


def explained_share(deviates: Mask, before: Floats, after: Floats) -> float:
    """Share of the squares of what deviates that is taken away; below 0 where something is added to it.

    Chance has a square of 1, which nothing takes away.
    """
    squares = [np.square(np.minimum(np.abs(z[deviates]), WORST_Z)) for z in (before, after)]
    held = [np.maximum(each - 1.0, 0.0).sum() for each in squares]
    return float(1.0 - held[1] / held[0])


def _deviation(number: int, z: float) -> Deviation:
    one = FEATURES[number]
    return Deviation(one.stage, one.name, one.regime, one.says, z)
