"""Platform and encoder: the angle that is taken for the truth, and is not; on the fine grid, except for counts."""

import numpy as np

from gyrogap.physics.dice import Rng
from gyrogap.physics.motion import Floats
from gyrogap.physics.scene import TableScene


def backlash(values: Floats, scene: TableScene, rng: Rng, *, play_deg: float) -> Floats:
    """The encoder is pushed by one edge of the play or by the other."""
    half_deg = play_deg / 2.0
    shaft_deg = values[0] + float(rng.uniform(-half_deg, half_deg))
    pushed_deg = []
    for angle_deg in values.tolist():
        if shaft_deg < angle_deg - half_deg:
            shaft_deg = angle_deg - half_deg
        elif shaft_deg > angle_deg + half_deg:
            shaft_deg = angle_deg + half_deg
        pushed_deg.append(shaft_deg)
    return np.array(pushed_deg)


def encoder_eccentricity(
    values: Floats, scene: TableScene, rng: Rng, *, amplitude_deg: float, phase_deg: float
) -> Floats:
    """The disc runs out of true."""
    return values + amplitude_deg * np.sin(np.radians(scene.fine_deg + phase_deg))


def encoder_slip(values: Floats, scene: TableScene, rng: Rng, *, step_deg: float, per_hour: float) -> Floats:
    """It jumps either way and stays there; jumps keep a little apart from each other."""
    seconds = len(values) / scene.fine_hz
    gaps_s = rng.gamma(2.0, 1800.0 / per_hour, 10 + int(per_hour * seconds / 900.0))
    jumps = np.searchsorted(np.cumsum(gaps_s), scene.fine_s)
    jumps_deg = step_deg * rng.choice([-1.0, 1.0], len(gaps_s))
    slipped: Floats = values + np.concatenate([[0.0], np.cumsum(jumps_deg)])[jumps]
    return slipped


def encoder_quantization(values: Floats, scene: TableScene, rng: Rng, *, cpr: float) -> Floats:
    """Fewer lines on the disc; the angle is still told in the counts that the rig states."""
    counts: Floats = np.rint(values * (cpr / 360.0)) * (360.0 / cpr)
    return counts
