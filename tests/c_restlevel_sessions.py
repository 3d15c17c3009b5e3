"""Sessions of simulated sensors for restlevel in C and in Python: slow and fast, damaged, with a rest sensor."""

from collections.abc import Callable, Mapping
from math import nan

import numpy as np
from c_restlevel_support import GAP, RESTARTED, drive, measured, samples

from gyrodrift.simulation.hard_cases import CASES, simulation
from gyrodrift.values.arrays import Floats

Session = tuple[Floats, Floats]
"""Times and inputs."""


def timed(rate_hz: float, seconds: float) -> Floats:
    return np.arange(round(rate_hz * seconds)) / rate_hz


def plain(rate_hz: float, seconds: float, turn_dps: float = 60.0, step_dps: float = 1.0 / 131.0) -> Session:
    """Rests and turns."""
    rng, t_s = np.random.default_rng(round(rate_hz)), timed(rate_hz, seconds)
    return t_s, samples(measured(rng, drive(rng, t_s, turn_dps)[0], step_dps=step_dps))


def with_temperature_and_rest_sensor() -> Session:
    """A warm-up, and wheels that report rest, sometimes late or wrong or not at all."""
    rng, t_s = np.random.default_rng(4), timed(50.0, 600.0)
    rate_dps, is_rest = drive(rng, t_s)
    temp_c = 25.0 + 15.0 * (1.0 - np.exp(-t_s / 200.0)) + rng.normal(0.0, 0.1, len(t_s))
    still = np.roll(is_rest, 3).astype(float)
    still[(t_s > 200.0) & (t_s < 300.0)] = nan
    still[(t_s > 400.0) & (t_s < 440.0)] = 1.0
    return t_s, samples(measured(rng, rate_dps + 0.02 * (temp_c - 25.0)), still, temp_c)


def with_gaps() -> Session:
    """Lost samples, a pause of minutes, and steps of any length."""
    t_s, inputs = plain(100.0, 300.0)
    rng = np.random.default_rng(5)
    t_s = t_s + rng.uniform(0.0, 0.008, len(t_s))
    t_s[len(t_s) // 2 :] += 300.0
    kept = rng.random(len(t_s)) > 0.1
    return t_s[kept], inputs[kept]


def with_restarts() -> Session:
    """Gaps and restarts that are told, with clocks that go on and that begin again, and biases that change."""
    t_s, inputs = plain(100.0, 300.0)
    for index, row in enumerate(range(3000, len(t_s), 4000)):
        inputs[row, 3] = RESTARTED if index % 2 else GAP
        inputs[row + 1 :, 0] += 0.3 * index * (index % 2)
    t_s[15001:] -= t_s[15001]
    return t_s, inputs


def clipped() -> Session:
    """A range of 250 deg/s, and turns beyond it."""
    t_s, inputs = plain(100.0, 300.0, turn_dps=900.0)
    return t_s, np.clip(inputs, -250.0, 250.0)


def stuck() -> Session:
    """A sensor that hangs now and then, at rest and in turns, and says zero before it begins to measure."""
    t_s, inputs = plain(100.0, 300.0)
    for begin in range(3000, len(t_s), 2500):
        inputs[begin : begin + 300, 0] = inputs[begin, 0]
    inputs[:500, 0] = 0.0
    return t_s, inputs


def huge() -> Session:
    """Rates up to the limit, among usual ones."""
    t_s, inputs = plain(100.0, 120.0)
    inputs[4000:4100, 0] = 1e12
    inputs[8000:8400, 0] = -3e7
    return t_s, inputs


def turning_on_and_on() -> Session:
    """Yaw of tens of thousands of degrees."""
    t_s, inputs = plain(50.0, 600.0, turn_dps=5.0)
    inputs[:, 0] += np.where((t_s > 30.0) & (t_s % 60.0 < 50.0), 250.0, 0.0)
    return t_s, inputs


def running_motor() -> Session:
    """Noise that drops in the middle, after rests that were louder than the sensor."""
    t_s, inputs = plain(100.0, 300.0, turn_dps=2.0)
    rng = np.random.default_rng(6)
    inputs[: len(t_s) // 2, 0] += rng.normal(0.0, 1.5, len(t_s) // 2)
    return t_s, inputs


def short_start() -> Session:
    """A slow sensor that sets out before its first rest is confirmed."""
    rng, t_s = np.random.default_rng(8), timed(5.0, 600.0)
    rate_dps = np.where(t_s > 4.6, drive(rng, t_s)[0] + 10.0 * np.sin(t_s), 0.0)
    return t_s, samples(measured(rng, rate_dps, step_dps=0.001))


def jumping_bias() -> Session:
    """A rest sensor, a first bias far out, and a bias that jumps within rests."""
    rng, t_s = np.random.default_rng(9), timed(100.0, 300.0)
    rate_dps, is_rest = drive(rng, t_s)
    rate_dps[t_s < 2.0], is_rest[t_s < 2.0] = 50.0, False
    jumps_dps = 0.2 * np.sign(np.sin(t_s / 7.0))
    return t_s, samples(measured(rng, rate_dps + jumps_dps, bias_dps=9.4), is_rest.astype(float))


def stuck_at_zero() -> Session:
    """A sensor without bias that says zero for a while, at rest and in turns."""
    rng, t_s = np.random.default_rng(10), timed(100.0, 300.0)
    inputs = samples(measured(rng, drive(rng, t_s)[0], bias_dps=0.0))
    for begin in range(3000, len(t_s), 1700):
        inputs[begin : begin + 300, 0] = 0.0
    return t_s, inputs


def slow_turns_taken_for_rest() -> Session:
    """A rest sensor that reports rest in slow turns."""
    rng, t_s = np.random.default_rng(11), timed(50.0, 600.0)
    rate_dps, is_rest = drive(rng, t_s, turn_dps=0.4)
    return t_s, samples(measured(rng, rate_dps), np.where(is_rest | (t_s % 100.0 > 30.0), 1.0, 0.0))


def slides() -> Session:
    """Rests that slide into a curve, whose end is gradual, by different slopes."""
    rng, t_s = np.random.default_rng(12), timed(50.0, 600.0)
    phase_s, number = t_s % 60.0, t_s // 60.0
    slide_dps = (-1.0) ** number * (0.002 + 0.001 * number) * np.clip(phase_s - 20.0, 0.0, 20.0)
    leave_dps = 0.2 * np.clip(phase_s - 40.0, 0.0, 15.0)
    return t_s, samples(measured(rng, np.where(phase_s < 55.0, slide_dps + leave_dps, 0.0)))


def slow_curves() -> Session:
    """Curves that begin as slowly as a bias drifts."""
    drives = next(case for case in CASES if case.name == "drive")
    session = simulation(drives, 45, 0, is_still=True).whole()
    return session.t_device_s, samples(session.rate_dps)


def zeroed() -> Session:
    """The yaw sigma restarts at rest and in motion."""
    t_s, inputs = plain(100.0, 200.0)
    inputs[::3333, 3] = 1.0
    return t_s, inputs


SESSIONS: Mapping[str, Callable[[], Session]] = {
    "5 Hz": lambda: plain(5.0, 2400.0),
    "50 Hz": lambda: plain(50.0, 900.0),
    "200 Hz": lambda: plain(200.0, 300.0),
    "1 kHz": lambda: plain(1000.0, 60.0),
    "coarse": lambda: plain(100.0, 300.0, step_dps=0.25),
    "slow turns": lambda: plain(100.0, 300.0, turn_dps=1.0),
    "fine": lambda: plain(100.0, 300.0, step_dps=0.0),
    "temperature and rest sensor": with_temperature_and_rest_sensor,
    "gaps": with_gaps,
    "restarts": with_restarts,
    "clipped": clipped,
    "stuck": stuck,
    "huge": huge,
    "turning on and on": turning_on_and_on,
    "running motor": running_motor,
    "short start": short_start,
    "stuck at zero": stuck_at_zero,
    "slow turns taken for rest": slow_turns_taken_for_rest,
    "slides": slides,
    "slow curves": slow_curves,
    "jumping bias": jumping_bias,
    "zeroed": zeroed,
}
