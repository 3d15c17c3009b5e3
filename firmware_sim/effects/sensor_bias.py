"""Effects on the bias of the sensor: noise processes, rate and tilt."""

from collections.abc import Sequence
from math import log, pi, sqrt
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from firmware_sim.effects.effect import Act, Effect, EffectSlot, Floats, Rng
from firmware_sim.effects.recursion import SLOW_STEP_S, OnePole, Poisson, SlowTrack

FLICKER_RATIO = 3.0
FLICKER_TAUS_S = tuple(2.7 * FLICKER_RATIO**power for power in range(8))
"""Time constants, 2.7 s to 1.6 h, whose sum has a 1/f spectrum between them.

Faster ones, drawn for every sample, follow down to QUICKEST of a sample period; their aliases are almost white.
"""

QUICKEST = 0.25


class BiasInstability(Effect):
    """1/f noise of two-sided density B²/(2πf), as a sum of first-order Markov processes.

    Every process has the variance B²·ln(ratio of time constants)/π. The Allan deviation is flat at √(2·ln 2/π)·B =
    0.664·B (IEEE Std 952). Typical B: 4 to 40 deg/h.
    """

    name: Literal["bias_instability"] = "bias_instability"
    floor_dph: Annotated[float, Field(ge=0.0, le=10000.0)]
    stage: ClassVar[str] = "sensor"
    slot: ClassVar[EffectSlot] = EffectSlot.RATE
    typical: ClassVar[dict[str, float]] = {"floor_dph": 40.0}
    small: ClassVar[dict[str, float]] = {"floor_dph": 10.0}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Slow track plus faster processes."""
        sigma_dps = self.floor_dph / 3600.0 * sqrt(log(FLICKER_RATIO) / pi)
        slow = _processes(rng, sigma_dps, SLOW_STEP_S, FLICKER_TAUS_S)
        quick = _processes(rng, sigma_dps, 1.0 / sample_rate_hz, _quick_taus_s(sample_rate_hz))
        track = SlowTrack(lambda count: _sum(slow, count))
        return lambda rate, moments: rate + track.values_at(moments.t_s) + _sum(quick, len(rate))


class _Markov:
    """First-order Markov process with a standard deviation, and a step in time constants."""

    def __init__(self, rng: Rng, sigma_dps: float, step: float) -> None:
        pole = np.exp(-step)
        self._rng = rng
        self._scale = sigma_dps * sqrt(1.0 - pole**2)
        self._recursion = OnePole(pole, np.float64(sigma_dps * rng.standard_normal()))

    def draw(self, count: int) -> Floats:
        return self._recursion(self._scale * self._rng.standard_normal(count))


def _quick_taus_s(sample_rate_hz: float) -> list[float]:
    taus_s, tau_s = [], FLICKER_TAUS_S[0] / FLICKER_RATIO
    while tau_s * sample_rate_hz > QUICKEST:
        taus_s.append(tau_s)
        tau_s /= FLICKER_RATIO
    return taus_s


def _processes(rng: Rng, sigma_dps: float, step_s: float, taus_s: Sequence[float]) -> list[_Markov]:
    """Processes with separate generators, so that the block size does not matter."""
    generators = rng.spawn(len(taus_s))
    return [_Markov(generator, sigma_dps, step_s / tau_s) for generator, tau_s in zip(generators, taus_s, strict=True)]


def _sum(processes: Sequence[_Markov], count: int) -> Floats:
    summed = np.zeros(count)
    for process in processes:
        summed += process.draw(count)
    return summed


class RateRandomWalk(Effect):
    """The bias walks: db = K·dW. Allan deviation K·√(τ/3). Typical K: 0.001 to 0.01 deg/s/√s."""

    name: Literal["rate_random_walk"] = "rate_random_walk"
    density_dps_rts: Annotated[float, Field(ge=0.0, le=1.0)]
    stage: ClassVar[str] = "sensor"
    slot: ClassVar[EffectSlot] = EffectSlot.RATE
    typical: ClassVar[dict[str, float]] = {"density_dps_rts": 0.005}
    small: ClassVar[dict[str, float]] = {"density_dps_rts": 0.001}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Slow track."""
        walk = OnePole(np.float64(1.0), np.float64(0.0))
        step_dps = self.density_dps_rts * sqrt(SLOW_STEP_S)
        track = SlowTrack(lambda count: walk(step_dps * rng.standard_normal(count)))
        return lambda rate, moments: rate + track.values_at(moments.t_s)


class Popcorn(Effect):
    """The bias jumps between two levels after exponential dwell times. Typical step: 0.02 to 0.3 deg/s."""

    name: Literal["popcorn"] = "popcorn"
    step_dps: Annotated[float, Field(ge=0.0, le=20.0)]
    dwell_s: Annotated[float, Field(ge=0.01, le=1e5)] = 20.0
    stage: ClassVar[str] = "sensor"
    slot: ClassVar[EffectSlot] = EffectSlot.RATE
    typical: ClassVar[dict[str, float]] = {"step_dps": 0.2, "dwell_s": 20.0}
    small: ClassVar[dict[str, float]] = {"step_dps": 0.03, "dwell_s": 20.0}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Telegraph: the level is the parity of the jumps so far."""
        jumps = Poisson(rng, self.dwell_s)
        return lambda rate, moments: rate + self.step_dps * (jumps.count_until(moments.t_s) % 2.0 - 0.5)


class VibrationRectification(Effect):
    """Bias that grows with the square of the rate, stated at 100 deg/s. Typical: 0.02 to 0.3 deg/s there."""

    name: Literal["vibration_rectification"] = "vibration_rectification"
    bias_dps_at_100_dps: Annotated[float, Field(ge=-50.0, le=50.0)]
    stage: ClassVar[str] = "sensor"
    slot: ClassVar[EffectSlot] = EffectSlot.RATE
    typical: ClassVar[dict[str, float]] = {"bias_dps_at_100_dps": 0.2}
    small: ClassVar[dict[str, float]] = {"bias_dps_at_100_dps": 0.05}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Square."""
        return lambda rate, moments: rate + self.bias_dps_at_100_dps * (moments.rate_dps / 100.0) ** 2


class GSensitivity(Effect):
    """Bias A·sin(θ + φ), once per turn of a tilted table. Typical: 0.1 deg/s per g, times the sine of the tilt."""

    name: Literal["g_sensitivity"] = "g_sensitivity"
    amplitude_dps: Annotated[float, Field(ge=0.0, le=20.0)]
    phase_deg: Annotated[float, Field(ge=-360.0, le=360.0)] = 0.0
    stage: ClassVar[str] = "sensor"
    slot: ClassVar[EffectSlot] = EffectSlot.RATE
    typical: ClassVar[dict[str, float]] = {"amplitude_dps": 0.1, "phase_deg": 30.0}
    small: ClassVar[dict[str, float]] = {"amplitude_dps": 0.03, "phase_deg": 30.0}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Sine of the true angle."""
        return lambda rate, m: rate + self.amplitude_dps * np.sin(np.deg2rad(m.angle_deg + self.phase_deg))
