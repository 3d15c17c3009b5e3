"""Moves between two rests: the angle of a turn, and whether gravity turned as the gyro says."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from gyrodrift.calibrate.positions.block import AxesBlock, AxesRest
from gyrodrift.values.arrays import Floats

TIPPED_DEG = 20.0
"""Largest tilt during a turn on a table, deg: hands push with less than 3 m/s². Chosen."""


@dataclass(frozen=True, slots=True)
class AxesMove:
    """Measured move from one rest to the next.

    t_s
        Device clock from the middle of a rest to the middle of the next, s, shape (n,).
    rates_dps
        Rates without the bias, which is interpolated between both rests, deg/s, shape (n, 3).
    tipped_deg
        Largest tilt on the way against the first rest, by the acceleration of a block, deg.
    """

    before: AxesRest
    after: AxesRest
    t_s: Floats
    rates_dps: Floats
    tipped_deg: float

    @property
    def angles_deg(self) -> Floats:
        """Integrated rates, degrees, shape (3,)."""
        return np.asarray(np.trapezoid(self.rates_dps, self.t_s, axis=0), dtype=np.float64)

    @property
    def up_angle_deg(self) -> float:
        """Angle about the vertical of the first rest, degrees."""
        return float(self.angles_deg @ self.before.up)

    @property
    def is_on_table(self) -> bool:
        """Whether the board stayed on the table."""
        return self.tipped_deg < TIPPED_DEG

    def gravity_error_deg(self, matrix: Floats, up_before: Floats, up_after: Floats) -> float:
        """Angle between gravity at the end and gravity at the start, turned by the corrected rates; deg."""
        steps_rad = np.deg2rad(0.5 * (self.rates_dps[1:] + self.rates_dps[:-1]) @ matrix.T) * np.diff(self.t_s)[:, None]
        expected = _composed(steps_rad).apply(up_after)
        return float(np.rad2deg(np.arctan2(np.linalg.norm(np.cross(expected, up_before)), expected @ up_before)))


def move_between(before: AxesRest, after: AxesRest, blocks: Sequence[AxesBlock]) -> AxesMove:
    """Move from its blocks, which include both rests."""
    t_s, rates_dps = np.concatenate([b.t_s for b in blocks]), np.concatenate([b.gyro_dps for b in blocks])
    is_inside = (t_s >= before.middle_s) & (t_s <= after.middle_s)
    share = (t_s - before.middle_s) / (after.middle_s - before.middle_s)
    bias_dps = before.gyro_dps + share[:, None] * (after.gyro_dps - before.gyro_dps)
    means = np.array([block.accel_mps2.mean(axis=0) for block in blocks])
    cosines = means @ before.up / np.linalg.norm(means, axis=1)
    tipped_deg = float(np.rad2deg(np.arccos(np.clip(cosines.min(), -1.0, 1.0))))
    return AxesMove(before, after, t_s[is_inside], (rates_dps - bias_dps)[is_inside], tipped_deg)


def _composed(steps_rad: Floats) -> Rotation:
    """Product of small turns, each about the axes that the turns before have moved."""
    turns = Rotation.from_rotvec(steps_rad)
    while len(turns) > 1:
        last = turns[-1:] if len(turns) % 2 else None
        paired = turns[0 : len(turns) - 1 : 2] * turns[1::2]
        turns = paired if last is None else Rotation.concatenate([paired, last])
    return turns[0]
