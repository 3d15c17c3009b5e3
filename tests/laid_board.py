"""A board with three axes that is laid down on its sides and turned on the table: what a faulty sensor reads of it."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from gyrodrift.values.arrays import Floats
from gyrodrift.values.sample import Inertial, Sample

GRAVITY_MPS2 = 9.80665
RATE_HZ = 100.0
REST_S, MOVE_S, TURN_S = 4.0, 2.0, 6.0

UPRIGHT = {
    "+z": Rotation.identity(),
    "-z": Rotation.from_euler("x", 180.0, degrees=True),
    "+x": Rotation.from_euler("y", -90.0, degrees=True),
    "-x": Rotation.from_euler("y", 90.0, degrees=True),
    "+y": Rotation.from_euler("x", 90.0, degrees=True),
    "-y": Rotation.from_euler("x", -90.0, degrees=True),
}
"""Attitudes, sensor to earth, in which an axis points up."""

SIDES = ("+z", "+x", "-z", "-x", "+y", "-y")
SIX_SIDES: tuple[str | float, ...] = SIDES
WITH_TURNS: tuple[str | float, ...] = ("+z", 360.0, -360.0, "+x", 360.0, -360.0, "-z", "-x", "+y", 360.0, -360.0, "-y")
"""Sides on which the board is laid, and turns on the table, deg."""

OFFSET_MPS2 = np.array([0.3, -0.3, 0.2])
SCALE = np.array([1.02, 0.985, 0.99])
"""Offset of the accelerometer, and true over measured acceleration."""

BIAS_DPS = np.array([1.2, -0.8, 0.6])
MISALIGNMENT_DEG = (0.7, -0.7, 0.5)
GYRO_GAIN = np.diag([1.02, 0.98, 1.015]) @ Rotation.from_rotvec(MISALIGNMENT_DEG, degrees=True).as_matrix()
"""Measured rates from true rates: 2 % of scale, 1.1° of misalignment."""

COLUMNS = (
    "t_device_s",
    "rate_dps",
    "encoder_deg",
    *(f"gyro_{x}_dps" for x in "xyz"),
    *(f"accel_{x}_mps2" for x in "xyz"),
)


@dataclass(frozen=True, slots=True)
class BoardRecord:
    """Times, s, shape (n,); rates in deg/s and specific forces in m/s², shape (n, 3); heading, deg, shape (n,)."""

    t_s: Floats
    gyro_dps: Floats
    accel_mps2: Floats
    heading_deg: Floats

    def through_sensor(self, seed: int = 0, noise_dps: float = 0.05, noise_mps2: float = 0.03) -> "BoardRecord":
        """Reading of the faulty sensor."""
        rng = np.random.default_rng(seed)
        gyro = self.gyro_dps @ GYRO_GAIN.T + BIAS_DPS + noise_dps * rng.standard_normal(self.gyro_dps.shape)
        accel = self.accel_mps2 / SCALE + OFFSET_MPS2 + noise_mps2 * rng.standard_normal(self.gyro_dps.shape)
        return BoardRecord(self.t_s, gyro, accel, self.heading_deg)

    def samples(self) -> list[Sample]:
        """Samples as the link gives them."""
        rows = np.hstack([self.gyro_dps, self.accel_mps2]).tolist()
        return [
            Sample(i, t_s, t_s, row[2], temp_c=25.0, inertial=Inertial(*row))
            for i, (t_s, row) in enumerate(zip(self.t_s.tolist(), rows, strict=True))
        ]

    def write(self, path: Path) -> Path:
        """Write a session as csv."""
        table = np.column_stack([self.t_s, self.gyro_dps[:, 2], self.heading_deg, self.gyro_dps, self.accel_mps2])
        np.savetxt(path, table, delimiter=",", fmt="%.9g", header=",".join(COLUMNS), comments="")
        return path


def laid_board(
    legs: tuple[str | float, ...] = SIX_SIDES, seed: int = 1, askew_deg: float = 3.0, mark_deg: float = 0.0
) -> BoardRecord:
    """Motion of a board: a rest, then legs with a rest after each.

    A side is reached through the air, with a heading at random, off the vertical by `askew_deg` on average. A turn
    stops within `mark_deg` of the mark.
    """
    rng = np.random.default_rng(seed)
    attitude = _askew(UPRIGHT[str(legs[0])], rng, askew_deg)
    parts, pushes, stop_deg = (
        [_repeated(attitude, REST_S)],
        [np.zeros((_count(REST_S), 3))],
        mark_deg * float(rng.standard_normal()),
    )
    for leg in legs[1:]:
        if isinstance(leg, str):
            end = _askew(UPRIGHT[leg], rng, askew_deg)
            vector = (end * attitude.inv()).as_rotvec()
            move, attitude, stop_deg = _moved(attitude, vector, MOVE_S), end, mark_deg * float(rng.standard_normal())
            push = np.sin(np.linspace(0.0, 2.0 * np.pi, len(move)))[:, np.newaxis] * rng.normal(0.0, 2.0, 3)
        else:
            stop_after_deg = mark_deg * float(rng.standard_normal())
            vector = np.array([0.0, 0.0, np.deg2rad(leg + stop_after_deg - stop_deg)])
            move, stop_deg = _moved(attitude, vector, TURN_S), stop_after_deg
            attitude = move[-1]
            push = np.zeros((len(move), 3))
        parts += [move, _repeated(attitude, REST_S)]
        pushes += [push, np.zeros((_count(REST_S), 3))]
    return record_of(Rotation.concatenate(parts), np.concatenate(pushes))


def record_of(attitudes: Rotation, accelerations_mps2: Floats) -> BoardRecord:
    """True reading of attitudes, sensor to earth, and accelerations in the earth frame."""
    steps_dps = (attitudes[:-1].inv() * attitudes[1:]).as_rotvec(degrees=True) * RATE_HZ
    rates_dps = np.vstack([steps_dps[:1], 0.5 * (steps_dps[1:] + steps_dps[:-1]), steps_dps[-1:]])
    force = attitudes.inv().apply(accelerations_mps2 + np.array([0.0, 0.0, GRAVITY_MPS2]))
    w, _, _, z = attitudes.as_quat(scalar_first=True).T
    heading_deg = np.unwrap(np.rad2deg(2.0 * np.arctan2(z, w)), period=360.0)
    return BoardRecord(np.arange(len(force)) / RATE_HZ, rates_dps, force, heading_deg - heading_deg[0])


def _askew(attitude: Rotation, rng: np.random.Generator, askew_deg: float) -> Rotation:
    lean = Rotation.from_rotvec([*(rng.normal(0.0, askew_deg, 2).tolist()), 0.0], degrees=True)
    return Rotation.from_euler("z", rng.uniform(0.0, 360.0), degrees=True) * lean * attitude


def _count(seconds: float) -> int:
    return round(seconds * RATE_HZ)


def _repeated(attitude: Rotation, seconds: float) -> Rotation:
    return Rotation.concatenate([attitude] * _count(seconds))


def _moved(attitude: Rotation, vector_rad: Floats, seconds: float) -> Rotation:
    """Turn about a fixed axis of the earth, at rest at both ends."""
    share = np.linspace(0.0, 1.0, _count(seconds))
    smooth = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
    return Rotation.from_rotvec(smooth[:, np.newaxis] * vector_rad) * attitude
