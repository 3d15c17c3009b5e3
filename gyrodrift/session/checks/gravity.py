"""Accelerations of a recording: their unit and the direction of z by gravity, and their axes by those of the gyro."""

from collections.abc import Iterator

import numpy as np

from gyrodrift.columns.accel_axes import AGREES
from gyrodrift.columns.gravity import FREE_SHARE, gravity_unit, is_gravity
from gyrodrift.facts.session_facts import SessionFacts
from gyrodrift.session.checks.finding import SessionFinding
from gyrodrift.values.arrays import Floats
from gyrodrift.values.constants import STANDARD_GRAVITY_MPS2

UPSIDE_DOWN = -0.7
"""Median of the z component over the length: z points down by 135° of tilt or more."""


def acceleration_findings(facts: SessionFacts, *, is_stated: bool) -> Iterator[SessionFinding]:
    """Findings about the accelerations of a session in m/s²; none without them.

    is_stated
        Whether the user states their unit.
    """
    session = facts.session
    forces = np.empty((0, 3)) if session.accel_mps2 is None else session.accel_mps2
    forces = forces[np.isfinite(forces).all(axis=1)]
    if not len(forces):
        return
    length_mps2 = float(np.median(np.linalg.norm(forces, axis=1)))
    if is_gravity(length_mps2):
        yield from _direction(forces, length_mps2)
    elif not is_stated:
        yield _unit(length_mps2, length_mps2 / session.accel_scale)


def _unit(length_mps2: float, length: float) -> SessionFinding:
    """Finding about accelerations whose median length is not gravity; `length` is in the unit of the file."""
    if unit := gravity_unit(length):
        says = f"accelerations have a median length of {length:.4g}, which is gravity in {unit}"
        return SessionFinding("accel_unit", says, f"use --accel-unit {unit}")
    if length_mps2 < FREE_SHARE * STANDARD_GRAVITY_MPS2:
        says = (
            f"accelerations have a median length of {length_mps2:.4g} m/s²: gravity is missing, so the tilt is unknown"
        )
        return SessionFinding("accel_gravity", says, "record the accelerometer itself, not linear acceleration")
    says = f"accelerations have a median length of {length_mps2:.4g} m/s², gravity is 9.81"
    return SessionFinding("accel_unit", says, f"use --accel-unit lsb/{length:.4g} if they are counts")


def _direction(forces: Floats, length_mps2: float) -> Iterator[SessionFinding]:
    z_mps2 = float(np.median(forces[:, 2]))
    if z_mps2 < UPSIDE_DOWN * length_mps2:
        says = f"z measures {z_mps2:.3g} m/s²: the sensor is upside down, or it reports gravity with the opposite sign"
        yield SessionFinding("accel_sign", says, "if it stands upright, invert ax, ay and az with --columns")


def axis_findings(facts: SessionFacts) -> Iterator[SessionFinding]:
    """Finding about swapped or inverted axes of the accelerometer, if another order explains the tilt."""
    axes = facts.axes_agreement
    if axes is not None and axes.residual > AGREES >= axes.best_residual:
        says = f"gravity turns another way than the gyro says; it fits if {axes.named}"
        yield SessionFinding("accel_axes", says, f"name the columns of the acceleration {axes.spec}")
