"""Temperature: bias and gain that go with what the device says its temperature is, and the hour after power-on."""

import numpy as np
import pytest
from effects_bench import REST, Record, effect_of, fitted, means, profile_of, put_in, record, rig_of, sized

from firmware_sim.effects.effect import Effect
from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import parse_effect

TAUS_S = np.geomspace(30.0, 480.0, 400)


def identified(effect: Effect | None) -> Record:
    return record(rig_of(effect), load_profile("identify"), 594.0)


@sized("temp_bias")
def test_the_bias_goes_with_the_temperature(effect: Effect | None) -> None:
    run = identified(effect)
    bias_dps, slope, _ = fitted(run.error_dps, 1.0, run.temp_c - 25.0, run.true_dps)
    assert slope == pytest.approx(put_in(effect, "slope_dps_per_c"), abs=2e-4)
    assert bias_dps == pytest.approx(0.35, abs=0.002)


def test_the_bias_may_bend_with_the_temperature() -> None:
    run = identified(parse_effect("temp_bias:slope_dps_per_c=0.03,curve_per_c=0.01"))
    over_c = run.temp_c - 25.0
    _, slope, bend = fitted(run.error_dps, 1.0, over_c, over_c**2)
    assert slope == pytest.approx(0.03, abs=1e-3)
    assert bend == pytest.approx(3e-4, abs=5e-5)


@sized("temp_scale")
def test_the_gain_goes_with_the_temperature(effect: Effect | None) -> None:
    run = identified(effect)
    _, gain, slope = fitted(run.error_dps, 1.0, run.true_dps, run.true_dps * (run.temp_c - 25.0))
    assert 100.0 * slope == pytest.approx(put_in(effect, "slope_percent_per_c"), abs=5e-4)
    assert 100.0 * gain == pytest.approx(0.0, abs=0.002)


def decay(run: Record) -> tuple[float, float]:
    """Amplitude in deg/s and time constant in s of the best a·exp(−t/τ) beside a constant, over means of a second."""
    t_s, rate_dps = means(run.t_s, 100), means(run.rate_dps, 100)
    best = (float("inf"), 0.0, 0.0)
    for tau_s in TAUS_S:
        curve = np.exp(-t_s / tau_s)
        offset, amplitude = fitted(rate_dps, 1.0, curve)
        remaining = float(np.sum((rate_dps - offset - amplitude * curve) ** 2))
        best = min(best, (remaining, float(amplitude), float(tau_s)))
    return best[1], best[2]


@sized("warmup")
def test_the_bias_decays_after_power_on(effect: Effect | None) -> None:
    """Amplitude to 4 mdps, time constant to 15 %, in ten minutes at rest from a cold start."""
    amplitude_dps, tau_s = decay(record(rig_of(effect), profile_of(*REST), 600.0))
    assert amplitude_dps == pytest.approx(put_in(effect, "amplitude_dps"), abs=0.004)
    if effect is not None:
        assert tau_s == pytest.approx(put_in(effect, "time_constant_s"), rel=0.15)


def test_a_device_that_is_on_for_long_has_less_left_to_decay() -> None:
    amplitude_dps, tau_s = decay(record(rig_of(effect_of("warmup")), profile_of(*REST, powered_s=240.0), 600.0))
    assert amplitude_dps == pytest.approx(0.3 * np.exp(-2.0), abs=0.004)
    assert tau_s == pytest.approx(120.0, rel=0.15)


def test_a_warm_up_may_have_two_stages() -> None:
    """A share of it decays sooner; together they are the amplitude."""
    effect = parse_effect("warmup:amplitude_dps=0.4,time_constant_s=200,fast_share=0.25,fast_time_constant_s=30")
    run = record(rig_of(effect), profile_of(*REST), 600.0)
    _, fast, slow = fitted(run.rate_dps, 1.0, np.exp(-run.t_s / 30.0), np.exp(-run.t_s / 200.0))
    assert fast == pytest.approx(0.1, abs=0.01)
    assert slow == pytest.approx(0.3, abs=0.01)
