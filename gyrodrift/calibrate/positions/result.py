"""Calibration of three axes from rests and turns, beside the values of one axis that the device has already."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from math import isfinite, sqrt
from typing import Any

import numpy as np

from gyrodrift.calibrate.positions.accelerometer import AccelerometerFit
from gyrodrift.calibrate.positions.block import AXIS_Z, AxesRest
from gyrodrift.calibrate.positions.matrix import AxisTurn, MatrixFit, fit_matrix
from gyrodrift.calibrate.positions.motion import AxesMove
from gyrodrift.calibrate.positions.sides import AXES, side_up
from gyrodrift.values.arrays import Floats
from gyrodrift.values.calibration import AXES_SHAPES, Calibration
from gyrodrift.values.constants import STANDARD_GRAVITY_MPS2


@dataclass(frozen=True, slots=True)
class MeasuredTurn:
    """Turn, with its move between two rests."""

    turn: AxisTurn
    move: AxesMove


def matrix_of(measured_turns: Sequence[MeasuredTurn], accelerometer: AccelerometerFit) -> MatrixFit:
    """Matrix of the gyro from turns about the vertical that the calibrated accelerometer measures.

    Raises
    ------
    CalibrationError
        The turns do not determine the matrix, or differ too much.
    """
    ups = []
    for done in measured_turns:
        mean = accelerometer.up(done.move.before) + accelerometer.up(done.move.after)
        ups.append(mean / np.linalg.norm(mean))
    up_se = float(accelerometer.offset_se_mps2.max()) / STANDARD_GRAVITY_MPS2
    return fit_matrix([done.turn for done in measured_turns], ups, up_se)


@dataclass(frozen=True, slots=True)
class SixPositions:
    """All measurements.

    rests
        Rests on the sides, in order.
    turned
        Turns about the axes.
    accelerometer, matrix
        Results; the matrix is None without turns.
    """

    rests: tuple[AxesRest, ...]
    measured_turns: tuple[MeasuredTurn, ...]
    accelerometer: AccelerometerFit
    matrix: MatrixFit | None

    def calibration(self, now: datetime, device_id: str, dps_per_lsb: float | None) -> Calibration:
        """Calibration with sign and scales of 1: the matrix contains them, or they were not measured."""
        biases_dps = np.array([rest.gyro_dps for rest in self.rests])
        bias_dps = biases_dps.mean(axis=0)
        bias_se_dps = biases_dps.std(axis=0, ddof=1) / sqrt(len(biases_dps))
        temps_c = [rest.temp_c for rest in self.rests if isfinite(rest.temp_c)]
        fit, matrix = self.accelerometer, self.matrix
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
            "gravity_residual_mps2": self.accelerometer.residual_mps2,
        }


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
