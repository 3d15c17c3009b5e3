"""Dynamics of the sensor in continuous time: low-pass, delay, vibration."""

from math import pi, sqrt
from typing import Annotated, ClassVar, Generic, Literal

import numpy as np
from pydantic import Field

from firmware_sim.effects.effect import Act, Effect, EffectSlot, Floats, Moments, Rng
from firmware_sim.effects.recursion import Number, OnePole

STEPS_PER_TIME_CONSTANT = 10.0
STEPS_PER_PERIOD = 25.0
"""Steps of the fine grid per time constant of a low-pass, and per period of a tone.

Linear interpolation weakens the tone by half a percent.
"""


class Latency(Effect):
    """The gyro senses the motion with a fixed delay. Typical: 1 to 20 ms (internal filters, bus, firmware)."""

    name: Literal["latency"] = "latency"
    delay_ms: Annotated[float, Field(ge=0.0, le=1000.0)]
    stage: ClassVar[str] = "sensor"
    slot: ClassVar[EffectSlot] = EffectSlot.LAG
    typical: ClassVar[dict[str, float]] = {"delay_ms": 20.0}
    small: ClassVar[dict[str, float]] = {"delay_ms": 3.0}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Earlier times; the motion between samples is known in closed form."""
        return lambda t_s, _: t_s - self.delay_ms * 1e-3


class Vibration(Effect):
    """A tone A·sin(2πft + φ) in the rate, φ random. Typical: 0.01 to 1 deg/s at 10 to 300 Hz (motors, fans).

    It acts before sampling, so it aliases above half the sample rate.
    """

    name: Literal["vibration"] = "vibration"
    amplitude_dps: Annotated[float, Field(ge=0.0, le=500.0)]
    frequency_hz: Annotated[float, Field(gt=0.0, le=5000.0)]
    stage: ClassVar[str] = "sensor"
    slot: ClassVar[EffectSlot] = EffectSlot.ANALOG
    typical: ClassVar[dict[str, float]] = {"amplitude_dps": 0.5, "frequency_hz": 73.0}
    small: ClassVar[dict[str, float]] = {"amplitude_dps": 0.05, "frequency_hz": 23.0}

    def finest_step_s(self) -> float:
        """Fraction of a period, for a low-pass after it; without one, a tone needs no fine grid."""
        return 1.0 / self.frequency_hz / STEPS_PER_PERIOD

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Tone."""
        phase = rng.uniform(0.0, 2.0 * pi)
        return lambda rate, m: rate + self.amplitude_dps * np.sin(2.0 * pi * self.frequency_hz * m.t_s + phase)


class Bandwidth(Effect):
    """Low-pass of motion, vibration and noise: of the first order (RC), or of the second (Butterworth).

    H = 1 / (1 + jf/f_c), or 1 / (1 + j√2·f/f_c − (f/f_c)²). Typical f_c: 5 to 256 Hz.

    The output is the real part of z, where dz/dt = s·(z − g·x): one pole is s = −ω with g = 1, and two are
    s = ω·exp(3jπ/4) with g = 1 − j and the conjugates of both. It is exact for input that is linear on the fine
    grid (first-order hold):

    z[n] = p·z[n−1] + a·x[n] + b·x[n−1];
    p = exp(s·h), c = (p − 1)/(s·h);
    a = g·(1 − c), b = g·(c − p).
    """

    name: Literal["bandwidth"] = "bandwidth"
    cutoff_hz: Annotated[float, Field(ge=0.05, le=2000.0)]
    order: Annotated[int, Field(ge=1, le=2)] = 1
    stage: ClassVar[str] = "sensor"
    slot: ClassVar[EffectSlot] = EffectSlot.LOW_PASS
    typical: ClassVar[dict[str, float]] = {"cutoff_hz": 10.0, "order": 1}
    small: ClassVar[dict[str, float]] = {"cutoff_hz": 40.0, "order": 1}

    def finest_step_s(self) -> float:
        """A tenth of the time constant."""
        return 1.0 / (2.0 * pi * self.cutoff_hz) / STEPS_PER_TIME_CONSTANT

    def delay_s(self) -> float:
        """Delay of slow changes, s."""
        return sqrt(self.order) / (2.0 * pi * self.cutoff_hz)

    def power_passed(self, frequency_hz: Floats) -> Floats:
        """Transmitted share of the power at frequencies, in their shape."""
        passed_power: Floats = 1.0 / (1.0 + np.power(frequency_hz / self.cutoff_hz, 2 * self.order))
        return passed_power

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Recursion over the fine grid, in steady state at the first value."""
        omega = 2.0 * pi * self.cutoff_hz
        if self.order == 1:
            return _LowPass(np.float64(-omega), np.float64(1.0))
        return _LowPass(np.complex128(omega * np.exp(0.75j * pi)), np.complex128(1.0 - 1.0j))


class _LowPass(Generic[Number]):
    def __init__(self, pole: Number, gain: Number) -> None:
        self._pole: Number = pole
        self._gain: Number = gain
        self._recursion: OnePole[Number] | None = None
        self._x_before = 0.0
        self._a: Number = gain
        self._b: Number = gain

    def __call__(self, rate: Floats, moments: Moments) -> Floats:
        if self._recursion is None:
            along = self._pole * moments.step_s
            kept = np.exp(along)
            c = (kept - 1.0) / along
            self._a, self._b = self._gain * (1.0 - c), self._gain * (c - kept)
            self._x_before = float(moments.rate_dps[0])  # steady state of the motion without noise
            self._recursion = OnePole(kept, self._gain * self._x_before)
        before = np.concatenate([[self._x_before], rate[:-1]])
        self._x_before = float(rate[-1])
        passed: Floats = np.real(self._recursion(self._a * rate + self._b * before))
        return passed
