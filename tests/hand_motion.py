"""A board that lies still and is then turned in a hand about all axes: true attitudes by scipy, as a session."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from gyrodrift.values.arrays import Floats

RATE_HZ = 100.0
BIAS_DPS = (0.8, -0.5, 0.6)
COLUMNS = (
    "t_device_s",
    "rate_dps",
    "encoder_deg",
    *(f"gyro_{x}_dps" for x in "xyz"),
    *(f"accel_{x}_mps2" for x in "xyz"),
)


@dataclass(frozen=True, slots=True)
class HandMotion:
    """Times in s, shape (n,); rates in deg/s and specific forces in m/s², shape (n, 3); true heading in deg."""

    t_s: Floats
    gyro_dps: Floats
    accel_mps2: Floats
    heading_deg: Floats

    def write(self, path: Path, names: tuple[str, ...] = COLUMNS) -> Path:
        """Write a session as csv."""
        table = np.column_stack([self.t_s, self.gyro_dps[:, 2], self.heading_deg, self.gyro_dps, self.accel_mps2])
        chosen = [COLUMNS.index(name) for name in names]
        np.savetxt(path, table[:, chosen], delimiter=",", fmt="%.9g", header=",".join(names), comments="")
        return path


def hand_motion(
    seconds: float = 60.0,
    seed: int = 1,
    tilt_deg: float = 12.0,
    yaw_deg: float = 12.0,
    bias_dps: tuple[float, float, float] = (0.0, 0.0, 0.0),
    rate_hz: float = RATE_HZ,
) -> HandMotion:
    """Still for 5 s, then turned; the angles are sums of three sines of these amplitudes."""
    rng = np.random.default_rng(seed)
    t_s = np.arange(round(seconds * rate_hz)) / rate_hz
    angles = np.zeros((len(t_s), 3))
    for axis, amplitude_deg in enumerate((yaw_deg, tilt_deg, tilt_deg)):
        for period_s in (7.0, 11.0, 4.1):
            phase = rng.uniform(0.0, 2.0 * np.pi)
            angles[:, axis] += amplitude_deg * (np.sin(2.0 * np.pi * t_s / period_s + phase) - np.sin(phase))
    angles *= np.clip((t_s - 5.0) / 2.0, 0.0, 1.0)[:, np.newaxis]
    attitude = Rotation.from_euler("ZYX", angles, degrees=True)
    turns = (attitude[:-1].inv() * attitude[1:]).as_rotvec(degrees=True) * rate_hz
    gyro = np.vstack([turns[:1], 0.5 * (turns[1:] + turns[:-1]), turns[-1:]]) + bias_dps
    accel = attitude.inv().apply([0.0, 0.0, 9.81])
    w, _, _, z = attitude.as_quat(scalar_first=True).T
    heading = np.unwrap(np.rad2deg(2.0 * np.arctan2(z, w)), period=360.0)
    noise = rng.normal(0.0, 0.05, (2, len(t_s), 3))
    return HandMotion(t_s, gyro + noise[0], accel + noise[1], heading - heading[0])
