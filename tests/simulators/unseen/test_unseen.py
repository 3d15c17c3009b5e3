"""Cases in Drake and pymunk: their benches turn as their gyros say, and a flaw does what it says."""

import ast
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from evaluate import unseen_cases
from simulators.flaws import Flaw, Floats, Signals
from simulators.unseen import benches, flaws
from simulators.unseen.benches import BENCHES
from simulators.unseen.cases import CASES, REAL, SIMULATOR
from simulators.unseen.motions import STYLES, commanded_dps
from simulators.unseen.sessions import simulated

from firmware_sim.effects.catalogue import CATALOGUE

HERE = Path(__file__).parents[3] / "benchmark" / "simulators" / "unseen"
RATE_HZ = 80.0
AGREES = {
    "Drake table": (1.3e-3, 0.0, 0.02),
    "Drake torso": (1.3e-3, 6e-4, 0.02),
    "Drake gimbal": (3.8e-3, 0.0, 0.02),
    "pymunk rover": (15e-3, 1e-2, 0.02),
    "pymunk shaft": (1.3e-3, 0.0, 0.25),
}
"""How far the integral of a rate and the angle may differ: a delay, s, a share of the way, and deg."""


def test_the_programs_know_nothing_of_gyrodrift() -> None:
    """Benches, motions and flaws are written for any simulator."""
    for name in ("drive", "drake_benches", "pymunk_benches", "benches", "motions", "flaws"):
        tree = ast.parse((HERE / f"{name}.py").read_text())
        modules = {node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
        assert not {module.split(".")[0] for module in modules} & {"gyrodrift", "firmware_sim", "blind"}


def test_cases_are_flaws_of_the_catalog_and_ten_without_one() -> None:
    effects = [case.effect for case in CASES if case.effect]
    assert (len(CASES), len(effects)) == (34, 24)
    assert len(set(effects)) >= 22
    assert set(effects) <= CATALOGUE.keys()
    assert all((case.dynamics is None) + (case.readout is None) == 2 - bool(case.effect) for case in CASES)
    assert all(case.bench in BENCHES and set(case.styles) <= STYLES.keys() for case in CASES)


@cache
def bench_signals(name: str) -> tuple[Floats, Floats]:
    """Rates and angles of a bench over 20 s."""
    bench = BENCHES[name]
    pytest.importorskip(bench.package, reason=f"{bench.package} is not installed: pip install pymunk drake")
    rng = np.random.default_rng([1, 2])
    return bench.simulate(commanded_dps(rng, 20.0, ("ramps", "rock"), 90.0, 6.0, bench.most_dps2), RATE_HZ, rng)


@pytest.mark.parametrize("name", BENCHES)
def test_a_bench_turns_both_ways_as_its_gyro_says(name: str) -> None:
    """The integral of the rate is the angle, but for what its docstring says."""
    rate_dps, angle_deg = bench_signals(name)
    integral_deg = np.concatenate([[0.0], np.cumsum(rate_dps[1:] + rate_dps[:-1]) / 2.0 / RATE_HZ])
    late_s, share, within_deg = AGREES[name]
    most_deg = late_s * np.abs(rate_dps).max() + share * np.abs(np.diff(integral_deg)).sum() + within_deg
    assert rate_dps.min() < -50.0
    assert rate_dps.max() > 50.0
    assert np.abs(integral_deg - (angle_deg - angle_deg[0])).max() < most_deg


def tone(hz: float, amplitude_dps: float = 250.0) -> Signals:
    """A perfect session of a sine of the rate, at 0 to 50 °C."""
    t_s = np.arange(4000) / RATE_HZ
    rate_dps = amplitude_dps * np.sin(2.0 * np.pi * hz * t_s)
    angle_deg = amplitude_dps * (1.0 - np.cos(2.0 * np.pi * hz * t_s)) / (2.0 * np.pi * hz)
    return Signals(t_s, t_s, None, rate_dps, rate_dps, angle_deg, np.linspace(0.0, 50.0, len(t_s)))


def flawed(flaw: Flaw, signals: Signals) -> Signals:
    return flaw(signals, np.random.default_rng(4))


def response(flaw: Flaw, hz: float) -> complex:
    """Response of a filter to a tone, after its first half."""
    signals = tone(hz)
    turning = np.exp(-2j * np.pi * hz * signals.t_s)[2000:]
    passed, true = flawed(flaw, signals).rate_dps[2000:], signals.rate_dps[2000:]
    return complex(np.sum(passed * turning) / np.sum(true * turning))


def test_filters_have_their_cutoff_and_their_delay() -> None:
    for flaw in (flaws.one_pole(5.0), flaws.bessel_filter(5.0)):
        assert abs(response(flaw, 5.0)) == pytest.approx(0.5**0.5, rel=0.02)
    late = response(flaws.all_pass(0.015), 2.0)
    assert abs(late) == pytest.approx(1.0, rel=0.01)
    assert np.angle(late) == pytest.approx(-2.0 * np.pi * 2.0 * 0.015, rel=0.01)


def test_a_response_loses_its_share_and_a_dead_band_its_rates() -> None:
    slow = tone(0.1)
    assert flawed(flaws.sine_response(0.02), slow).rate_dps.max() == pytest.approx(0.98 * 250.0, rel=1e-4)
    rates = flawed(flaws.dead_band(20.0, 40.0), slow).rate_dps
    assert 20.0 < np.abs(rates[rates != 0.0]).min() < 22.0
    rising = np.flatnonzero(rates)[0]
    assert abs(rates[rising]) > 40.0


def test_a_bias_follows_the_temperature_and_the_clock() -> None:
    """Zero at 25 °C with its slope there; 1/e of the warm-up after its time constant."""
    signals = tone(0.1, 0.0)
    assert signals.temp_c is not None
    bias_dps = flawed(flaws.temperature_bias(0.04), signals).rate_dps
    assert np.interp([24.0, 25.0, 26.0], signals.temp_c, bias_dps) == pytest.approx([-0.04, 0.0, 0.04], abs=1e-3)
    warm_dps = flawed(flaws.exponential_warm_up(0.6, 20.0), signals).rate_dps
    assert warm_dps[[0, 1600]] == pytest.approx([0.6, 0.6 * np.exp(-1.0)])
    with pytest.raises(ValueError, match="needs a session with temperatures"):
        flawed(flaws.temperature_gain(0.1), replace(signals, temp_c=None))


def test_a_belt_skips_against_the_motion() -> None:
    signals = tone(0.02, 100.0)
    skipped = flawed(flaws.skipped_teeth(2.0, 2.0), signals)
    jumps_deg = np.diff(skipped.angle_deg - signals.angle_deg)
    hits = np.abs(jumps_deg) > 1.0
    assert 15 < hits.sum() < 40
    assert np.abs(jumps_deg[hits]) == pytest.approx(2.0)
    assert (np.sign(jumps_deg[hits]) == -np.sign(signals.true_dps[1:][hits])).all()


def test_a_session_of_a_case_has_its_flaw_on_the_real_side_alone() -> None:
    """Dead band of 0.5 deg/s on the springy shaft."""
    pytest.importorskip("pymunk", reason="pymunk is not installed: pip install '.[simulators]'")
    number = next(index for index, case in enumerate(CASES, 1) if case.size == "below 0.5 deg/s reads 0")
    real, perfect = simulated(number, REAL, 0).rate_dps, simulated(number, SIMULATOR, 0).rate_dps
    assert (real == 0.0).mean() > 0.2
    assert np.abs(real[real != 0.0]).min() >= 0.5
    assert (np.abs(perfect) < 0.5).mean() > 0.2
    assert (perfect == 0.0).sum() == 0


def test_cases_without_their_simulator_are_left_out(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    messages: list[str] = []
    monkeypatch.setattr(benches, "find_spec", lambda name: None if name == "pydrake" else object())
    monkeypatch.setattr(unseen_cases, "diagnosed", lambda *_: {"verdict": "none", "causes": [], "negligible": []})
    figures = {figure.name: figure for figure in unseen_cases.unseen_figures(tmp_path, messages.append)}
    assert messages == ["left out: 21 unseen cases in pydrake; pip install pymunk drake"]
    assert figures["Drake and pymunk, no gap: none"].value == 1.0
    assert figures["Drake and pymunk, group named first"].value == 0.0
    assert figures["Drake and pymunk, no cause above 0.8 that is not there"].count == 13
    monkeypatch.setattr(benches, "find_spec", lambda name: None)
    assert unseen_cases.unseen_figures(tmp_path, messages.append) == []
