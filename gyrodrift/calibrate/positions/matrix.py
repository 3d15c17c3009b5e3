"""Scale and misalignment of a gyro, from whole turns with each axis up: gravity says about which axis it turned.

A turn by the angle a about the vertical u gives the integrated rates a·G·u, with the gain matrix G of the gyro. The
turns about three axes determine G by least squares, and the correction is its inverse.

Errors along the axis of a turn are those of the stops at the mark. A turn and the turn back share a stop. So
the errors of n turns of an axis are x₁ = d₁ − d₀, x₂ = d₁ − d₂, x₃ = d₃ − d₂ …, with independent d of variance s²:

    variance of the mean of x = (4n − 2)/n² · s²        expected sum of (x − mean)² = (2n − (4n − 2)/n) · s²

Errors across the axis come from noise, bias and the direction of gravity, independently for each turn.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np

from gyrodrift.calibrate.positions.block import AXES
from gyrodrift.values.arrays import Floats, Integers
from gyrodrift.values.errors import CalibrationError
from gyrodrift.values.words import listed

SPREAD_MAX = 0.01
"""Largest standard error of an entry: data sheets promise 2 % across and 3 % along without calibration."""

MARK_DEG, MARK_FREEDOM = 0.5, 3.0
"""Prior of the standard deviation of a stop, deg, and its weight in degrees of freedom: a person stops within half a
degree. Three pairs of turns alone may agree by chance."""


@dataclass(frozen=True, slots=True)
class AxisTurn:
    """Whole turns about the vertical.

    axis
        Index of the axis that is nearest to the vertical.
    turns
        Number of turns.
    up_angle_deg
        Angle about the vertical as the gyro read it, degrees; positive for counter-clockwise, seen from above.
    angles_deg
        Integrated rates without bias, degrees, shape (3,).
    """

    axis: int
    turns: int
    up_angle_deg: float
    angles_deg: Floats

    @property
    def is_ccw(self) -> bool:
        """Whether it is counter-clockwise, seen from above."""
        return self.up_angle_deg > 0.0


@dataclass(frozen=True, slots=True)
class MatrixFit:
    """Correction of the gyro and its standard errors, shape (3, 3).

    mark_deg
        Standard deviation of a stop at the mark, degrees.
    """

    matrix: Floats
    matrix_se: Floats
    mark_deg: float


def missing_turns(turns: Sequence[AxisTurn]) -> list[str]:
    """Axes that were not turned in both directions."""
    done = {(turn.axis, turn.is_ccw) for turn in turns}
    return [name for axis, name in enumerate(AXES) if not {(axis, True), (axis, False)} <= done]


def missing_turns_text(turns: Sequence[AxisTurn]) -> list[str]:
    """Words for the turns that are missing: axes there and back, and axes that were turned in one direction."""
    started = {AXES[turn.axis] for turn in turns}
    unstarted = [name for name in missing_turns(turns) if name not in started]
    back = [name for name in missing_turns(turns) if name in started]
    texts = [f"turns about {listed(unstarted)}, there and back"] if unstarted else []
    return [*texts, *([f"the turn back about {listed(back)}"] if back else [])]


def check_axes(turns: Sequence[AxisTurn]) -> None:
    """Check that turns determine the matrix.

    Raises
    ------
    CalibrationError
        An axis was not turned in both directions.
    """
    missing = missing_turns(turns)
    if not missing:
        return
    done = [name for name in AXES if name not in missing]
    so_far = f"only turns about {listed(done)} are complete" if done else "no axis was turned there and back"
    raise CalibrationError(
        f"{so_far}, so scale and misalignment of the gyro stay unknown; turn the board about {listed(missing)} too: "
        "with this axis up or down, a whole turn counter-clockwise and a whole turn back"
    )


def fit_matrix(turns: Sequence[AxisTurn], ups: Sequence[Floats], up_se: float) -> MatrixFit:
    """Correction of the gyro; `ups` are the vertical of each turn in the sensor, shape (3,), by the accelerometer.

    `up_se` is the standard error of an entry of a vertical.

    Raises
    ------
    CalibrationError
        The turns do not determine the matrix, or differ too much.
    """
    check_axes(turns)
    up = np.array(ups)
    whole_deg = np.array([(360.0 if turn.is_ccw else -360.0) * turn.turns for turn in turns])
    gains_of_turns = np.array([turn.angles_deg for turn in turns]) / whole_deg[:, None]
    gain = np.linalg.lstsq(up, gains_of_turns, rcond=None)[0].T
    residuals = gains_of_turns - up @ gain.T
    counts = np.bincount([turn.axis for turn in turns], minlength=3)
    along_deg = np.sum(residuals * up, axis=1) * np.abs(whole_deg)
    mark_deg = _mark_deg(along_deg, counts)
    stop = mark_deg / float(np.abs(whole_deg).mean())
    across = _deviation_across(residuals, up)
    shares = np.sqrt(np.diag(np.linalg.inv(up.T @ up)))
    gain_se = np.where(np.eye(3) > 0.0, stop * np.sqrt(_mean_variances(counts)), np.hypot(across * shares, up_se))
    matrix = np.linalg.inv(gain)
    matrix_se = np.sqrt(matrix**2 @ gain_se**2 @ (matrix**2))
    if matrix_se.max() > SPREAD_MAX:
        raise CalibrationError(
            f"the turns differ too much: a standard error of the matrix is {matrix_se.max():.1%}, above "
            f"{SPREAD_MAX:.0%}; turn several turns at a time with --turns 5, or use a finer mark"
        )
    return MatrixFit(matrix, matrix_se, mark_deg)


def _mean_variances(counts: Integers) -> Floats:
    """Variance of the mean error of each axis, in units of the variance of a stop."""
    variances: Floats = (4.0 * counts - 2.0) / counts**2
    return variances


def _mark_deg(along_deg: Floats, counts: Integers) -> float:
    """Standard deviation of a stop at the mark, deg, from the errors along the axes and the prior."""
    freedom = float(np.sum(2.0 * counts - counts * _mean_variances(counts)))
    squares = float(np.sum(along_deg**2)) + MARK_FREEDOM * MARK_DEG**2
    return sqrt(squares / (freedom + MARK_FREEDOM))


def _deviation_across(residuals: Floats, up: Floats) -> float:
    """Standard deviation across the axis of a turn, from two directions for each; six entries are fitted."""
    across = residuals - np.sum(residuals * up, axis=1)[:, None] * up
    return sqrt(float(np.sum(across**2)) / (2 * len(residuals) - 6))
