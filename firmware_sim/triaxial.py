"""Gyro of three axes with an accelerometer: rates and acceleration of a motion in space.

Rates and specific force pass the effects on vectors. Then each axis is a channel of its own. The channel of z has the
random numbers of a device with one axis: on a level table it reads the same.
"""

from collections.abc import Iterable
from dataclasses import replace
from typing import NamedTuple, Protocol, runtime_checkable
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from firmware_sim.channels import Channel, begin_acts, random_stream
from firmware_sim.effects.effect import Act, EffectSlot, Floats, Moments, Rng
from firmware_sim.effects.triaxial.catalogue import in_triaxial_order
from firmware_sim.effects.triaxial.effect import Sensed, TriaxialAct, TriaxialMoments, TriaxialSlot
from firmware_sim.motion.attitude.kinematics import Kinematics, level
from firmware_sim.rig import Rig, ThreeAxes

YAW_AXIS = 2
AXIS_BRANCHES = ((crc32(b"gyro_x"),), (crc32(b"gyro_y"),), ())
ACCELERATION_BRANCHES = tuple((crc32(name),) for name in (b"accel_x", b"accel_y", b"accel_z"))
"""Keys of the random streams of the axes; z of the gyro has those of a device with one axis."""

MOUNT = crc32(b"mount")
"""Key of the random stream of effects on all axes of the rig."""

CHIP_SLOTS = (EffectSlot.LOW_PASS, EffectSlot.HOLD)
"""Slots of a rate that the accelerometer shares: the chip filters and is read as a whole."""


@runtime_checkable
class SpatialMotion(Protocol):
    """Motion with an attitude."""

    def kinematics_at(self, t_s: Floats) -> Kinematics:
        """True motion of the sensor at times since the beginning."""
        ...


@runtime_checkable
class SpatialEffect(Protocol):
    """Effect of the rig that acts on all axes at once where the device has three."""

    def begin_triaxial(self, rng: Rng) -> TriaxialAct:
        """Act of this effect for a session."""
        ...


class _Timed(Protocol):
    def motion_at(self, t_s: Floats) -> tuple[Floats, Floats]:
        """True angle, degrees, and rate, deg/s."""
        ...


def kinematics_of(motion: _Timed, t_s: Floats) -> Kinematics:
    """True motion in space; a motion without an attitude turns about a vertical axis."""
    return motion.kinematics_at(t_s) if isinstance(motion, SpatialMotion) else level(*motion.motion_at(t_s))


def is_still(motion: _Timed, t_s: Floats, rate_dps: Floats) -> NDArray[np.bool_]:
    """Whether the device is at rest, shape (n,)."""
    return motion.kinematics_at(t_s).is_still() if isinstance(motion, SpatialMotion) else rate_dps == 0.0


class SixValues(NamedTuple):
    """Rates, deg/s, and accelerations, m/s², before rounding; shape (n, 3)."""

    rates_dps: Floats
    accel_mps2: Floats


class TriaxialSensor:
    """Channels and effects on vectors of a session, with their state."""

    def __init__(self, rig: Rig, axes: ThreeAxes, motion: _Timed, seed: int, session: int, fine: int) -> None:
        self._axes, self._motion, self._fine = axes, motion, fine
        spatial = [effect for effect in rig.effects if isinstance(effect, SpatialEffect)]
        rig = rig.model_copy(update={"effects": tuple(effect for effect in rig.effects if effect not in spatial)})
        rate_hz, noise = rig.base.sample_rate_hz, rig.base.noise_dps_rthz
        biases_dps = (axes.gyro_bias_x_dps, axes.gyro_bias_y_dps, rig.base.bias_dps)
        self._gyros = [
            Channel(
                begin_acts(rig, seed, session, branch),
                random_stream(seed, session, *branch),
                noise,
                bias_dps,
                rate_hz,
                fine,
            )
            for branch, bias_dps in zip(AXIS_BRANCHES, biases_dps, strict=True)
        ]
        self._accelerometers = [
            Channel(
                _of_chip(rig, seed, session, branch),
                random_stream(seed, session, *branch),
                axes.accel_noise_mps2_rthz,
                0.0,
                rate_hz,
                fine,
            )
            for branch in ACCELERATION_BRANCHES
        ]
        self._acts: dict[TriaxialSlot, list[TriaxialAct]] = {slot: [] for slot in TriaxialSlot}
        # The mount turns the motion before the chip adds its errors.
        self._acts[TriaxialSlot.MOTION] += [
            effect.begin_triaxial(random_stream(seed, session, MOUNT)) for effect in spatial
        ]
        twins: dict[str, int] = {}
        for effect in in_triaxial_order(axes.effects):
            twins[effect.name] = twins.get(effect.name, 0) + 1
            stream = random_stream(seed, session, crc32(effect.name.encode()), twins[effect.name])
            self._acts[effect.triaxial_slot].append(effect.begin_triaxial(stream))

    def values(self, pieces: Iterable[tuple[Moments, Floats]], truth: Moments) -> SixValues:
        """Values at the samples, from pieces of the fine grid and the times at which the sensor feels the motion."""
        parts = [self._piece(fine, seen_s) for fine, seen_s in pieces]
        rates, motion, force, felt = (np.concatenate(column) for column in zip(*parts, strict=True))
        read = [
            channel.sampled(rates[:, axis], replace(truth, rate_dps=motion[:, axis]))
            for axis, channel in enumerate(self._gyros)
        ]
        felt_read = [
            channel.sampled(force[:, axis], replace(truth, rate_dps=felt[:, axis]))
            for axis, channel in enumerate(self._accelerometers)
        ]
        moments = TriaxialMoments(truth.t_s, np.zeros(len(truth.t_s), np.bool_), truth.step_s)
        out = self._through(TriaxialSlot.OUTPUT, Sensed(np.stack(read, axis=1), np.stack(felt_read, axis=1)), moments)
        return SixValues(*out)

    def _piece(self, fine: Moments, seen_s: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Rates and force with noise, and the same without; at the samples of a piece."""
        motion = kinematics_of(self._motion, seen_s)
        moments = TriaxialMoments(fine.t_s, motion.is_still(), fine.step_s)
        true = Sensed(motion.rates_dps, motion.specific_force_mps2(self._axes.gravity_mps2))
        felt = self._through(TriaxialSlot.MOTION, true, moments)
        channels = ((self._gyros, felt.rates_dps), (self._accelerometers, felt.force_mps2))
        noisy = [
            np.stack(
                [
                    channel.continuous(values[:, axis], replace(fine, rate_dps=values[:, axis]))
                    for axis, channel in enumerate(group)
                ],
                axis=1,
            )
            for group, values in channels
        ]
        last = slice(self._fine - 1, None, self._fine)
        return noisy[0], felt.rates_dps[last], noisy[1], felt.force_mps2[last]

    def _through(self, slot: TriaxialSlot, sensed: Sensed, moments: TriaxialMoments) -> Sensed:
        for act in self._acts[slot]:
            sensed = act(sensed, moments)
        return sensed


def _of_chip(rig: Rig, seed: int, session: int, branch: tuple[int, ...]) -> dict[EffectSlot, list[Act]]:
    """Acts on an accelerometer: those of the low-pass and of the readout."""
    acts = begin_acts(rig, seed, session, branch)
    return {slot: acts[slot] if slot in CHIP_SLOTS else [] for slot in EffectSlot}
