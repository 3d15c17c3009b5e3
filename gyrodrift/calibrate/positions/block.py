"""Short blocks of samples with three axes, what a row of still blocks measures, and the side that points up."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import inf, isfinite, nan, sqrt
from typing import Literal, NamedTuple, get_args

import numpy as np

from gyrodrift.facts.arrays import smallest_step, white_noise
from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import CalibrationError
from gyrodrift.values.sample import Sample

AXES = "xyz"
Side = Literal["+x", "-x", "+y", "-y", "+z", "-z"]
SIDES: tuple[Side, ...] = get_args(Side)

TILT_MAX_DEG = 30.0
"""Largest angle between the axis of a side and the vertical, deg: halfway to the next side is 45°. Chosen."""

AXIS_Z = 2


class SideUp(NamedTuple):
    """Side, and the angle between its axis and the measured acceleration, deg."""

    side: Side
    tilt_deg: float

    @property
    def axis(self) -> int:
        """Index of the axis."""
        return AXES.index(self.side[1])


def side_up(accel_mps2: Floats) -> SideUp:
    """Side whose axis is nearest to an acceleration at rest, shape (3,)."""
    axis = int(np.abs(accel_mps2).argmax())
    share = abs(float(accel_mps2[axis])) / float(np.linalg.norm(accel_mps2))
    side = SIDES[2 * axis + (1 if accel_mps2[axis] < 0.0 else 0)]
    return SideUp(side, float(np.rad2deg(np.arccos(min(1.0, share)))))


def missing_sides(measured: Iterable[Side]) -> list[Side]:
    """Sides that are not among the measured ones."""
    present = set(measured)
    return [side for side in SIDES if side not in present]


@dataclass(frozen=True, slots=True)
class AxesBlock:
    """Samples of a quarter of a second.

    t_s
        Device clock, s, shape (n,).
    gyro_dps, accel_mps2
        Measured rates and accelerations, shape (n, 3).
    temp_c
        Temperature, °C; NaN without a sensor.
    """

    t_s: Floats
    gyro_dps: Floats
    accel_mps2: Floats
    temp_c: float


def block_of(samples: Sequence[Sample]) -> AxesBlock:
    """Block of samples; an acceleration that is missing in some samples is that of the sample before.

    Raises
    ------
    CalibrationError
        The device does not send three rates and accelerations.
    """
    axes = np.array([sample.inertial for sample in samples if sample.inertial is not None])
    if len(axes) < len(samples) or not np.isfinite(axes[:, 3:]).all(axis=1).any():
        raise CalibrationError(
            "the device does not send three rates and three accelerations, which six positions need; for a text, name "
            "them in --columns: gx, gy, gz, ax, ay, az"
        )
    t_s = np.array([sample.t_device_s for sample in samples])
    if not (np.diff(t_s) > 0.0).all():
        raise CalibrationError("the time of the device stands still or goes back")
    temps_c = [sample.temp_c for sample in samples if isfinite(sample.temp_c)]
    return AxesBlock(t_s, axes[:, :3], _filled(axes[:, 3:]), float(np.mean(temps_c)) if temps_c else nan)


def _filled(accel: Floats) -> Floats:
    """Accelerations in which missing rows repeat the row before, or the first one."""
    present = np.flatnonzero(np.isfinite(accel).all(axis=1))
    index = np.searchsorted(present, np.arange(len(accel)), side="right") - 1
    filled: Floats = accel[present[np.maximum(index, 0)]]
    return filled


@dataclass(frozen=True, slots=True)
class AxesRest:
    """Means at rest and their standard errors from scatter and rounding; arrays of shape (3,).

    middle_s
        Device time of the middle, s.
    temp_c
        Mean temperature, °C; NaN without a sensor.
    noise_dps_rthz, dps_per_lsb
        White noise of the rate about z, deg/s/√Hz, and its smallest step, deg/s; None if all samples are equal.
    """

    middle_s: float
    gyro_dps: Floats
    accel_mps2: Floats
    accel_se_mps2: Floats
    temp_c: float
    noise_dps_rthz: float
    dps_per_lsb: float | None

    @property
    def up(self) -> Floats:
        """Direction of the measured acceleration."""
        unit: Floats = self.accel_mps2 / np.linalg.norm(self.accel_mps2)
        return unit


def rest_of_blocks(blocks: Sequence[AxesBlock], accel_step_mps2: float = inf) -> AxesRest:
    """Means over still blocks, at least two; the step of the accelerometer is infinite if it is unknown."""
    gyros, accels = (
        np.array([values.mean(axis=0) for values in column])
        for column in ([block.gyro_dps for block in blocks], [block.accel_mps2 for block in blocks])
    )
    z_dps, t_s = (
        np.concatenate([block.gyro_dps[:, AXIS_Z] for block in blocks]),
        np.concatenate([block.t_s for block in blocks]),
    )
    return AxesRest(
        middle_s=0.5 * float(blocks[0].t_s[0] + blocks[-1].t_s[-1]),
        gyro_dps=gyros.mean(axis=0),
        accel_mps2=accels.mean(axis=0),
        accel_se_mps2=np.hypot(
            accels.std(axis=0, ddof=1) / sqrt(len(accels)),
            _rounding(np.concatenate([block.accel_mps2 for block in blocks]), accel_step_mps2),
        ),
        temp_c=float(np.mean([block.temp_c for block in blocks])),
        noise_dps_rthz=white_noise(z_dps) * sqrt(float(np.median(np.diff(t_s)))),
        dps_per_lsb=smallest_step(z_dps),
    )


def _rounding(values: Floats, step: float) -> Floats:
    """Standard deviation of the mean of rounded values, per column: noise above half a step averages it out.

    step/√12 without noise, and the decay of the first harmonic with it (Widrow and Kollár 2008, Quantization Noise).
    """
    if not isfinite(step):
        return np.zeros(values.shape[1])
    rounding: Floats = step / sqrt(12.0) * np.exp(-2.0 * (np.pi * values.std(axis=0) / step) ** 2)
    return rounding
