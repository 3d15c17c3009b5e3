"""Axes of the accelerometer against those of the gyro: a turn of the sensor turns gravity in its frame.

In the frame of the sensor gravity changes by da/dt = −ω × a. Swapped axes or signs of the accelerometer break this.
"""

from collections.abc import Iterator

import numpy as np

from gyrodrift.columns.accel_axes import AGREES, TURN_MIN_DEG, WINDOW_S, Agreement, frames
from gyrodrift.session.checks.finding import SessionFinding
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats

WINDOWS_MIN = 8
"""Windows with a tilt that are needed for a comparison: chosen."""


def axis_findings(session: Session) -> Iterator[SessionFinding]:
    """Finding about swapped or inverted axes of the accelerometer, if another order explains the tilt."""
    axes = agreement(session)
    if axes is not None and axes.residual > AGREES >= axes.best_residual:
        says = f"gravity turns another way than the gyro says; it fits if {axes.named}"
        yield SessionFinding("accel_axes", says, f"name the columns of the acceleration {axes.spec}")


def agreement(session: Session) -> Agreement | None:
    """Compare the turn of gravity with the gyro; None without enough tilt.

    In the sensor a constant vector u changes by −∫ω×u. Of the 48 ways to exchange and reverse the axes of the
    acceleration the true one leaves the least residual. A reversal of all three at once changes no residual and cannot
    be found.
    """
    if session.gyro_dps is None or session.accel_mps2 is None:
        return None
    is_finite = np.isfinite(session.accel_mps2).all(axis=1) & np.isfinite(session.gyro_dps).all(axis=1)
    t_s, gyro_dps, accel = session.t_device_s[is_finite], session.gyro_dps[is_finite], session.accel_mps2[is_finite]
    if len(t_s) < WINDOWS_MIN:
        return None
    means, _ = windows(t_s, accel)
    turns_rad, _ = windows(t_s, np.deg2rad(_integrals(t_s, gyro_dps)))
    directions = means / np.maximum(np.linalg.norm(means, axis=1, keepdims=True), 1e-12)
    changes, rotations = np.diff(directions, axis=0), np.diff(turns_rad, axis=0)
    middles = 0.5 * (directions[1:] + directions[:-1])
    tilted = np.linalg.norm(changes, axis=1) > np.deg2rad(TURN_MIN_DEG)
    if tilted.sum() < WINDOWS_MIN:
        return None
    residuals = {
        axes: _residual(matrix, changes[tilted], rotations[tilted], middles[tilted]) for axes, matrix in _frames()
    }
    best = min(residuals, key=lambda axes: residuals[axes])
    return Agreement(residuals["+x", "+y", "+z"], best, residuals[best])


def _residual(matrix: Floats, changes: Floats, rotations: Floats, middles: Floats) -> float:
    """Median of |change + rotation × direction| / |change| with exchanged axes of the acceleration."""
    expected = -np.cross(rotations, middles @ matrix.T)
    difference = np.linalg.norm(changes @ matrix.T - expected, axis=1)
    return float(np.median(difference / np.linalg.norm(changes, axis=1)))


def _frames() -> Iterator[tuple[tuple[str, ...], Floats]]:
    """Ways to exchange and reverse axes, with the matrix that applies each."""
    for names, (order, signs) in frames().items():
        matrix = np.zeros((3, 3))
        matrix[range(3), order] = signs
        yield names, matrix


def _integrals(t_s: Floats, rates: Floats) -> Floats:
    """Running integrals of the columns by the trapezium, from 0."""
    steps = 0.5 * (rates[1:] + rates[:-1]) * np.diff(t_s)[:, None]
    integrals: Floats = np.vstack([np.zeros(rates.shape[1]), np.cumsum(steps, axis=0)])
    return integrals


def windows(t_s: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Means of the columns over windows, and the scatter of the samples within, root of the mean variance."""
    index = np.floor((t_s - t_s[0]) / WINDOW_S).astype(int)
    _, first, counts = np.unique(index, return_index=True, return_counts=True)
    sums, squares = np.add.reduceat(values, first, axis=0), np.add.reduceat(values**2, first, axis=0)
    means = sums / counts[:, None]
    variances = np.maximum(squares / counts[:, None] - means**2, 0.0)
    return means, np.sqrt(variances.mean(axis=1))
