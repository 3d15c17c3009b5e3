"""From the scene to the measurements of one session.

The gyro feels the rate of the fine grid; filters, if it has any, pass rate and noise; then the rate at the very moment
of a sample is taken, nothing is averaged. The encoder's angle is taken at the same moment.
"""

from dataclasses import dataclass, replace
from math import sqrt

import numpy as np

from blind.generator.device import Device
from blind.generator.dice import Path, effect_dice, noise_dice
from blind.generator.kinds import KINDS, ORDER, Fault, Place
from blind.generator.motion import Floats
from blind.generator.scene import Scene

MOST_COUNTS = 32767
EPOCH_S, EPOCHS_S = 1_700_000_000, 40_000_000
MICRO = 1e6


@dataclass(frozen=True, slots=True)
class Columns:
    """What a session file holds; shape (rows,) each."""

    t_device_s: Floats
    t_host_s: Floats
    seq: Floats
    rate_dps: Floats
    encoder_deg: Floats
    temp_c: Floats


class _Acts:
    """The faults of a case by place, each with dice of its own."""

    def __init__(self, faults: tuple[Fault, ...], path: Path) -> None:
        self._faults = sorted(faults, key=lambda fault: ORDER[fault.name])
        self._path = path

    def at(self, place: Place) -> list[Fault]:
        return [fault for fault in self._faults if KINDS[fault.name][0] == place]

    def through(self, place: Place, values: Floats, scene: Scene) -> Floats:
        for fault in self.at(place):
            dice = effect_dice((*self._path, fault.name))
            values = KINDS[fault.name][1](values, scene, dice, **fault.parameters)
        return values


def measure(scene: Scene, device: Device, session: int, faults: tuple[Fault, ...], path: Path) -> Columns:
    """Measurements of session number `session`; `path` leads to its random numbers."""
    acts = _Acts((*faults, *device.healthy_filters), path)
    stamp_s, arrival_s, first = _times(scene, device, acts, path)
    rows = acts.through(Place.ROWS, np.arange(len(scene.t_s), dtype=np.float64), scene).astype(np.intp)
    return Columns(
        t_device_s=stamp_s[rows],
        t_host_s=np.maximum.accumulate(arrival_s[rows]),
        seq=first + rows.astype(np.float64),
        rate_dps=_rate(scene, device, session, acts, path)[rows],
        encoder_deg=_encoder(scene, device, acts)[rows],
        temp_c=np.round(scene.temp_c, 2)[rows],
    )


def _rate(scene: Scene, device: Device, session: int, acts: _Acts, path: Path) -> Floats:
    """As read out, deg/s: whole counts."""
    felt_dps = acts.through(Place.SEEN, scene.fine_dps, scene)
    seen_dps = acts.through(Place.PASSED, felt_dps, scene)[:: scene.fine]
    seen = replace(scene, rate_dps=seen_dps)
    rate_dps = acts.through(Place.GAIN, seen_dps, seen) + _noise(scene, device, acts, path) + device.bias_dps[session]
    counts = np.rint(acts.through(Place.OUTPUT, rate_dps, seen) / device.dps_per_lsb)
    return acts.through(Place.READ, np.clip(counts, -MOST_COUNTS, MOST_COUNTS), seen) * device.dps_per_lsb


def _noise(scene: Scene, device: Device, acts: _Acts, path: Path) -> Floats:
    """White at the samples; behind a filter, what that leaves of noise that was white before it."""
    dice = noise_dice((*path, "noise"))
    if not acts.at(Place.PASSED):
        return dice.normal(0.0, device.noise_dps_rthz * sqrt(scene.sample_hz), len(scene.t_s))
    fine = dice.normal(0.0, device.noise_dps_rthz * sqrt(scene.fine_hz), len(scene.fine_dps))
    return acts.through(Place.PASSED, fine, scene)[:: scene.fine]


def _encoder(scene: Scene, device: Device, acts: _Acts) -> Floats:
    """As counted, degrees."""
    shaft_deg = acts.through(Place.ANGLE, scene.fine_deg, scene)[:: scene.fine]
    count_deg = 360.0 / device.encoder_cpr
    counts = np.rint(acts.through(Place.COUNTED, shaft_deg, scene) / count_deg)
    zeroed = counts if device.encoder_absolute else counts - counts[0]
    return zeroed * count_deg + 0.0  # no minus zero


def _times(scene: Scene, device: Device, acts: _Acts, path: Path) -> tuple[Floats, Floats, int]:
    """Device stamps and arrivals in whole microseconds, s, and the counter of the first sample."""
    dice = noise_dice((*path, "times"))
    count = len(scene.t_s)
    healthy_s = scene.powered_s * (1.0 + device.clock_ppm * 1e-6) + dice.normal(0.0, device.stamp_scatter_s, count)
    stamp_s = acts.through(Place.STAMP, np.maximum(healthy_s, 0.0), scene)
    delay_s = device.host_delay_s + dice.gamma(1.0, device.host_scatter_s, count)
    arrival_s = np.maximum.accumulate(acts.through(Place.ARRIVAL, scene.t_s + delay_s, scene))
    epoch_s = EPOCH_S + int(dice.integers(EPOCHS_S))
    first = int(scene.powered_s[0] * scene.sample_hz)
    return np.rint(stamp_s * MICRO) / MICRO, epoch_s + np.rint((arrival_s + 1.0) * MICRO) / MICRO, first
