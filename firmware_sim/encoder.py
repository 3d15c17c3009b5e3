"""The encoder: true angle in, the nearest count out."""

import numpy as np
from numpy.typing import NDArray

from firmware_sim.motion import Floats


def counts(angle_deg: Floats, cpr: int) -> NDArray[np.int64]:
    """Counts at true angles in degrees; zeros where the rig has no encoder."""
    return np.floor(angle_deg / 360.0 * cpr + 0.5).astype(np.int64)
