"""True motion of a sensor in space at some times."""

from dataclasses import dataclass, replace

import numpy as np

from firmware_sim.effects.effect import Floats
from firmware_sim.motion.attitude.rotations import RAD, body_rates_dps, quaternions, twist_deg


@dataclass(frozen=True, slots=True)
class Kinematics:
    """Orientation, rates and acceleration; every array has n rows.

    The earth frame has z up. The sensor frame is right-handed, with z up when the sensor lies flat.

    quaternion
        Rotation from sensor to earth (w, x, y, z), shape (n, 4).
    rates_dps
        Rates about the axes of the sensor, deg/s, shape (n, 3).
    velocity_mps, acceleration_mps2
        Of the sensor in the earth frame, shape (n, 3).
    heading_deg
        Twist of the rotation about the vertical, unwrapped, degrees, shape (n,).
    """

    quaternion: Floats
    rates_dps: Floats
    velocity_mps: Floats
    acceleration_mps2: Floats
    heading_deg: Floats

    def specific_force_mps2(self, gravity_mps2: float) -> Floats:
        """Reading of an ideal accelerometer, in the sensor frame: Rᵀ·(a + g·z), shape (n, 3)."""
        felt = self.acceleration_mps2 + np.array([0.0, 0.0, gravity_mps2])
        return into_sensor(self.quaternion, felt)

    def with_yaw(self, yaw_deg: Floats) -> "Kinematics":
        """Motion in an earth frame that is turned about the vertical, by an angle for each row."""
        return replace(
            self,
            quaternion=quaternion_product(_yaw_quaternion(yaw_deg), self.quaternion),
            velocity_mps=_about_vertical(self.velocity_mps, yaw_deg),
            acceleration_mps2=_about_vertical(self.acceleration_mps2, yaw_deg),
            heading_deg=self.heading_deg + yaw_deg,
        )

    def mounted(self, mount: Floats) -> "Kinematics":
        """Motion of a sensor that a rotation (w, x, y, z), shape (4,), turns on its device."""
        rates_dps = into_sensor(np.broadcast_to(mount, (len(self.rates_dps), 4)), self.rates_dps)
        quaternion = quaternion_product(self.quaternion, mount)
        heading_deg = twist_deg(quaternion, self.heading_deg)
        return replace(self, quaternion=quaternion, rates_dps=rates_dps, heading_deg=heading_deg)

    def is_still(self) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
        """Whether the sensor is at rest, shape (n,)."""
        moves = np.concatenate([self.rates_dps, self.velocity_mps, self.acceleration_mps2], axis=1)
        still: np.ndarray[tuple[int], np.dtype[np.bool_]] = ~np.any(moves != 0.0, axis=1)
        return still


def of_jets(rotation: Floats, velocity_mps: Floats, acceleration_mps2: Floats, yaw_deg: Floats) -> Kinematics:
    """Kinematics of a rotation with its derivatives; `yaw_deg` (n,) is within 180° of the heading.

    Shapes: rotation (3, n, 3, 3), velocity and acceleration (n, 3).
    """
    quaternion = quaternions(rotation[0])
    heading_deg = twist_deg(quaternion, yaw_deg)
    return Kinematics(quaternion, body_rates_dps(rotation), velocity_mps, acceleration_mps2, heading_deg)


def level(angle_deg: Floats, rate_dps: Floats) -> Kinematics:
    """Kinematics of a sensor that turns about a vertical axis through itself."""
    zeros = np.zeros((len(angle_deg), 3))
    none = zeros[:, 0]
    rates_dps = np.stack([none, none, rate_dps], axis=1)
    return Kinematics(_yaw_quaternion(angle_deg), rates_dps, zeros, zeros, angle_deg)


def into_sensor(quaternion: Floats, vector: Floats) -> Floats:
    """Vectors of the earth frame in the sensor frame, shape (n, 3): v + w·c + c × u, with u = (x, y, z), c = 2v × u."""
    w, u = quaternion[:, :1], quaternion[:, 1:]
    crossed = 2.0 * np.cross(vector, u)
    in_sensor: Floats = vector + w * crossed + np.cross(crossed, u)
    return in_sensor


def quaternion_product(first: Floats, then: Floats) -> Floats:
    """Products of quaternions (w, x, y, z) along the last axis."""
    a, b, c, d = np.moveaxis(first, -1, 0)
    w, x, y, z = np.moveaxis(then, -1, 0)
    return np.stack(
        [
            a * w - b * x - c * y - d * z,
            a * x + b * w + c * z - d * y,
            a * y - b * z + c * w + d * x,
            a * z + b * y - c * x + d * w,
        ],
        axis=-1,
    )


def _yaw_quaternion(yaw_deg: Floats) -> Floats:
    half = 0.5 * yaw_deg * RAD
    none = np.zeros_like(half)
    return np.stack([np.cos(half), none, none, np.sin(half)], axis=1)


def _about_vertical(vector: Floats, angle_deg: Floats) -> Floats:
    c, s = np.cos(angle_deg * RAD), np.sin(angle_deg * RAD)
    x, y, z = vector.T
    return np.stack([c * x - s * y, s * x + c * y, z], axis=1)
