"""Flaws of a gyro, its clock and its encoder, put into arrays of a perfect simulation with numpy.

Written for simulations of other programs: nothing of gyrodrift or its simulator is imported. Equations are those of
textbooks, and partly of another form (tanh, two filters in a row). A flaw takes signals and returns signals.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Rng = np.random.Generator


@dataclass(frozen=True, slots=True)
class Signals:
    """A simulated session: true sampling times, device stamps and arrivals, s; rate, deg/s; angles, deg; shape (n,).

    true_dps
        Rate without any flaw.
    arrival_s
        None for a simulation that has no host.
    temp_c
        Temperature of the die, °C; None for a simulation without one.
    """

    t_s: Floats
    stamp_s: Floats
    arrival_s: Floats | None
    true_dps: Floats
    rate_dps: Floats
    angle_deg: Floats
    temp_c: Floats | None = None


Flaw = Callable[[Signals, Rng], Signals]


def on_rate(change: Callable[[Signals, Rng], Floats]) -> Flaw:
    """Flaw that gives the session another rate, deg/s."""
    return lambda signals, rng: replace(signals, rate_dps=change(signals, rng))


def gain(percent: float) -> Flaw:
    """Sensitivity off by a share."""
    return on_rate(lambda s, _: s.rate_dps * (1.0 + percent / 100.0))


def direction_gain(percent: float) -> Flaw:
    """Sensitivity larger in one direction and smaller in the other."""
    return on_rate(lambda s, _: s.rate_dps * (1.0 + percent / 100.0 * np.sign(s.rate_dps)))


def compression(share: float) -> Flaw:
    """Soft saturation, as of a capacitive drive: tanh with slope 1 at rest; about `share` is lost at 250 deg/s."""
    scale = 250.0 / np.sqrt(3.0 * share)
    return on_rate(lambda s, _: scale * np.tanh(s.rate_dps / scale))


def square(dps_at_100: float) -> Flaw:
    """Rectified vibration of the drive: a bias with the square of the rate."""
    return on_rate(lambda s, _: s.rate_dps + dps_at_100 * np.square(s.true_dps / 100.0))


def tilt_bias(dps: float) -> Flaw:
    """Gravity on a leaning plate: a bias once per turn."""
    return on_rate(lambda s, rng: s.rate_dps + dps * np.cos(np.radians(s.angle_deg) + rng.uniform(0.0, 6.0)))


def suppression(width_dps: float) -> Flaw:
    """Zero-rate suppression."""
    return on_rate(lambda s, _: s.rate_dps * (np.abs(s.rate_dps) >= width_dps))


def steps(step_dps: float) -> Flaw:
    """Coarse output words."""
    return on_rate(lambda s, _: step_dps * np.floor(s.rate_dps / step_dps + 0.5))


def limit(dps: float) -> Flaw:
    """Range of the sensor."""
    return on_rate(lambda s, _: np.maximum(-dps, np.minimum(dps, s.rate_dps)))


def late(seconds: float) -> Flaw:
    """Transport delay of the rate."""
    return on_rate(lambda s, _: np.interp(s.t_s - seconds, s.t_s, s.rate_dps))


def one_pole(cutoff_hz: float) -> Flaw:
    """RC filter, integrated with a twentieth of the sample period."""
    return on_rate(lambda s, _: _rc(s.t_s, s.rate_dps, cutoff_hz))


def _rc(t_s: Floats, values: Floats, cutoff_hz: float) -> Floats:
    substeps, state, out = 20, float(values[0]), np.empty_like(values)
    gain_of_step = 1.0 - np.exp(-2.0 * np.pi * cutoff_hz * (t_s[1] - t_s[0]) / substeps)
    before = float(values[0])
    for index, value in enumerate(values.tolist()):
        for part in range(1, substeps + 1):
            state += gain_of_step * (before + (value - before) * part / substeps - state)
        out[index], before = state, value
    return out


def bias_walk(dps_rts: float) -> Flaw:
    """Bias of independent increments at each sample."""

    def walked(s: Signals, rng: Rng) -> Floats:
        track: Floats = np.cumsum(dps_rts * np.sqrt(np.gradient(s.t_s)) * rng.standard_normal(len(s.t_s)))
        return s.rate_dps + track

    return on_rate(walked)


def flicker(dph: float) -> Flaw:
    """1/f noise of two-sided density B²/(2πf), by shaping a white spectrum."""

    def with_flicker(s: Signals, rng: Rng) -> Floats:
        count, step_s = len(s.t_s), float(s.t_s[1] - s.t_s[0])
        f_hz = np.fft.rfftfreq(2 * count, step_s)
        f_hz[0] = f_hz[1]
        shape = dph / 3600.0 / np.sqrt(2.0 * np.pi * f_hz * step_s)
        track = np.fft.irfft(shape * np.fft.rfft(rng.standard_normal(2 * count)), 2 * count)[:count]
        added: Floats = s.rate_dps + track - track[0]
        return added

    return on_rate(with_flicker)


def two_levels(dps: float, mean_s: float) -> Flaw:
    """Bias that switches between two levels with a constant hazard."""

    def switched(s: Signals, rng: Rng) -> Floats:
        jumps = rng.random(len(s.t_s)) < (s.t_s[1] - s.t_s[0]) / mean_s
        return s.rate_dps + dps * (np.cumsum(jumps) % 2)

    return on_rate(switched)


def warm_up(dps: float, tau_s: float) -> Flaw:
    """Bias that settles after power-on: a die and a package, 40 % and 60 %."""
    return on_rate(lambda s, _: s.rate_dps + dps * (0.4 * np.exp(-4.0 * s.t_s / tau_s) + 0.6 * np.exp(-s.t_s / tau_s)))


def hum(dps: float, hz: float) -> Flaw:
    """Tone of a motor."""
    return on_rate(lambda s, rng: s.rate_dps + dps * np.cos(2.0 * np.pi * hz * s.t_s + rng.uniform(0.0, 6.3)))


def glitches(dps: float, percent: float) -> Flaw:
    """Damaged words: single samples far off."""

    def hit(s: Signals, rng: Rng) -> Floats:
        hits = rng.random(len(s.t_s)) < percent / 100.0
        changed: Floats = s.rate_dps + hits * rng.choice([-dps, dps], len(s.t_s))
        return changed

    return on_rate(hit)


def repeats(percent: float) -> Flaw:
    """Readings that the sensor has not refreshed."""

    def repeated(s: Signals, rng: Rng) -> Floats:
        out, old = s.rate_dps.copy(), rng.random(len(s.t_s)) < percent / 100.0
        for index in np.flatnonzero(old[1:]) + 1:
            out[index] = out[index - 1]
        return out

    return on_rate(repeated)


def off_center(deg: float) -> Flaw:
    """Code wheel off its center."""
    return lambda s, rng: replace(
        s, angle_deg=s.angle_deg + deg * np.sin(np.radians(s.angle_deg) + rng.uniform(0.0, 6.0))
    )


def gear_play(deg: float) -> Flaw:
    """Encoder behind a gear with play."""

    def behind(s: Signals, _: Rng) -> Signals:
        out, behind_deg = np.empty_like(s.angle_deg), float(s.angle_deg[0])
        for index, angle in enumerate(s.angle_deg.tolist()):
            behind_deg = min(max(behind_deg, angle - deg / 2.0), angle + deg / 2.0)
            out[index] = behind_deg
        return replace(s, angle_deg=out)

    return behind


def slips(deg: float, mean_s: float) -> Flaw:
    """Coupling that slips now and then."""

    def slipped(s: Signals, rng: Rng) -> Signals:
        jumps = rng.random(len(s.t_s)) < (s.t_s[1] - s.t_s[0]) / mean_s
        return replace(s, angle_deg=s.angle_deg + np.cumsum(jumps * rng.choice([-deg, deg], len(jumps))))

    return slipped


def coarse_encoder(counts: int) -> Flaw:
    """Counts per turn."""
    return lambda s, _: replace(s, angle_deg=360.0 / counts * np.floor(s.angle_deg * counts / 360.0))


def fast_clock(ppm: float) -> Flaw:
    """Oscillator of the device beside that of the host."""
    return lambda s, _: replace(s, stamp_s=s.stamp_s * (1.0 + 1e-6 * ppm))


def shaky_stamps(ms: float) -> Flaw:
    """Stamps of a busy loop."""
    return lambda s, rng: replace(s, stamp_s=np.sort(s.stamp_s + 1e-3 * ms * rng.standard_normal(len(s.stamp_s))))


def polled(ms: float) -> Flaw:
    """Bus that is asked at an interval."""

    def delayed(s: Signals, rng: Rng) -> Signals:
        if s.arrival_s is None:
            return s
        offset_s = rng.uniform(0.0, ms * 1e-3)
        return replace(s, arrival_s=offset_s + 1e-3 * ms * np.ceil((s.arrival_s - offset_s) / (1e-3 * ms)))

    return delayed
