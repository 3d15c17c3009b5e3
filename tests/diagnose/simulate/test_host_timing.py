"""Delay and jitter of a host, told from batches of a bus, from scatter to both sides and from clocks of their own."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from simulate_support import BASE, MOTION

from firmware_sim.rig import Rig, parse_effect
from gyrodrift.diagnose.recording.recording import Recording, recording_of
from gyrodrift.diagnose.simulate.calibration import host_delay_s, host_jitter_s, with_host
from gyrodrift.session.session import Session
from gyrodrift.simulation.sessions import Simulation
from gyrodrift.values.arrays import Floats


def simulated(*effects: str, delay_s: float = 0.002, jitter_s: float = 0.0) -> Session:
    base = BASE.model_copy(update={"host_delay_s": delay_s, "host_jitter_s": jitter_s})
    rig = Rig(base=base, effects=tuple(map(parse_effect, effects)))
    return Simulation(rig, MOTION, seed=1, minutes=MOTION.seconds / 60.0).whole()


@cache
def plain() -> Session:
    return simulated()


def arriving(late_s: Floats) -> Recording:
    """The plain session with so much added to each arrival."""
    session = plain()
    assert session.t_host_s is not None
    return recording_of(replace(session, t_host_s=session.t_host_s + late_s))


def dice() -> np.random.Generator:
    return np.random.default_rng(8)


COUNT = len(plain().rate_dps)


@pytest.mark.parametrize("jitter_ms", [0.1, 0.4, 2.0])
def test_the_delays_of_a_scheduler_are_a_jitter(jitter_ms: float) -> None:
    """Exponential: their mean is found, and the least of them is the delay."""
    recording = recording_of(simulated(jitter_s=jitter_ms * 1e-3))
    assert host_jitter_s(recording) == pytest.approx(jitter_ms * 1e-3, rel=0.15)
    assert host_delay_s(recording) == pytest.approx(0.002, abs=0.1 * jitter_ms * 1e-3 + 1e-6)
    base = with_host(BASE, recording)
    assert base.host_jitter_s == pytest.approx(jitter_ms * 1e-3, rel=0.15)
    assert base.host_delay_s == host_delay_s(recording)


def test_a_jitter_beside_clocks_that_drift_apart_is_the_same() -> None:
    late_s = dice().exponential(4e-4, COUNT) + 2e-3 * np.sin(np.arange(COUNT) * 2.0 * np.pi / 6000.0)
    assert host_jitter_s(arriving(late_s + 50e-6 * np.arange(COUNT))) == pytest.approx(4e-4, rel=0.2)


@pytest.mark.parametrize("name", ["batches", "wait", "normal", "early"])
def test_what_does_not_lean_to_late_is_no_jitter(name: str) -> None:
    """Batches of a bus, waiting for its next tick, normal numbers, and delays that are seldom short."""
    late_s: Floats = {
        "batches": np.asarray(0.05 - np.arange(COUNT, dtype=np.float64) * 0.01 % 0.05, np.float64),
        "wait": dice().uniform(0.0, 0.008, COUNT),
        "normal": dice().normal(0.0, 0.001, COUNT),
        "early": np.asarray(-dice().exponential(0.001, COUNT), np.float64),
    }[name]
    recording = arriving(late_s)
    assert host_jitter_s(recording) is None
    assert with_host(BASE, recording).host_jitter_s == BASE.host_jitter_s


def test_batches_of_a_simulated_bus_are_no_jitter() -> None:
    assert host_jitter_s(recording_of(simulated("usb_batching"))) is None


@pytest.mark.parametrize(("apart_s", "expected"), [(0.0, True), (0.6, True), (1.7e9, False), (-3.0, False)])
def test_a_delay_takes_a_common_zero(apart_s: float, expected: bool) -> None:  # noqa: FBT001 - parametrized
    """Clocks further apart than a second, or a host that is ahead of the device, have zeros of their own."""
    recording = arriving(np.full(COUNT, apart_s))
    if expected:
        assert host_delay_s(recording) == pytest.approx(0.002 + apart_s, abs=1e-6)
    else:
        assert host_delay_s(recording) is None
        assert with_host(BASE, recording).host_delay_s == BASE.host_delay_s


def test_without_arrivals_the_base_is_as_it_was() -> None:
    """A file of the device alone."""
    recording = recording_of(replace(plain(), t_host_s=None))
    assert host_jitter_s(recording) is None
    assert host_delay_s(recording) is None
    assert with_host(BASE, recording) == BASE
