"""A device of three axes with an accelerometer, on a table that turns about an axis which is almost vertical."""

from dataclasses import dataclass, replace

import numpy as np

from gyrogap.physics.dice import Rng
from gyrogap.physics.motion import Floats
from gyrogap.physics.scene import TableScene

GRAVITY_MPS2 = 9.80665

FORCE_STEPS_MPS2 = (0.000598550, 0.001197101, 0.002394202)
"""±2, ±4 and ±8 g over 16 bits, m/s²."""

HEALTHY_OFFSET_MPS2 = 0.02
"""Spread of the offsets of a calibrated accelerometer: a twentieth of the zero-g offset of a data sheet. Chosen."""

MOST_TABLE_TILT_DEG = 0.3
"""How far from vertical the axis of the table stands at most: a table that was set up with a spirit level. Chosen."""


@dataclass(frozen=True, slots=True)
class ThreeAxisPart:
    """Axes x and y of the gyro, and the accelerometer.

    bias_xy_dps
        Biases of x and y for each session, deg/s.
    offset_mps2
        Offset of a healthy accelerometer, m/s².
    mps2_per_lsb, noise_mps2_rthz
        A count of the accelerometer, and its noise density.
    table_tilt_deg, table_tilt_to_deg
        Tilt of the axis of the table, and the direction of the tilt in the workshop.
    """

    bias_xy_dps: tuple[tuple[float, float], ...]
    offset_mps2: tuple[float, float, float]
    mps2_per_lsb: float
    noise_mps2_rthz: float
    table_tilt_deg: float
    table_tilt_to_deg: float

    def stated(self) -> dict[str, float]:
        """Block `three_axes` of the rig file: figures of the data sheet, no biases."""
        return {"mps2_per_lsb": self.mps2_per_lsb, "accel_noise_mps2_rthz": 0.0028, "gravity_mps2": GRAVITY_MPS2}


def draw_three_axes(rng: Rng, sessions: int) -> ThreeAxisPart:
    """A healthy part."""
    x, y, z = np.round(rng.normal(0.0, HEALTHY_OFFSET_MPS2, 3), 4).tolist()
    return ThreeAxisPart(
        bias_xy_dps=tuple((round(x, 4), round(y, 4)) for x, y in rng.normal(0.0, 0.4, (sessions, 2)).tolist()),
        offset_mps2=(x, y, z),
        mps2_per_lsb=float(rng.choice(FORCE_STEPS_MPS2)),
        noise_mps2_rthz=0.0028 * rng.uniform(0.8, 1.3),
        table_tilt_deg=round(rng.uniform(0.0, MOST_TABLE_TILT_DEG), 4),
        table_tilt_to_deg=round(rng.uniform(-180.0, 180.0), 2),
    )


def gravity_mps2(scene: TableScene, axes: ThreeAxisPart) -> Floats:
    """Specific force in the frame of the table at the samples, m/s², shape (samples, 3)."""
    tilt, toward = np.radians(axes.table_tilt_deg), np.radians(axes.table_tilt_to_deg - scene.angle_deg)
    across = GRAVITY_MPS2 * np.sin(tilt)
    upward = np.full(len(toward), GRAVITY_MPS2 * np.cos(tilt))
    return np.column_stack([across * np.cos(toward), across * np.sin(toward), upward])


def turning(scene: TableScene, share: float) -> TableScene:
    """The scene for an axis of the gyro that feels a share of the turn."""
    return replace(scene, fine_dps=share * scene.fine_dps, rate_dps=share * scene.rate_dps)
