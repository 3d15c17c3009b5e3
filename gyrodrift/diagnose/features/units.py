"""Units of features for people; a value itself is what the statistics like best."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from gyrodrift.arrays import Floats

LARGEST_EXPONENT = 50.0
"""Beyond it a number is no longer read as one; it bounds what a report may show."""


class FeatureReading(NamedTuple):
    """A unit, and how the value of a feature is taken to it; rising throughout."""

    unit: str
    of: Callable[[Floats], Floats]


def _as_it_is(value: Floats) -> Floats:
    return value


def _exponential(value: Floats) -> Floats:
    grown: Floats = np.exp(np.clip(value, -LARGEST_EXPONENT, LARGEST_EXPONENT))
    return grown


def _amplitude(log_variance: Floats) -> Floats:
    return _exponential(0.5 * log_variance)


def _above_one(log_ratio: Floats) -> Floats:
    return _exponential(log_ratio) - 1.0


def _milli(log_s: Floats) -> Floats:
    return 1e3 * _exponential(log_s)


def _square(root: Floats) -> Floats:
    squared: Floats = np.square(np.maximum(root, 0.0))
    return squared


def _percent(root_share: Floats) -> Floats:
    return 100.0 * _square(root_share)


def _doubled(log2: Floats) -> Floats:
    return _exponential(np.log(2.0) * log2)


def _millionths(ratio: Floats) -> Floats:
    return 1e6 * ratio


RMS_DPS = FeatureReading("deg/s RMS", _as_it_is)
AMPLITUDE_DPS = FeatureReading("deg/s", _amplitude)
AMPLITUDE_DEG = FeatureReading("deg", _amplitude)
STANDARD_ERRORS = FeatureReading("standard errors", _as_it_is)
EXCESS_KURTOSIS = FeatureReading("excess kurtosis", _as_it_is)
KURTOSIS_OF_STEPS = FeatureReading("kurtosis of steps", _above_one)
OVER_REST = FeatureReading("times as at rest", _amplitude)
OVER_USUAL = FeatureReading("times as usual", _exponential)
OVER_MIDDLE = FeatureReading("times its middle", _amplitude)
OVER_NEIGHBOURS = FeatureReading("times its neighbours", _above_one)
OVER_REMAINDER = FeatureReading("times what it leaves", _exponential)
OVER_CHANCE = FeatureReading("times as by chance", _exponential)
OVER_ENCODER = FeatureReading("of the encoder's", _exponential)
PERCENT_OF_SAMPLES = FeatureReading("% of samples", _percent)
SAMPLES = FeatureReading("samples", _exponential)
COUNTS = FeatureReading("counts", _doubled)
JUMPS = FeatureReading("jumps", _square)
PPM = FeatureReading("ppm", _millionths)
MILLISECONDS = FeatureReading("ms", _milli)
SAMPLE_PERIODS = FeatureReading("sample periods", _as_it_is)
