"""Records of features: meaning, relevance threshold, unit and response to the size of an effect."""

from collections.abc import Callable, Sequence
from dataclasses import KW_ONLY, dataclass
from enum import Enum
from typing import Generic, NamedTuple, TypeVar

import numpy as np

from gyrodrift.values.arrays import Floats

LARGEST_EXPONENT = 50.0
"""Limit of exponents, so that numbers in a report stay finite. Chosen: e⁵⁰ is 5e21, beyond every ratio that means
something."""


class FeatureReading(NamedTuple):
    """Unit for people, and an increasing function from the value of a feature to this unit."""

    unit: str
    of: Callable[[Floats], Floats] = lambda value: value


def _exponential(value: Floats) -> Floats:
    grown: Floats = np.exp(np.clip(value, -LARGEST_EXPONENT, LARGEST_EXPONENT))
    return grown


def _amplitude(log_variance: Floats) -> Floats:
    return _exponential(0.5 * log_variance)


def _square(root: Floats) -> Floats:
    squared: Floats = np.square(np.maximum(root, 0.0))
    return squared


RMS_DPS = FeatureReading("deg/s RMS")
AMPLITUDE_DPS = FeatureReading("deg/s", _amplitude)
AMPLITUDE_DEG = FeatureReading("deg", _amplitude)
OVER_REST = FeatureReading("times as at rest", _amplitude)
OVER_USUAL = FeatureReading("times as usual", _exponential)
OVER_MIDDLE = FeatureReading("times its middle", _amplitude)
OVER_NEIGHBORS = FeatureReading("times its neighbors", lambda log_ratio: _exponential(log_ratio) - 1.0)
OVER_CHANCE = FeatureReading("times as by chance", _exponential)
OVER_ENCODER = FeatureReading("of the encoder's", _exponential)
PERCENT_OF_SAMPLES = FeatureReading("% of samples", lambda root_share: 100.0 * _square(root_share))
SAMPLES = FeatureReading("samples", _exponential)
COUNTS = FeatureReading("counts", lambda log2: _exponential(np.log(2.0) * log2))
PPM = FeatureReading("ppm", lambda ratio: 1e6 * ratio)
MILLISECONDS = FeatureReading("ms", lambda log_s: 1e3 * _exponential(log_s))
SAMPLE_PERIODS = FeatureReading("sample periods")


WHEN = {
    "rest": "at rest",
    "slow": "in slow motion",
    "fast": "in fast motion",
    "moving": "in motion",
    "accelerating": "while accelerating",
    "reversing": "after reversals",
    "warm": "as it warms or cools",
    "early": "soon after power-on",
    "late": "over time",
    "always": "at all times",
}
"""Words of a report for a regime of the motion, by its name."""


Observed = TypeVar("Observed")


class ResponseLaw(Enum):
    """Dependence of a feature's value on the size of an effect.

    LINEAR
        Proportional to the size, with its sign.
    LOG_VARIANCE
        Logarithm of a variance: variances add, and grow with the square of the size.
    ROOT_SHARE
        Square root of a share of the samples: shares add.
    SATURATING
        Proportional to a small size, constant for a large one: steps, quantiles.
    """

    LINEAR = "linear"
    LOG_VARIANCE = "logarithm of a variance"
    ROOT_SHARE = "root of a share"
    SATURATING = "saturating"


@dataclass(frozen=True, slots=True)
class Feature:
    """A named statistic of a recording.

    stage
        Stage of the rig whose effects usually change it: sensor, environment, platform, encoder, clock or link.
    regime
        Regime of the motion in which it is measured: a key of WHEN.
    says
        Words of a report for a high value.
    threshold, source
        Relevance threshold in the unit of the value, and its meaning in practice. Smaller deviations are negligible.
    reading
        Unit for people, and the conversion to it.
    response
        Dependence on the size of an effect.
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
    """A feature with the function that computes its value from an observation."""

    _: KW_ONLY
    compute: Callable[[Observed], float]


class Measured(NamedTuple):
    """Values of features and their relevance thresholds, shape (features,)."""

    values: Floats
    thresholds: Floats


def numbers_of(features: Sequence[Feature]) -> dict[str, int]:
    """Index of a feature in the sequence, by its name.

    Raises
    ------
    ValueError
        Two features have the same name.
    """
    numbers = {feature.name: index for index, feature in enumerate(features)}
    if len(numbers) != len(features):
        raise ValueError("two features have the same name")
    return numbers
