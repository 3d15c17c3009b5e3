"""Offset and scale of an accelerometer from rests in several positions: the size of gravity is known.

Least squares on |scale · (measured − offset)| = g over all rests: an ellipsoid whose axes are those of the sensor
(Frosio, Pedersini and Borghese 2009, DOI 10.1109/TIM.2008.2006137, without cross-axis terms). The direction of a rest
does not matter, so the board may lie askew. Gravity differs from its standard by 0.3 % at most: all scales together
may be as wrong, which turns no axis.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.calibrate.positions.block import AxesRest, missing_sides, side_up
from gyrodrift.values.arrays import Floats
from gyrodrift.values.constants import STANDARD_GRAVITY_MPS2
from gyrodrift.values.errors import CalibrationError
from gyrodrift.values.words import listed

STABILITY_MPS2 = 0.005
"""Smallest standard deviation of a rest, m/s²: offsets of MEMS change by 0.5 mg within minutes. Chosen."""

SIZES = (0.5, 1.5)
"""Accepted size of a measured acceleration, in g: offset and scale of all data sheets stay within."""

ROUNDS = 20
"""Steps of Gauss and Newton; three are enough from a scale of 1."""

OFFSET_MAX_MPS2, SCALE_RANGE = 5.0, (0.7, 1.4)
"""Accepted results: more is another unit or a broken part. Data sheets: 0.8 m/s² and 3 % (MPU-6050, 6.2)."""


@dataclass(frozen=True, slots=True)
class AccelerometerFit:
    """Offsets in m/s², scales, and their standard errors; arrays of shape (3,).

    residual_mps2
        Root mean square of the difference to gravity, m/s².
    """

    offset_mps2: Floats
    offset_se_mps2: Floats
    scale: Floats
    scale_se: Floats
    residual_mps2: float

    def true(self, measured_mps2: Floats) -> Floats:
        """True acceleration for a measured one, shape (3,)."""
        accel: Floats = self.scale * (measured_mps2 - self.offset_mps2)
        return accel

    def up(self, rest: AxesRest) -> Floats:
        """Direction of the vertical in the sensor, shape (3,)."""
        accel = self.true(rest.accel_mps2)
        unit: Floats = accel / np.linalg.norm(accel)
        return unit


def check_size(rest: AxesRest) -> None:
    """Check that an acceleration at rest may be gravity in m/s².

    Raises
    ------
    CalibrationError
        It is too small or too large.
    """
    size = float(np.linalg.norm(rest.accel_mps2))
    if SIZES[0] <= size / STANDARD_GRAVITY_MPS2 <= SIZES[1]:
        return
    unit = ": it is in g; name the unit in --columns, such as ax:g" if SIZES[0] <= size <= SIZES[1] else ""
    raise CalibrationError(
        f"the acceleration at rest is {size:.3g} m/s², and gravity is 9.81"
        + (unit or ": check the unit and the range of the accelerometer")
    )


def fit_accelerometer(rests: Sequence[AxesRest]) -> AccelerometerFit:
    """Offset and scale of each axis.

    Raises
    ------
    CalibrationError
        A side is missing, or the result is impossible.
    """
    missing = missing_sides(side_up(rest.accel_mps2).side for rest in rests)
    if missing:
        raise CalibrationError(
            f"{len(missing)} of six sides were not measured: offset and scale cannot be told apart; lay the board down "
            f"with {listed(missing)} up too"
        )
    measured = np.array([rest.accel_mps2 for rest in rests])
    offset, scale = np.zeros(3), np.ones(3)
    for _ in range(ROUNDS):
        jacobian, residuals = _linearized(measured, offset, scale)
        step = np.linalg.lstsq(jacobian, -residuals, rcond=None)[0]
        offset, scale = offset + step[:3], scale + step[3:]
    jacobian, residuals = _linearized(measured, offset, scale)
    sigmas = np.array([_sigma(rest) for rest in rests])
    covariance = _covariance(jacobian, residuals, sigmas)
    errors = np.sqrt(np.diag(covariance))
    _check_result(offset, scale)
    return AccelerometerFit(offset, errors[:3], scale, errors[3:], float(np.sqrt(np.mean(residuals**2))))


def _linearized(measured: Floats, offset: Floats, scale: Floats) -> tuple[Floats, Floats]:
    """Derivatives of the size by offsets and scales, shape (n, 6), and its difference to gravity, shape (n,)."""
    true = scale * (measured - offset)
    sizes = np.linalg.norm(true, axis=1)
    units = true / sizes[:, None]
    return np.hstack([-units * scale, units * (measured - offset)]), sizes - STANDARD_GRAVITY_MPS2


def _sigma(rest: AxesRest) -> float:
    """Standard deviation of the size of an acceleration, m/s²."""
    along = float(np.linalg.norm(rest.up * rest.accel_se_mps2))
    return max(STABILITY_MPS2, along)


def _covariance(jacobian: Floats, residuals: Floats, sigmas: Floats) -> Floats:
    """Covariance for ordinary least squares; larger if the residuals are larger than the rests let expect."""
    inverse = np.linalg.pinv(jacobian)
    freedom = len(residuals) - jacobian.shape[1]
    excess = float(np.sum((residuals / sigmas) ** 2)) / freedom if freedom > 0 else 1.0
    covariance: Floats = (inverse * sigmas**2) @ inverse.T * max(1.0, excess)
    return covariance


def _check_result(offset: Floats, scale: Floats) -> None:
    if np.abs(offset).max() > OFFSET_MAX_MPS2 or scale.min() < SCALE_RANGE[0] or scale.max() > SCALE_RANGE[1]:
        raise CalibrationError(
            f"the accelerometer would have an offset of up to {np.abs(offset).max():.1f} m/s² and scales from "
            f"{scale.min():.2f} to {scale.max():.2f}, more than any part: does an axis stay at the end of its range?"
        )
