"""What a feature reads in units that a person knows; in the vector it is what the statistics like best."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.design_matrix import COLUMNS, LAG_FEATURES, WARMING_FEATURES

REGRESSIONS = frozenset(one.name for one in (*(column.feature for column in COLUMNS), *LAG_FEATURES, *WARMING_FEATURES))
LARGEST = 50.0
"""An exponent beyond which a number is no longer read as one."""


class Reading(NamedTuple):
    """A unit, and how the value of a feature is taken to it; rising or falling throughout."""

    unit: str
    of: Callable[[Floats], Floats]


def _as_it_is(value: Floats) -> Floats:
    return value


def _exponential(value: Floats) -> Floats:
    grown: Floats = np.exp(np.clip(value, -LARGEST, LARGEST))
    return grown


def _amplitude(log_variance: Floats) -> Floats:
    return _exponential(0.5 * log_variance)


def _above_one(log_ratio: Floats) -> Floats:
    return _exponential(log_ratio) - 1.0


def _ms(log_s: Floats) -> Floats:
    return 1e3 * _exponential(log_s)


def _square(root: Floats) -> Floats:
    squared: Floats = np.square(np.maximum(root, 0.0))
    return squared


def _percent(root_share: Floats) -> Floats:
    return 100.0 * _square(root_share)


def _doubled(log2: Floats) -> Floats:
    return _exponential(np.log(2.0) * log2)


def _doubled_above_one(log2: Floats) -> Floats:
    return _doubled(log2) - 1.0


def _ppm(ratio: Floats) -> Floats:
    return 1e6 * ratio


OTHERS = Reading("", _as_it_is)
REGRESSED = Reading("deg/s RMS", _as_it_is)
READINGS = (
    ("walk_levels", Reading("excess kurtosis", _as_it_is)),
    ("walk_jumps", Reading("kurtosis of steps", _above_one)),
    (("wander", "walk"), Reading("deg/s", _amplitude)),
    ("scatter", Reading("times as at rest", _amplitude)),
    ("noise_uneven", Reading("times as usual", _exponential)),
    ("noise", Reading("times its middle", _amplitude)),
    ("angle_noise", Reading("deg", _amplitude)),
    ("line", Reading("times its neighbours", _above_one)),
    ("swing", Reading("times what it leaves", _exponential)),
    (("ripple", "angle_ripple"), Reading("times as by chance", _exponential)),
    ("values", Reading("values", _exponential)),
    (("tails", "spike_share", "equal", "zero_share"), Reading("% of samples", _percent)),
    (("drop_share", "repeat_share", "disorder_share"), Reading("% of samples", _percent)),
    ("drop_runs", Reading("samples", _exponential)),
    (("least_rate", "rate_step", "angle_step"), Reading("counts", _doubled)),
    ("reach", Reading("of the encoder's", _exponential)),
    ("slip_count", Reading("jumps", _square)),
    ("slip_size", Reading("counts", _doubled_above_one)),
    ("clock_ratio", Reading("ppm", _ppm)),
    ("stamp_tails", Reading("% of samples", _percent)),
    ("stamp", Reading("ms", _ms)),
    ("arrival_gap", Reading("sample periods", _as_it_is)),
    ("arrival", Reading("ms", _ms)),
    ("step", Reading("standard errors", _as_it_is)),
    ("two_levels", Reading("excess kurtosis", _as_it_is)),
)
"""By how names begin; the first that fits."""


def reading_of(name: str) -> Reading:
    """Of a feature by its name; one that is not known here is read as it is."""
    if name in REGRESSIONS:
        return REGRESSED
    return next((reading for starts, reading in READINGS if name.startswith(starts)), OTHERS)
