"""Rests, turns and moves that were measured so far, and the calibration of three axes that they determine.

A move lies between two rests: it has the angle of a turn, and tells whether gravity turned as the gyro says.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime
from math import isfinite, sqrt
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from gyrodrift.calibrate.positions.accelerometer import AccelerometerFit, fit_accelerometer
from gyrodrift.calibrate.positions.block import AXES, AXIS_Z, AxesBlock, AxesRest, Side, missing_sides, side_up
from gyrodrift.calibrate.positions.matrix import AxisTurn, MatrixFit, fit_matrix, missing_turns, missing_turns_text
from gyrodrift.values.arrays import Floats
from gyrodrift.values.calibration import AXES_SHAPES, Calibration
from gyrodrift.values.constants import STANDARD_GRAVITY_MPS2
from gyrodrift.values.errors import CalibrationError
from gyrodrift.values.words import listed

TIPPED_DEG = 20.0
"""Largest tilt during a turn on a table, deg: hands push with less than 3 m/s². Chosen."""

MOVES_MIN = 3
GRAVITY_ERROR_DEG = 20.0
"""Number of moves, and their median error of gravity, from which gyro and accelerometer disagree: swapped or reversed
axes give 60° and more, uncalibrated axes less than 10°."""


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


@dataclass(frozen=True, slots=True)
class MeasuredTurn:
    """Turn, with its move between two rests."""

    turn: AxisTurn
    move: AxesMove


@dataclass(slots=True)
class Measurements:
    """Measurements in the order in which they were made.

    has_turns
        Whether turns are wanted.
    order
        Sides and turns, for `undo`.
    moves
        Moves from a side to another one.
    """

    has_turns: bool
    order: list[AxesRest | MeasuredTurn] = field(default_factory=list)
    moves: list[AxesMove] = field(default_factory=list)

    @property
    def rests(self) -> tuple[AxesRest, ...]:
        """Rests on the sides."""
        return tuple(item for item in self.order if isinstance(item, AxesRest))

    @property
    def measured_turns(self) -> tuple[MeasuredTurn, ...]:
        """Turns with their moves."""
        return tuple(item for item in self.order if isinstance(item, MeasuredTurn))

    @property
    def turns(self) -> list[AxisTurn]:
        """Turns."""
        return [item.turn for item in self.measured_turns]

    @property
    def missing_sides(self) -> list[Side]:
        """Sides that were not measured."""
        return missing_sides(side_up(rest.accel_mps2).side for rest in self.rests)

    @property
    def missing_axes(self) -> list[str]:
        """Axes that were not turned in both directions; none if turns are not wanted."""
        return missing_turns(self.turns) if self.has_turns else []

    @property
    def is_complete(self) -> bool:
        """Whether all sides and turns were measured."""
        return not self.missing_sides and not self.missing_axes

    @property
    def missing_text(self) -> str:
        """Words for the sides and turns that are left."""
        parts = [f"{listed(self.missing_sides)} up"] if self.missing_sides else []
        parts += missing_turns_text(self.turns) if self.has_turns else []
        return "; ".join(parts) or "nothing"

    def undo(self) -> str:
        """Remove the last side or turn; its name, empty without any."""
        if not self.order:
            return ""
        match self.order.pop():
            case MeasuredTurn(turn=turn):
                return f"the last turn about {AXES[turn.axis]}"
            case AxesRest() as rest:
                return f"{side_up(rest.accel_mps2).side} up"

    def forget_turns(self) -> None:
        """Remove all turns."""
        self.order[:] = self.rests

    def accelerometer(self) -> AccelerometerFit:
        """Offset and scale; CalibrationError if sides are missing."""
        return fit_accelerometer(self.rests)

    def matrix(self, accelerometer: AccelerometerFit) -> MatrixFit | None:
        """Matrix of the gyro, from turns about the vertical of the calibrated accelerometer; None while turns miss.

        Raises
        ------
        CalibrationError
            The turns do not determine the matrix, or differ too much.
        """
        if missing_turns(self.turns):
            return None
        ups = []
        for done in self.measured_turns:
            mean = accelerometer.up(done.move.before) + accelerometer.up(done.move.after)
            ups.append(mean / np.linalg.norm(mean))
        up_se = float(accelerometer.offset_se_mps2.max()) / STANDARD_GRAVITY_MPS2
        return fit_matrix(self.turns, ups, up_se)

    def calibration(self, now: datetime, device_id: str, dps_per_lsb: float | None) -> Calibration:
        """Calibration with sign and scales of 1: the matrix contains them, or they were not measured.

        Raises
        ------
        CalibrationError
            Sides are missing, or the turns differ too much.
        """
        fit = self.accelerometer()
        matrix = self.matrix(fit)
        biases_dps = np.array([rest.gyro_dps for rest in self.rests])
        bias_dps = biases_dps.mean(axis=0)
        bias_se_dps = biases_dps.std(axis=0, ddof=1) / sqrt(len(biases_dps))
        temps_c = [rest.temp_c for rest in self.rests if isfinite(rest.temp_c)]
        scale_se = None if matrix is None else float(matrix.matrix_se[AXIS_Z, AXIS_Z])
        values: dict[str, Any] = {
            "accel_offset_mps2": _tuple(fit.offset_mps2),
            "accel_offset_se_mps2": _tuple(fit.offset_se_mps2),
            "accel_scale": _tuple(fit.scale),
            "accel_scale_se": _tuple(fit.scale_se),
            "gyro_bias_xy_dps": _tuple(bias_dps[:AXIS_Z]),
            "gyro_bias_xy_se_dps": _tuple(bias_se_dps[:AXIS_Z]),
            "gyro_matrix": None if matrix is None else tuple(map(_tuple, matrix.matrix)),
            "gyro_matrix_se": None if matrix is None else tuple(map(_tuple, matrix.matrix_se)),
        }
        return Calibration(
            date=now.isoformat(timespec="seconds"),
            device_id=device_id,
            scale_ccw_se=scale_se,
            scale_cw_se=scale_se,
            bias_dps=float(bias_dps[AXIS_Z]),
            bias_se_dps=float(bias_se_dps[AXIS_Z]),
            temp_c=float(np.mean(temps_c)) if temps_c else None,
            noise_dps_rthz=self.rests[0].noise_dps_rthz,
            dps_per_lsb=dps_per_lsb or self.rests[0].dps_per_lsb,
            turns=self.measured_turns[0].turn.turns if matrix is not None else None,
            mark_deg=None if matrix is None else matrix.mark_deg,
            **values,
        )

    def measured(self) -> dict[str, Any]:
        """Measurements for JSON."""
        return {
            "positions": [
                {
                    "up": side_up(rest.accel_mps2).side,
                    "accel_mps2": rest.accel_mps2.tolist(),
                    "gyro_dps": rest.gyro_dps.tolist(),
                }
                for rest in self.rests
            ],
            "turns": [
                {
                    "axis": AXES[done.turn.axis],
                    "turns": done.turn.turns,
                    "angle_deg": done.turn.up_angle_deg,
                    "angles_deg": done.turn.angles_deg.tolist(),
                }
                for done in self.measured_turns
            ],
            "gravity_residual_mps2": self.accelerometer().residual_mps2,
        }

    def gravity_error_deg(self) -> float | None:
        """Median angle between gravity after a move, and gravity as the gyro turned it; None with too few moves."""
        if len(self.moves) < MOVES_MIN:
            return None
        accelerometer = None if self.missing_sides else self.accelerometer()
        fit = None if accelerometer is None else self.matrix(accelerometer)
        matrix = np.eye(3) if fit is None else fit.matrix

        def up(rest: AxesRest) -> Floats:
            return rest.up if accelerometer is None else accelerometer.up(rest)

        return float(np.median([m.gravity_error_deg(matrix, up(m.before), up(m.after)) for m in self.moves]))

    def check_gravity(self) -> None:
        """Check that gravity turns as the gyro says.

        Raises
        ------
        CalibrationError
            It does not.
        """
        error_deg = self.gravity_error_deg()
        if error_deg is not None and error_deg > GRAVITY_ERROR_DEG:
            raise CalibrationError(
                f"gravity does not turn as the gyro says: {error_deg:.0f} deg apart after a move; axes of gyro or "
                "accelerometer are swapped or reversed, or a scale is wrong. gyrodrift doctor tells the axes"
            )


def over(new: Calibration, old: Calibration | None) -> Calibration:
    """A calibration by six positions, with the values of one axis that an old one of the device has.

    With a matrix, sign and scales are new too.
    """
    if old is None or not old.is_for(new.device_id):
        return new
    names = ["date", "device_id", "bias_dps", "bias_se_dps", "temp_c", "noise_dps_rthz", "dps_per_lsb"]
    names += [name for name in AXES_SHAPES if getattr(new, name) is not None]
    if new.gyro_matrix is not None:
        names += ["sign", "scale_ccw", "scale_ccw_se", "scale_cw", "scale_cw_se", "turns", "repeats", "mark_deg"]
    return replace(old, **{name: getattr(new, name) for name in names})


def _tuple(values: Floats) -> tuple[float, ...]:
    return tuple(values.tolist())
