"""A regressor of the block residuals: a feature, with what it is at each sample of a motion."""

from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.feature import Feature, ResponseLaw
from gyrodrift.diagnose.features.motion_terms import MotionTerms
from gyrodrift.diagnose.features.units import RMS_DPS, FeatureReading


@dataclass(frozen=True, slots=True)
class DesignColumn(Feature):
    """A regressor of the block residuals; the value of the feature is its coefficient.

    is_slow
        Whether a bias that wanders by itself may be taken for it.
    in_catalogue
        Whether an effect of the catalogue depends on it by itself.
    compute
        The regressor at each sample, shape (n,).
    """

    _: KW_ONLY
    reading: FeatureReading = RMS_DPS
    response: ResponseLaw = ResponseLaw.LINEAR
    is_slow: bool = False
    in_catalogue: bool = True
    compute: Callable[[MotionTerms], Floats]
