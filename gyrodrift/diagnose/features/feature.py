"""What a feature is: one record of what it says, from what size on it matters, how it reads and how it responds."""

from collections.abc import Callable, Sequence
from dataclasses import KW_ONLY, dataclass
from enum import Enum
from typing import Generic, NamedTuple, TypeVar

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.units import FeatureReading

Observed = TypeVar("Observed")


class ResponseLaw(Enum):
    """How the value of a feature follows the size of an effect.

    LINEAR
        In proportion, with its sign.
    LOG_VARIANCE
        A logarithm of a variance: variances add, and grow with the square of the size.
    SATURATING
        In proportion to smaller sizes, and no further beyond: shares of samples, steps, quantiles.
    """

    LINEAR = "linear"
    LOG_VARIANCE = "logarithm of a variance"
    SATURATING = "saturating"


@dataclass(frozen=True, slots=True)
class Feature:
    """A statistic with a name.

    stage
        Of the rig, where what moves it most often sits: sensor, environment, platform, encoder, clock or link.
    regime
        Of the motion it speaks of: rest, slow, fast, moving, accelerating, reversing, warm, early, late or always.
    says
        What a person reads when it is high.
    threshold, source
        Relevance threshold, in the units of the value: smaller deviations do not matter; and what that size amounts to.
    reading
        Unit for people, and how the value is taken to it.
    response
        How it follows the size of an effect.
    """

    name: str
    stage: str
    regime: str
    says: str
    threshold: float
    source: str
    _: KW_ONLY
    reading: FeatureReading
    response: ResponseLaw = ResponseLaw.SATURATING


@dataclass(frozen=True, slots=True)
class Statistic(Feature, Generic[Observed]):
    """A feature with the function that takes its value from what was observed."""

    _: KW_ONLY
    compute: Callable[[Observed], float]


class Measured(NamedTuple):
    """Values of some features and their relevance thresholds; shape (features,) each."""

    values: Floats
    thresholds: Floats


def numbers_of(features: Sequence[Feature]) -> dict[str, int]:
    """The place of each feature by its name.

    Raises
    ------
    ValueError
        Where two have the same name.
    """
    numbers = {feature.name: number for number, feature in enumerate(features)}
    if len(numbers) != len(features):
        raise ValueError("two features have the same name")
    return numbers
