"""From the scene to the measurements of one session.

The gyro feels the rate of the fine grid, and its filters pass rate and noise. A sample is the rate at one moment,
without an average. The encoder's angle is that of the same moment.
"""

from dataclasses import dataclass, replace
from math import sqrt

import numpy as np

from gyrogap.physics.device import DrawnDevice
from gyrogap.physics.dice import Path, effect_dice, noise_dice
from gyrogap.physics.kinds import KINDS, ORDER, InjectedEffect, InjectionPoint
from gyrogap.physics.motion import Floats
from gyrogap.physics.scene import TableScene
from gyrogap.physics.three_axes import gravity_mps2, turning
from gyrogap.physics.three_axis_effects import ON_EVERY_AXIS, mount_of

MOST_COUNTS = 32767
EPOCH_S, EPOCHS_S = 1_700_000_000, 40_000_000
MICRO = 1e6


X_Y_Z = ("x", "y", "z")


@dataclass(frozen=True, slots=True)
class AxisColumns:
    """Columns of three axes, shape (rows, 3): rates in deg/s and specific forces in m/s² along x, y and z."""

    gyro_dps: Floats
    accel_mps2: Floats


@dataclass(frozen=True, slots=True)
class Columns:
    """Columns of a session file, shape (rows,); `axes` is None for a device of one axis."""

    t_device_s: Floats
    t_host_s: Floats
    seq: Floats
    rate_dps: Floats
    encoder_deg: Floats
    temp_c: Floats
    axes: AxisColumns | None = None


class _Acts:
    """Effects of a case by point, with separate random numbers."""

    def __init__(self, faults: tuple[InjectedEffect, ...], path: Path) -> None:
        self._faults = sorted((fault for fault in faults if fault.name in KINDS), key=lambda fault: ORDER[fault.name])
        self._path = path

    def of_point(self, point: InjectionPoint) -> list[InjectedEffect]:
        return [fault for fault in self._faults if KINDS[fault.name][0] == point]

    def through(self, point: InjectionPoint, values: Floats, scene: TableScene) -> Floats:
        for fault in self.of_point(point):
            dice = effect_dice((*self._path, fault.name))
            values = KINDS[fault.name][1](values, scene, dice, **fault.parameters)
        return values


def measure(
    scene: TableScene, device: DrawnDevice, session: int, faults: tuple[InjectedEffect, ...], path: Path
) -> Columns:
    """Measurements of session number `session`; `path` leads to its random numbers."""
    acts = _Acts((*faults, *device.healthy_filters), path)
    stamp_s, arrival_s, first = _times(scene, device, acts, path)
    rows = acts.through(InjectionPoint.ROWS, np.arange(len(scene.t_s), dtype=np.float64), scene).astype(np.intp)
    axes = _axes(scene, device, session, faults, path)
    rate_dps = _rate(scene, device, device.bias_dps[session], acts, path) if axes is None else axes.gyro_dps[:, 2]
    return Columns(
        t_device_s=stamp_s[rows],
        t_host_s=np.maximum.accumulate(arrival_s[rows]),
        seq=first + rows.astype(np.float64),
        rate_dps=rate_dps[rows],
        encoder_deg=_encoder(scene, device, acts)[rows],
        temp_c=np.round(scene.temp_c, 2)[rows],
        axes=axes and AxisColumns(axes.gyro_dps[rows], axes.accel_mps2[rows]),
    )


def _axes(
    scene: TableScene, device: DrawnDevice, session: int, faults: tuple[InjectedEffect, ...], path: Path
) -> AxisColumns | None:
    """Rates and forces at all samples, shape (samples, 3); effects of `ON_EVERY_AXIS` act on all of them."""
    if device.three_axes is None:
        return None
    axes, mount = device.three_axes, mount_of(faults)
    biases_dps = (*axes.bias_xy_dps[session], device.bias_dps[session])
    rates = []
    for name, share, bias_dps in zip(X_Y_Z, mount.turn, biases_dps, strict=True):
        own = tuple(fault for fault in faults if name == "z" or fault.name in ON_EVERY_AXIS)
        acts = _Acts((*own, *device.healthy_filters), path)
        rates.append(_rate(turning(scene, share), device, bias_dps, acts, path if name == "z" else (*path, name)))
    dice = noise_dice((*path, "accelerometer"))
    force_mps2 = gravity_mps2(scene, axes) @ mount.force.T + mount.offset_mps2 + axes.offset_mps2
    noise_mps2 = dice.normal(0.0, axes.noise_mps2_rthz * sqrt(scene.sample_hz), force_mps2.shape)
    counts = np.rint((force_mps2 + noise_mps2) / axes.mps2_per_lsb)
    return AxisColumns(np.column_stack(rates), np.clip(counts, -MOST_COUNTS, MOST_COUNTS) * axes.mps2_per_lsb + 0.0)


def _rate(scene: TableScene, device: DrawnDevice, bias_dps: float, acts: _Acts, path: Path) -> Floats:
    """Rate as read out, deg/s: whole counts."""
    felt_dps = acts.through(InjectionPoint.FELT, scene.fine_dps, scene)
    sampled_dps = acts.through(InjectionPoint.PASSED, felt_dps, scene)[:: scene.fine]
    sampled = replace(scene, rate_dps=sampled_dps)
    gained_dps = acts.through(InjectionPoint.GAIN, sampled_dps, sampled)
    rate_dps = gained_dps + _noise(scene, device, acts, path) + bias_dps
    counts = np.rint(acts.through(InjectionPoint.OUTPUT, rate_dps, sampled) / device.dps_per_lsb)
    return acts.through(InjectionPoint.READ, np.clip(counts, -MOST_COUNTS, MOST_COUNTS), sampled) * device.dps_per_lsb


def _noise(scene: TableScene, device: DrawnDevice, acts: _Acts, path: Path) -> Floats:
    """White noise at the samples; behind a filter, filtered white noise of the fine grid."""
    dice = noise_dice((*path, "noise"))
    if not acts.of_point(InjectionPoint.PASSED):
        return dice.normal(0.0, device.noise_dps_rthz * sqrt(scene.sample_hz), len(scene.t_s))
    fine = dice.normal(0.0, device.noise_dps_rthz * sqrt(scene.fine_hz), len(scene.fine_dps))
    return acts.through(InjectionPoint.PASSED, fine, scene)[:: scene.fine]


def _encoder(scene: TableScene, device: DrawnDevice, acts: _Acts) -> Floats:
    """Angle as counted, degrees."""
    shaft_deg = acts.through(InjectionPoint.ANGLE, scene.fine_deg, scene)[:: scene.fine]
    count_deg = 360.0 / device.encoder_cpr
    counts = np.rint(acts.through(InjectionPoint.COUNTED, shaft_deg, scene) / count_deg)
    zeroed = counts if device.encoder_absolute else counts - counts[0]
    return zeroed * count_deg + 0.0  # no minus zero


def _times(scene: TableScene, device: DrawnDevice, acts: _Acts, path: Path) -> tuple[Floats, Floats, int]:
    """Device stamps and arrivals in whole microseconds, s, and the counter of the first sample."""
    dice = noise_dice((*path, "times"))
    count = len(scene.t_s)
    healthy_s = scene.powered_s * (1.0 + device.clock_ppm * 1e-6) + dice.normal(0.0, device.stamp_scatter_s, count)
    stamp_s = acts.through(InjectionPoint.STAMP, np.maximum(healthy_s, 0.0), scene)
    delay_s = device.host_delay_s + dice.gamma(1.0, device.host_scatter_s, count)
    arrival_s = np.maximum.accumulate(acts.through(InjectionPoint.ARRIVAL, scene.t_s + delay_s, scene))
    epoch_s = EPOCH_S + int(dice.integers(EPOCHS_S))
    first = int(scene.powered_s[0] * scene.sample_hz)
    return np.rint(stamp_s * MICRO) / MICRO, epoch_s + np.rint((arrival_s + 1.0) * MICRO) / MICRO, first
