"""Measurement channels of a device: a rate or an acceleration, from the sensed motion to the value that is read.

A channel passes values through the acts of the effects of a session, slot by slot. The yaw rate is a channel; a device
with three axes has six.
"""

from zlib import crc32

import numpy as np

from firmware_sim.effects.catalogue import in_acting_order
from firmware_sim.effects.effect import Act, EffectSlot, Floats, Moments, Rng
from firmware_sim.rig import Rig

Acts = dict[EffectSlot, list[Act]]


def random_stream(seed: int, *branch: int) -> Rng:
    """Independent random generator for a purpose."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=branch))


def begin_acts(rig: Rig, seed: int, session: int, branch: tuple[int, ...] = ()) -> Acts:
    """Acts of all effects of a session by slot; a branch gives other realizations.

    A sample that the device reads twice is one for all channels: HOLD has the same realization in each branch.
    """
    acts: Acts = {slot: [] for slot in EffectSlot}
    twins: dict[str, int] = {}
    for effect in in_acting_order(rig.effects):
        twins[effect.name] = twins.get(effect.name, 0) + 1
        own = () if effect.slot is EffectSlot.HOLD else branch
        stream = random_stream(seed, session, crc32(effect.name.encode()), twins[effect.name], *own)
        acts[effect.slot].append(effect.begin(stream, rig.base.sample_rate_hz))
    return acts


def through(acts: list[Act], values: Floats, moments: Moments) -> Floats:
    """Values after all acts of a slot."""
    for act in acts:
        values = act(values, moments)
    return values


class Channel:
    """Acts of one channel, with its noise and its constant offset.

    noise_rthz
        White noise, in the unit of the values per √Hz.
    fine
        Steps of the fine grid per sample.
    """

    def __init__(self, acts: Acts, rng: Rng, noise_rthz: float, bias: float, rate_hz: float, fine: int) -> None:
        self._acts, self._rng, self._bias, self._fine = acts, rng, bias, fine
        self._sigma = noise_rthz * np.sqrt(rate_hz * fine)

    def continuous(self, values: Floats, moments: Moments) -> Floats:
        """Values with noise and all effects in continuous time, at the samples of the fine grid."""
        analog = through(self._acts[EffectSlot.ANALOG], values, moments)
        noisy = analog + self._sigma * self._rng.standard_normal(values.shape)
        return through(self._acts[EffectSlot.LOW_PASS], noisy, moments)[self._fine - 1 :: self._fine]

    def sampled(self, values: Floats, moments: Moments) -> Floats:
        """Values as the device reads them, from those at the samples."""
        biased = through(self._acts[EffectSlot.RATE], values, moments) + self._bias
        return through(self._acts[EffectSlot.HOLD], through(self._acts[EffectSlot.OUTPUT], biased, moments), moments)
