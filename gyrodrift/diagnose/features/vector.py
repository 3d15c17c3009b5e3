"""All features of a recording, in one vector."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.diagnose.features import noise
from gyrodrift.diagnose.features import residuals as residual
from gyrodrift.diagnose.features import timing as clock
from gyrodrift.diagnose.features.design_matrix import Design
from gyrodrift.diagnose.features.feature import Measured
from gyrodrift.diagnose.recording.outliers import Cleaned

FEATURES = (*residual.FEATURES, *noise.FEATURES, *clock.FEATURES)
NUMBER = {feature.name: number for number, feature in enumerate(FEATURES)}


BLURRED = np.array([s.name.startswith(("lag", "noise_slow", "noise_fast")) for s in FEATURES])
COARSE_FLOORS = 6.0
"""Where the angle comes in coarse steps, the motion within a second is rebuilt from the gyro itself."""


@dataclass(frozen=True, slots=True)
class Facts:
    """What the rig states and no recording changes: one count of the rate in deg/s, counts of the encoder per turn."""

    dps_per_lsb: float
    encoder_cpr: int


def measure(seen: Cleaned, design: Design, facts: Facts) -> Measured:
    """FEATURES of a recording, or of a simulation driven through its motion, against the recording's design."""
    parts = (
        residual.measure(seen, design),
        noise.measure(seen, design, facts.dps_per_lsb, facts.encoder_cpr),
        clock.measure(seen.recording),
    )
    values, floors = (np.concatenate(column) for column in zip(*parts, strict=True))
    return Measured(values, np.where(BLURRED, COARSE_FLOORS * floors, floors) if design.is_coarse else floors)
