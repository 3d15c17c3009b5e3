"""A rig with a known limit of its gyro: motion beyond the limit is no evidence."""

from dataclasses import replace
from random import Random

import numpy as np
import pytest

from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import Base, Rig, parse_effect
from gyrodrift.diagnose.features.block_residuals import block_residuals_of
from gyrodrift.diagnose.features.vector import NUMBER
from gyrodrift.diagnose.recording.recording import recording_of
from gyrodrift.diagnose.simulate.known_effects import known_at_limit
from gyrodrift.diagnose.simulate.twin import Subject, subject_of
from gyrodrift.simulation.sessions import Simulation

MINUTES = 2.0
"""So long that the turntable goes at 180 deg/s in both directions, twice."""

MISSES_DPS = 10.0
"""Root of the sum of squares of a regressor over blocks; 55 deg/s beyond a limit make more in one block."""


def rig_of(limit_dps: float, cpr: int = 1024) -> Rig:
    """A gyro whose range ends at a limit."""
    effect = parse_effect(f"saturation:limit_dps={limit_dps}")
    return Rig(base=Base(sample_rate_hz=100.0, noise_dps_rthz=0.005, encoder_cpr=cpr), effects=(effect,))


def seen_of(rig: Rig, seed: int, expected: Rig) -> Subject:
    """A session of a rig, by what is known of it."""
    return subject_of(recording_of(Simulation(rig, load_profile("turntable"), seed, 0, MINUTES).whole()), expected)


@pytest.mark.parametrize("seed", range(4))
def test_blocks_at_a_limit_that_the_rig_knows_say_nothing(seed: int) -> None:
    dice = Random(seed)
    limit_dps = dice.uniform(90.0, 150.0)
    rig = rig_of(limit_dps, dice.choice([512, 1024, 4096]))
    item = seen_of(rig, seed, rig)
    remaining, silent = block_residuals_of(item.cleaned, item.design), item.design.is_silent
    true_dps = load_profile("turntable").motion_at(
        np.arange(item.design.samples, dtype=np.float64) * item.design.period_s
    )[1]
    beyond = np.abs(true_dps) > limit_dps + 1.0
    whole = len(silent) * item.design.block
    assert silent[np.flatnonzero(beyond[:whole]) // item.design.block].all()
    assert 0.05 < silent.mean() < 0.2
    assert (remaining.unexplained_dps[silent] == 0.0).all()
    assert np.abs(remaining.static).max() < MISSES_DPS / 100.0


@pytest.mark.parametrize("seed", range(3))
def test_a_rig_that_has_a_limit_is_as_its_simulation(seed: int) -> None:
    rig = rig_of(125.0)
    item = seen_of(rig, seed, rig)
    result, runs = item.measured(), np.array([item.base_run(run).values for run in range(4)])
    for name in ("rate", "abs_rate", "rate_cubed", "rate_squared"):
        motion_at = NUMBER[name]
        assert abs(result.values[motion_at] - runs[:, motion_at].mean()) < result.thresholds[motion_at]


def test_a_limit_that_the_rig_does_not_know_shows() -> None:
    item = seen_of(rig_of(125.0), 1, Rig(base=rig_of(125.0).base))
    assert not item.design.is_silent.any()
    assert known_at_limit(item.rig, item.cleaned) is None
    assert np.abs(block_residuals_of(item.cleaned, item.design).static).max() > MISSES_DPS


def test_a_limit_at_another_rate_than_the_rig_says_is_one_too() -> None:
    item = seen_of(rig_of(100.0), 1, rig_of(150.0))
    result = known_at_limit(item.rig, item.cleaned)
    assert result is not None
    assert result.mean() == pytest.approx(np.mean(np.abs(item.cleaned.rate_dps) > 99.9), rel=0.05)


def test_where_another_limit_is_tried_other_blocks_say_nothing() -> None:
    item = seen_of(rig_of(100.0), 1, rig_of(150.0))
    base = item.base_run(1)
    design = item.design_for(item.replayed(rig_of(100.0).effects, 1), base)
    assert design.is_silent.tolist() == item.design.is_silent.tolist()
    assert base.design.is_silent.sum() < design.is_silent.sum()


def test_what_is_added_to_the_rate_leaves_the_limit_where_it_was() -> None:
    """A gain makes rates at the limit unequal in a simulation that is not played again: blocks stay silent."""
    rig = rig_of(125.0)
    item = seen_of(rig, 1, rig)
    base = item.base_run(1)
    rate_dps = item.rate_with(parse_effect("scale_factor:error_percent=1"), base, 1)
    with_gain = replace(base.cleaned, rate_dps=rate_dps)
    assert item.design_for(with_gain, base) is base.design
