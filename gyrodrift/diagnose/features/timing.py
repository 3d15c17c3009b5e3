"""Features of clock and link: what the stamps and arrivals of the samples say, and which samples are missing."""

import numpy as np

from gyrodrift.diagnose.features.arrivals import ARRIVALS, LOSSES, arrivals_of
from gyrodrift.diagnose.features.feature import Feature, Measured
from gyrodrift.diagnose.features.stamps import STAMPS, stamps_of
from gyrodrift.diagnose.recording.recording import Recording

FEATURES: tuple[Feature, ...] = (*STAMPS, *ARRIVALS, *LOSSES)
THRESHOLDS = np.array([feature.threshold for feature in FEATURES])


def measure(recording: Recording) -> Measured:
    """FEATURES of a recording or of a simulation; what it has no times for is 0."""
    stamps, arrivals = stamps_of(recording), arrivals_of(recording)
    values = [
        *(statistic.compute(stamps) for statistic in STAMPS),
        *(0.0 if arrivals is None else statistic.compute(arrivals) for statistic in ARRIVALS),
        *(statistic.compute(recording) for statistic in LOSSES),
    ]
    return Measured(np.array(values), THRESHOLDS)
