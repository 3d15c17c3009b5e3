"""Flaws of other forms than those of simulators/flaws.py, whose types they have; of numpy and scipy alone."""

from dataclasses import replace

import numpy as np
from scipy.signal import bessel, cont2discrete, lfilter, lfilter_zi

from simulators.flaws import Flaw, Floats, Rng, Signals, on_rate


def sine_response(share: float, at_dps: float = 250.0) -> Flaw:
    """Response of an interferometer, a sine with slope 1 at rest, that loses `share` at a rate."""
    phase = np.sqrt(6.0 * share)  # of the cubic term, before Newton's method solves sin(x) / x = 1 - share
    for _ in range(50):
        slope = (phase * np.cos(phase) - np.sin(phase)) / phase**2
        phase -= (np.sin(phase) / phase - 1.0 + share) / slope
    return on_rate(lambda s, _: np.sin(s.rate_dps * phase / at_dps) * at_dps / phase)


def gravity(dps: float, phase_deg: float, second: float) -> Flaw:
    """Gravity on a leaning plate: a bias once per turn, and a share `second` of it twice, from a term in g²."""

    def biased(s: Signals, _: Rng) -> Floats:
        phase = np.radians(s.angle_deg - phase_deg)
        added: Floats = s.rate_dps + dps * (np.cos(phase) + second * np.cos(2 * phase))
        return added

    return on_rate(biased)


def dead_band(low_dps: float, high_dps: float) -> Flaw:
    """Zero below `low_dps`, and then until `high_dps` is reached."""

    def zeroed(s: Signals, _: Rng) -> Floats:
        out, is_dead = s.rate_dps.copy(), True
        for index, size_dps in enumerate(np.abs(out).tolist()):
            is_dead = size_dps < (high_dps if is_dead else low_dps)
            if is_dead:
                out[index] = 0.0
        return out

    return on_rate(zeroed)


def rounded(step_dps: float) -> Flaw:
    """Output words: the nearest multiple of a step, and the even one of two."""
    return on_rate(lambda s, _: np.rint(s.rate_dps / step_dps) * step_dps)


def _filtered(s: Signals, numerator: list[float], denominator: list[float]) -> Floats:
    """Rate behind an analog filter: exact where the rate is linear between samples."""
    (b,), a, _ = cont2discrete((numerator, denominator), s.t_s[1] - s.t_s[0], method="foh")
    filtered: Floats = lfilter(b, a, s.rate_dps, zi=lfilter_zi(b, a) * s.rate_dps[0])[0]
    return filtered


def one_pole(cutoff_hz: float) -> Flaw:
    """Filter of first order."""
    omega = 2 * np.pi * cutoff_hz
    return on_rate(lambda s, _: _filtered(s, [omega], [1.0, omega]))


def bessel_filter(cutoff_hz: float) -> Flaw:
    """Bessel filter of second order; 3 dB are lost at its cutoff."""
    numerator, denominator = bessel(2, 2 * np.pi * cutoff_hz, analog=True, norm="mag")
    return on_rate(lambda s, _: _filtered(s, numerator, denominator))


def all_pass(delay_s: float) -> Flaw:
    """Padé's approximation of second order for a delay."""
    square, half = delay_s * delay_s / 12, delay_s / 2
    return on_rate(lambda s, _: _filtered(s, [square, -half, 1.0], [square, half, 1.0]))


def _from_25_c(s: Signals) -> Floats:
    if s.temp_c is None:
        raise ValueError("a flaw of the temperature needs a session with temperatures")
    return s.temp_c - 25


def temperature_bias(dps_per_c: float, growth_c: float = 60.0) -> Flaw:
    """Bias that is zero at 25 °C, where it has its slope, and grows by e in `growth_c`."""
    return on_rate(lambda s, _: s.rate_dps + dps_per_c * growth_c * np.expm1(_from_25_c(s) / growth_c))


def temperature_gain(percent_per_c: float) -> Flaw:
    """Sensitivity whose reciprocal is linear in the temperature."""
    return on_rate(lambda s, _: s.rate_dps / (1.0 - percent_per_c / 100 * _from_25_c(s)))


def exponential_warm_up(dps: float, tau_s: float) -> Flaw:
    """Bias that settles after power-on, which is 0 on the clock of the device."""
    return on_rate(lambda s, _: s.rate_dps + dps * np.exp(-s.stamp_s / tau_s))


def voss(dph: float) -> Flaw:
    """1/f noise of Voss and McCartney: row j of 18 is drawn again every 2^(j+1) samples, and the rows are summed.

    Its one-sided density is B²/(π f) (Gardner, Scientific American, April 1978; the row of white noise is left out).
    """

    def with_flicker(s: Signals, rng: Rng) -> Floats:
        sigma_dps = dph / 3600 * np.sqrt(np.log(2) / np.pi)  # rows sum to sigma² / (f ln 2)
        counter = int(rng.integers(1 << 19)) + np.arange(len(s.t_s))
        total = np.zeros(len(s.t_s))
        for j in range(18):
            row = (counter - (1 << j)) >> (j + 1)  # trailing zeros of the counter choose the row
            total += sigma_dps * rng.standard_normal(row[-1] - row[0] + 1)[row - row[0]]
        return s.rate_dps + total

    return on_rate(with_flicker)


def wiener(dps_rts: float) -> Flaw:
    """Bias of independent increments, from 0."""

    def walked(s: Signals, rng: Rng) -> Floats:
        steps = dps_rts * np.sqrt(s.t_s[1] - s.t_s[0]) * rng.standard_normal(len(s.t_s))
        steps[0] = 0.0
        added: Floats = s.rate_dps + np.cumsum(steps)
        return added

    return on_rate(walked)


def telegraph(dps: float, low_s: float, high_s: float) -> Flaw:
    """Bias of two levels about zero: a Markov chain with a mean time, s, on either of them."""

    def switched(s: Signals, rng: Rng) -> Floats:
        step_s = s.t_s[1] - s.t_s[0]
        draws, level, levels = rng.random(len(s.t_s)).tolist(), int(rng.integers(2)), []
        for draw in draws:
            if draw < -np.expm1(-step_s / (high_s if level else low_s)):
                level = 1 - level
            levels.append(level - 0.5)
        return s.rate_dps + dps * np.array(levels)

    return on_rate(switched)


def swelling_tone(dps: float, hz: float) -> Flaw:
    """Tone of a motor, whose strength swells by a fifth."""

    def with_tone(s: Signals, rng: Rng) -> Floats:
        phase, swell_phase, swell_hz = rng.uniform(0, 6.28), rng.uniform(0, 6.28), rng.uniform(0.05, 0.12)
        strength_dps = dps * (1 + 0.2 * np.sin(2 * np.pi * swell_hz * s.t_s + swell_phase))
        added: Floats = s.rate_dps + strength_dps * np.sin(2 * np.pi * hz * s.t_s + phase)
        return added

    return on_rate(with_tone)


def impulses(dps: float, percent: float) -> Flaw:
    """Contaminated normal: some samples have a normal error with this standard deviation."""

    def hit(s: Signals, rng: Rng) -> Floats:
        hits = rng.random(len(s.t_s)) < percent / 100
        changed: Floats = s.rate_dps + hits * dps * rng.standard_normal(len(hits))
        return changed

    return on_rate(hit)


def eccentric(deg: float, phase_deg: float, second: float) -> Flaw:
    """Code wheel off its center, and a share `second` of the error twice per turn."""

    def with_error(s: Signals, _: Rng) -> Signals:
        phase = np.radians(s.angle_deg - phase_deg)
        return replace(s, angle_deg=s.angle_deg + deg * (np.sin(phase) + second * np.sin(2 * phase + 1.0)))

    return with_error


def skipped_teeth(deg: float, mean_s: float) -> Flaw:
    """Belt that skips a tooth against the motion, every `mean_s` of it; the likelier the faster it turns."""

    def skipped(s: Signals, rng: Rng) -> Signals:
        speeds_dps = np.abs(s.true_dps) * (np.abs(s.true_dps) > 5.0)
        hazards_hz = speeds_dps / speeds_dps[speeds_dps > 0].mean() / mean_s
        hits = rng.random(len(s.t_s)) < hazards_hz * (s.t_s[1] - s.t_s[0])
        return replace(s, angle_deg=s.angle_deg - np.cumsum(hits * deg * np.sign(s.true_dps)))

    return skipped
