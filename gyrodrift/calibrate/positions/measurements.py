"""Rests, turns and moves that were measured so far, and what they determine."""

from dataclasses import dataclass, field

import numpy as np

from gyrodrift.calibrate.positions.accelerometer import AccelerometerFit, fit_accelerometer
from gyrodrift.calibrate.positions.block import AxesRest
from gyrodrift.calibrate.positions.matrix import AxisTurn, MatrixFit, missing_turns, missing_turns_text
from gyrodrift.calibrate.positions.motion import AxesMove
from gyrodrift.calibrate.positions.result import MeasuredTurn, SixPositions, matrix_of
from gyrodrift.calibrate.positions.sides import AXES, Side, listed, missing_sides, side_up
from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import CalibrationError

MOVES_MIN = 3
GRAVITY_ERROR_DEG = 20.0
"""Number of moves, and their median error of gravity, from which gyro and accelerometer disagree: swapped or reversed
axes give 60° and more, uncalibrated axes less than 10°."""


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
        """Axes that were not measured_turns in both directions; none if turns are not wanted."""
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
        """Matrix of the gyro; None while turns are missing. CalibrationError if the turns differ too much."""
        return None if missing_turns(self.turns) else matrix_of(self.measured_turns, accelerometer)

    def positions(self) -> SixPositions:
        """All results; CalibrationError if sides are missing or the turns differ too much."""
        accelerometer = self.accelerometer()
        return SixPositions(self.rests, self.measured_turns, accelerometer, self.matrix(accelerometer))

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
