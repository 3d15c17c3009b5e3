"""Errors of the axes as matrices: misalignment, cross-axis sensitivity and scale, of gyro and accelerometer.

All errors are 0 by default. Gyro and accelerometer are separate parts of a chip, with separate errors.
"""

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from firmware_sim.constants import STANDARD_GRAVITY_MPS2
from firmware_sim.effects.effect import Floats, Rng
from firmware_sim.effects.triaxial.effect import (
    Percent,
    SmallAngle,
    TriaxialAct,
    TriaxialEffect,
)

DpsPerG = Annotated[float, Field(ge=-5.0, le=5.0)]


def rotation_matrix(vector_deg: Floats) -> Floats:
    """Rotation by a vector (axis times angle, degrees), shape (3, 3): formula of Rodrigues."""
    angle = float(np.deg2rad(np.linalg.norm(vector_deg)))
    if angle == 0.0:
        return np.eye(3)
    x, y, z = vector_deg / np.linalg.norm(vector_deg)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    matrix: Floats = np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
    return matrix


class _Misaligned(TriaxialEffect):
    x_deg: SmallAngle = 0.0
    y_deg: SmallAngle = 0.0
    z_deg: SmallAngle = 0.0

    def matrix(self) -> Floats:
        """Values of the axes of the part for a vector in the sensor frame, shape (3, 3)."""
        return rotation_matrix(np.array([self.x_deg, self.y_deg, self.z_deg])).T


class _Crossed(TriaxialEffect):
    xy_percent: Percent = 0.0
    xz_percent: Percent = 0.0
    yx_percent: Percent = 0.0
    yz_percent: Percent = 0.0
    zx_percent: Percent = 0.0
    zy_percent: Percent = 0.0

    def matrix(self) -> Floats:
        """Ones on the diagonal, shape (3, 3)."""
        rows = (
            (100.0, self.xy_percent, self.xz_percent),
            (self.yx_percent, 100.0, self.yz_percent),
            (self.zx_percent, self.zy_percent, 100.0),
        )
        return np.array(rows) / 100.0


class _Scaled(TriaxialEffect):
    x_percent: Percent = 0.0
    y_percent: Percent = 0.0
    z_percent: Percent = 0.0

    def matrix(self) -> Floats:
        """Gains on the diagonal, shape (3, 3)."""
        return np.eye(3) + np.diag([self.x_percent, self.y_percent, self.z_percent]) / 100.0


def _on_gyro(matrix: Floats) -> TriaxialAct:
    return lambda sensed, _: sensed._replace(rates_dps=sensed.rates_dps @ matrix.T)


def _on_accelerometer(matrix: Floats) -> TriaxialAct:
    return lambda sensed, _: sensed._replace(force_mps2=sensed.force_mps2 @ matrix.T)


class GyroMisalignment(_Misaligned):
    """The gyro is turned against the case, by a rotation vector. Typical: 0.2 to 2° (soldering, assembly)."""

    name: Literal["gyro_misalignment"] = "gyro_misalignment"
    typical: ClassVar[dict[str, float]] = {"x_deg": 1.0, "y_deg": -0.7, "z_deg": 0.5}

    def begin_triaxial(self, rng: Rng) -> TriaxialAct:
        """Rotation of the rates."""
        return _on_gyro(self.matrix())


class AccelMisalignment(_Misaligned):
    """The accelerometer is turned against the case, by a rotation vector. Typical: 0.2 to 2°."""

    name: Literal["accel_misalignment"] = "accel_misalignment"
    typical: ClassVar[dict[str, float]] = {"x_deg": -0.6, "y_deg": 0.8, "z_deg": 0.4}

    def begin_triaxial(self, rng: Rng) -> TriaxialAct:
        """Rotation of the force."""
        return _on_accelerometer(self.matrix())


class GyroCrossAxis(_Crossed):
    """Share of an axis in the reading of another: `xy_percent` is that of y in x. Typical: ±2 % (MPU-6050, 6.1)."""

    name: Literal["gyro_cross_axis"] = "gyro_cross_axis"
    typical: ClassVar[dict[str, float]] = {"xy_percent": 1.0, "yz_percent": -1.5, "zx_percent": 2.0, "zy_percent": -1.0}

    def begin_triaxial(self, rng: Rng) -> TriaxialAct:
        """Mixture of the rates."""
        return _on_gyro(self.matrix())


class AccelCrossAxis(_Crossed):
    """Share of an axis in the reading of another: `xy_percent` is that of y in x. Typical: ±2 % (MPU-6050, 6.2)."""

    name: Literal["accel_cross_axis"] = "accel_cross_axis"
    typical: ClassVar[dict[str, float]] = {"xy_percent": -1.0, "xz_percent": 1.0, "yz_percent": 1.5, "zx_percent": 0.5}

    def begin_triaxial(self, rng: Rng) -> TriaxialAct:
        """Mixture of the force."""
        return _on_accelerometer(self.matrix())


class GyroScale(_Scaled):
    """Gain of each gyro axis. Typical: 0.5 to 3 % (sensitivity tolerance of MEMS data sheets)."""

    name: Literal["gyro_scale"] = "gyro_scale"
    typical: ClassVar[dict[str, float]] = {"x_percent": 1.0, "y_percent": -1.5, "z_percent": 0.8}

    def begin_triaxial(self, rng: Rng) -> TriaxialAct:
        """Gains of the rates."""
        return _on_gyro(self.matrix())


class AccelScale(_Scaled):
    """Gain of each accelerometer axis. Typical: 0.5 to 3 %."""

    name: Literal["accel_scale"] = "accel_scale"
    typical: ClassVar[dict[str, float]] = {"x_percent": 0.8, "y_percent": -0.6, "z_percent": 1.2}

    def begin_triaxial(self, rng: Rng) -> TriaxialAct:
        """Gains of the force."""
        return _on_accelerometer(self.matrix())


class GyroGSensitivity(TriaxialEffect):
    """Bias of each gyro axis per g along it, and per g across it. Typical: 0.1 deg/s/g (MPU-6050, 6.1)."""

    name: Literal["gyro_g_sensitivity"] = "gyro_g_sensitivity"
    x_dps_per_g: DpsPerG = 0.0
    y_dps_per_g: DpsPerG = 0.0
    z_dps_per_g: DpsPerG = 0.0
    across_dps_per_g: DpsPerG = 0.0
    typical: ClassVar[dict[str, float]] = {"x_dps_per_g": 0.1, "y_dps_per_g": -0.1, "z_dps_per_g": 0.1}

    def begin_triaxial(self, rng: Rng) -> TriaxialAct:
        """Linear in the force."""
        along = np.diag([self.x_dps_per_g, self.y_dps_per_g, self.z_dps_per_g])
        matrix = (along + self.across_dps_per_g * (np.ones((3, 3)) - np.eye(3))) / STANDARD_GRAVITY_MPS2
        return lambda sensed, _: sensed._replace(rates_dps=sensed.rates_dps + sensed.force_mps2 @ matrix.T)
