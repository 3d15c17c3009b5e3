"""The reference wrapper for other simulators, beside the simulator of the project."""

import ast
import json
from pathlib import Path

import numpy as np
import pytest

import gyrodrift.effects
from firmware_sim.channels import Channel, begin_acts, through
from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import EffectSlot, Floats, Moments
from firmware_sim.rig import Rig, parse_effect
from gyrodrift.effects import EFFECTS, SimulatedGyro, apply

RATE_HZ, COUNT = 100.0, 6_000
T_S = np.arange(COUNT) / RATE_HZ
TRUE_DPS = 120.0 * np.sin(2.0 * np.pi * 0.1 * T_S) * np.sin(2.0 * np.pi * 0.013 * T_S) * (T_S > 10.0)
ANGLE_DEG = np.concatenate([[0.0], np.cumsum((TRUE_DPS[1:] + TRUE_DPS[:-1]) / 2.0 / RATE_HZ)])
TEMP_C = 22.0 + 0.1 * T_S

# fmt: off
EXACT = (
    "bandwidth:cutoff_hz=8", "bandwidth:cutoff_hz=5,order=2", "deadband", "g_sensitivity", "latency:delay_ms=23",
    "misalignment", "nonlinearity", "quantization", "saturation:limit_dps=60", "scale_asymmetry", "scale_factor",
    "temp_bias:slope_dps_per_c=0.03,curve_per_c=0.01", "temp_scale", "vibration_rectification", "warmup",
    "warmup:amplitude_dps=0.4,time_constant_s=60,fast_share=0.3,fast_time_constant_s=8",
)
RANDOM = (
    "bias_instability:floor_dph=400", "popcorn:step_dps=0.5,dwell_s=3", "rate_random_walk", "spikes:height_dps=50",
    "stale_hold:share_percent=5", "vibration",
)
# fmt: on
SLOW = {"rate_random_walk"}


def entry(text: str) -> dict[str, object]:
    """An effect as `effects.json` has it."""
    fields = parse_effect(text).model_dump()
    return {"effect": fields.pop("name"), "parameters": fields}


def by_simulator(text: str, seed: int = 1) -> Floats:
    """Rates of the project's simulator with the effect, before counts."""
    acts = begin_acts(Rig(effects=(parse_effect(text),)), seed, 0)
    truth = Moments(T_S, T_S, ANGLE_DEG, TRUE_DPS, TEMP_C, 1.0 / RATE_HZ)
    seen_s = through(acts[EffectSlot.LAG], T_S, truth)
    sensed = Moments(T_S, T_S, ANGLE_DEG, np.interp(seen_s, T_S, TRUE_DPS), TEMP_C, 1.0 / RATE_HZ)
    channel = Channel(acts, np.random.default_rng(seed), 0.0, 0.0, RATE_HZ, 1)
    return channel.sampled(channel.continuous(sensed.rate_dps, sensed), sensed)


def by_wrapper(*texts: str, seed: int = 1, count: int = COUNT) -> Floats:
    return apply(TRUE_DPS[:count], T_S[:count], [entry(text) for text in texts], TEMP_C[:count], seed)


@pytest.mark.parametrize("text", EXACT)
def test_an_effect_without_chance_is_the_same_as_in_the_simulator(text: str) -> None:
    assert by_wrapper(text, count=2000) == pytest.approx(by_simulator(text)[:2000], abs=1e-6)


def spread(values: Floats, lag: int) -> float:
    changes = values[lag:] - values[:-lag]
    return float(np.sqrt(np.mean(np.square(changes))))


def spreads(values: Floats) -> Floats:
    """RMS changes over 10 ms, 1 s and 10 s; of walks, those of less than 0.1 s are interpolated in the simulator."""
    return np.array([np.sqrt(np.mean(np.square(values[lag:] - values[:-lag]))) for lag in (1, 100, 1000)])


@pytest.mark.parametrize("text", RANDOM)
def test_an_effect_of_chance_scatters_as_in_the_simulator(text: str) -> None:
    """RMS changes in the mean over realizations."""
    seeds = range(1, 3)
    ours = np.mean([spreads(by_wrapper(text, seed=seed) - TRUE_DPS) for seed in seeds], axis=0)
    theirs = np.mean([spreads(by_simulator(text, seed) - TRUE_DPS) for seed in seeds], axis=0)
    compared = slice(1, None) if text in SLOW else slice(None)
    assert ours[compared] == pytest.approx(theirs[compared], rel=0.15)


def test_every_effect_on_the_rate_is_compared() -> None:
    """White noise and constant bias belong to the ideal device and have tests of their own."""
    compared = {text.partition(":")[0] for text in (*EXACT, *RANDOM)}
    on_rate = {name for name, kind in CATALOGUE.items() if kind.slot <= EffectSlot.HOLD}
    assert compared == on_rate == EFFECTS.keys() - {"white_noise", "constant_bias"}


def test_noise_and_bias_have_their_size() -> None:
    """The standard deviation of a sample is the density times the root of the sample rate."""
    noise = [
        {"effect": "white_noise", "parameters": {"density_dps_rthz": 0.02}},
        {"effect": "constant_bias", "parameters": {"bias_dps": -0.7}},
    ]
    error_dps = apply(TRUE_DPS, T_S, noise, seed=3) - TRUE_DPS
    assert error_dps.mean() == pytest.approx(-0.7, abs=0.01)
    assert error_dps.std() == pytest.approx(0.02 * np.sqrt(RATE_HZ), rel=0.03)


def test_nothing_is_nothing() -> None:
    assert apply(TRUE_DPS, T_S, []).tolist() == TRUE_DPS.tolist()


def test_a_seed_gives_the_same_rates_again() -> None:
    assert by_wrapper("popcorn", seed=5, count=2000).tolist() == by_wrapper("popcorn", seed=5, count=2000).tolist()
    random = [apply(TRUE_DPS[:100], T_S[:100], [entry("rate_random_walk")]).tolist() for _ in range(2)]
    assert random[0] != random[1]


def test_sample_by_sample_is_the_same_as_all_at_once() -> None:
    """A simulator that evaluates a time twice gets the same rate twice."""
    effects = [entry("latency:delay_ms=15"), entry("popcorn:step_dps=0.5,dwell_s=1"), entry("bandwidth:cutoff_hz=9")]
    gyro = SimulatedGyro(effects, 1.0 / RATE_HZ, seed=2)
    rates = []
    for rate_dps, t_s in zip(TRUE_DPS.tolist(), T_S.tolist(), strict=True):
        rates.append(gyro.read(rate_dps, t_s))
        assert gyro.read(rate_dps, t_s) == rates[-1]
    assert rates == pytest.approx(apply(TRUE_DPS, T_S, effects, seed=2), abs=1e-9)


def test_effects_act_in_the_order_of_a_device() -> None:
    """The scale error is rounded, and the limit cuts what is scaled."""
    rates = by_wrapper("quantization:step_dps=0.5", "scale_factor:error_percent=10", "saturation:limit_dps=80.2")
    assert rates.max() == 80.0
    assert np.all(rates % 0.5 == 0.0)


def test_an_effect_that_is_none_of_the_rate_is_refused() -> None:
    """The message lists those that are."""
    with pytest.raises(ValueError, match="is called scale_factor with error_pct; there are error_percent"):
        apply([1.0, 1.0], [0.0, 0.01], [{"effect": "scale_factor", "parameters": {"error_pct": 2.0}}])
    with pytest.raises(ValueError, match="must not contain infs or NaNs"):
        apply([1.0, float("nan")], [0.0, 0.01], [])
    with pytest.raises(ValueError, match="is called clock_drift with ppm; there are bandwidth, "):
        apply(TRUE_DPS, T_S, [{"effect": "clock_drift", "parameters": {"ppm": 100.0}}])


def test_it_is_short_enough_to_be_copied() -> None:
    tree = ast.parse(Path(gyrodrift.effects.__file__).read_text())
    code = [node for node in tree.body if isinstance(node, ast.ClassDef | ast.FunctionDef)]
    statements = [
        node
        for part in code
        for node in ast.walk(part)
        if isinstance(node, ast.stmt) and not isinstance(node, ast.Expr | ast.ClassDef | ast.FunctionDef)
    ]
    assert len(statements) <= 60
    modules = [node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    assert all(module and module.split(".")[0] in {"collections", "math", "numpy", "typing"} for module in modules)


def test_entries_come_through_json() -> None:
    effects = json.loads(json.dumps([entry("bandwidth:cutoff_hz=5,order=2")]))
    assert np.isfinite(apply(TRUE_DPS, T_S, effects)).all()
