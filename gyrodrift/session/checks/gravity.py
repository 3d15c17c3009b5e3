"""Unit of the accelerations of a recording, by gravity: their median length is 9.81 m/s²."""

from collections.abc import Iterator

import numpy as np

from gyrodrift.columns.spec import ACCELERATION_MPS2, STANDARD_GRAVITY_MPS2
from gyrodrift.session.checks.finding import SessionFinding
from gyrodrift.session.session import Session

NEAR = 0.25
"""Largest relative error of the length of gravity: biases, scale errors and the forces of a motion are smaller."""

FREE_SHARE = 0.2
"""Accelerations whose median length is a smaller share of gravity are without gravity."""

COUNTS_PER_G = tuple(float(1 << bits) for bits in range(8, 16))
"""Counts of 10 to 16 bits at ±1 to ±16 g (data sheets of ADXL345, MMA8452, LIS3DH and MPU-6050)."""


def acceleration_findings(session: Session, *, is_stated: bool) -> Iterator[SessionFinding]:
    """Findings about the accelerations of a session in m/s²; none without them.

    is_stated
        Whether the user states their unit.
    """
    length_mps2 = _median_length(session)
    if length_mps2 is None or is_stated or _is_near(length_mps2, STANDARD_GRAVITY_MPS2):
        return
    length = length_mps2 / session.accel_scale
    is_like = f"accelerations have a median length of {length:.4g}"
    if unit := _unit_of(length):
        yield SessionFinding("accel_unit", f"{is_like}, which is gravity in {unit}", f"use --accel-unit {unit}")
    elif length_mps2 < FREE_SHARE * STANDARD_GRAVITY_MPS2:
        says = f"{is_like} m/s²: gravity is missing from them, so they do not show the tilt"
        yield SessionFinding("accel_gravity", says, "record the accelerometer itself, not linear acceleration")
    else:
        says = f"accelerations have a median length of {length_mps2:.4g} m/s², gravity is 9.81"
        yield SessionFinding("accel_unit", says, f"use --accel-unit lsb/{length:.4g} if they are counts")


def _median_length(session: Session) -> float | None:
    """Median length of the finite accelerations, m/s²; None without any."""
    if session.accel_mps2 is None:
        return None
    lengths = np.linalg.norm(session.accel_mps2, axis=1)
    finite = lengths[np.isfinite(lengths)]
    return float(np.median(finite)) if len(finite) else None


def _unit_of(length: float) -> str:
    """Unit in which a length is gravity; empty if there is none."""
    named = {unit: STANDARD_GRAVITY_MPS2 / scale for unit, scale in ACCELERATION_MPS2.items()}
    counted = {f"lsb/{counts:.0f}": counts for counts in COUNTS_PER_G if not _is_near(counts, named["mg"])}
    return next((unit for unit, size in (named | counted).items() if _is_near(length, size)), "")


def _is_near(length: float, gravity: float) -> bool:
    return abs(length - gravity) <= NEAR * gravity
