"""A witness of rest: what an honest one is worth, what one that lies does not cost, and the same bits everywhere."""

import numpy as np
import pytest

from gyrodrift.evaluation.auxiliary import Auxiliary
from gyrodrift.evaluation.kernels.restlevel import walk
from gyrodrift.filters.restlevel.model import RestlevelParams, RestlevelState
from gyrodrift.filters.restlevel.step import coefficients, step
from gyrodrift.values.arrays import Floats

pytestmark = pytest.mark.xdist_group("restlevel_kernel")

RATE_HZ = 100.0
NOBODY = np.empty(0)


def stop_and_go(bias_dps: float, seed: int, minutes: float = 3.0, stop_s: float = 1.0) -> tuple[Floats, Floats, Floats]:
    """True rate, measured rate and whether it stands still: 6 s of weaving, then a stop too short for statistics."""
    t_s = np.arange(round(minutes * 60.0 * RATE_HZ)) / RATE_HZ
    part_s = t_s % (6.0 + stop_s)
    true_dps = np.where(part_s < 6.0, 40.0 * np.sin(2.0 * np.pi * part_s / 6.0) * (1.0 + 0.3 * np.sin(t_s / 7.0)), 0.0)
    noise_dps = np.random.default_rng(seed).normal(0.0, 0.05, len(t_s))
    return true_dps, true_dps + bias_dps + noise_dps, np.where(part_s < 6.0, 0.0, 1.0)


def yaw_of(true_dps: Floats) -> Floats:
    return np.cumsum(0.5 * (true_dps + np.r_[true_dps[0], true_dps[:-1]])) / RATE_HZ


def estimated(rate_dps: Floats, still: Floats, p: RestlevelParams | None = None) -> Floats:
    """Yaw, its sigma and the bias."""
    dt_s = np.r_[0.0, np.full(len(rate_dps) - 1, 1.0 / RATE_HZ)]
    return walk(dt_s, rate_dps, p or RestlevelParams(), Auxiliary(still, NOBODY))


def stepped(rate_dps: Floats, still: Floats, state: RestlevelState | None = None) -> RestlevelState:
    """The state after plain stepping."""
    c, s = coefficients(RestlevelParams()), state or RestlevelState()
    for n, (dps, statement) in enumerate(zip(rate_dps.tolist(), still.tolist(), strict=True)):
        step(c, s, n / RATE_HZ, dps, statement)
    return s


@pytest.mark.parametrize("bias_dps", [0.0, 0.4, -3.0])
def test_its_word_is_taken_where_statistics_cannot_tell(bias_dps: float) -> None:
    """Stops of a second, in a device that begins moving."""
    true_dps, rate_dps, still = stop_and_go(bias_dps, 1)
    yaw_deg, _, found_dps = estimated(rate_dps, still)
    assert abs(found_dps[-1] - bias_dps) < 0.02
    assert np.abs(yaw_deg - yaw_of(true_dps))[-6000:].max() < 1.0


def test_nothing_is_taken_for_rest_while_it_says_that_the_device_moves() -> None:
    """A constant spin from the first sample on, which looks exactly like a bias."""
    rate_dps = 0.6 + np.random.default_rng(2).normal(0.0, 0.05, 6000)
    yaw_deg, *_ = estimated(rate_dps, np.zeros(6000))
    assert yaw_deg[-1] == pytest.approx(36.0, abs=0.5)


def test_a_word_that_is_stuck_in_turns_is_found_out_and_costs_little() -> None:
    """Ten seconds of true rest, then turns, all said to be rest: not believed from the second second of turning on."""
    true_dps, rate_dps, _ = stop_and_go(0.3, 3, stop_s=4.0)
    true_dps, rate_dps = np.r_[np.zeros(1000), true_dps], np.r_[rate_dps[600:1000], rate_dps[600:1000], rate_dps]
    rate_dps = np.r_[np.full(200, 0.3), rate_dps]
    stuck = np.ones(len(rate_dps))
    silent, *_ = estimated(rate_dps, np.full(len(rate_dps), np.nan))
    report, *_ = estimated(rate_dps, stuck)
    truth = yaw_of(true_dps)
    assert np.abs(report - truth).max() < np.abs(silent - truth).max() + 2.0
    state = stepped(rate_dps[:1400], stuck[:1400])
    assert (state.witness.refuted, state.witness.is_believed) == (1, False)


def test_a_word_that_is_stuck_from_the_first_sample_of_a_turn_teaches_nothing_that_stays() -> None:
    """A turn of 8 deg/s is taken for a bias that is far out, until it ends; then what it taught is doubtful."""
    dice = np.random.default_rng(4)
    true_dps = np.r_[np.full(500, 8.0), np.zeros(1500), 30.0 * np.sin(np.arange(1000) / 60.0), np.zeros(1500)]
    rate_dps = true_dps + 0.2 + dice.normal(0.0, 0.05, len(true_dps))
    state = stepped(rate_dps, np.ones(len(rate_dps)))
    assert state.witness.refuted >= 1
    assert state.bias_dps == pytest.approx(0.2, abs=0.05)


def test_it_is_believed_again_once_it_has_said_something_else() -> None:
    turning, resting = np.full(300, 30.0) * np.sin(np.arange(300) / 30.0), np.full(400, 0.1)
    noise = np.random.default_rng(5).normal(0.0, 0.05, 1400)
    rate_dps = np.r_[resting, turning, turning, resting] + noise
    still = np.r_[np.ones(400), np.ones(300), np.zeros(300), np.ones(400)]
    assert not stepped(rate_dps[:700], still[:700]).witness.is_believed
    s = stepped(rate_dps, still)
    assert s.witness.is_believed
    assert s.witness.was_certain
    assert s.rest_probability == 1.0


def test_a_word_that_comes_late_at_both_ends_of_a_rest_does_no_harm() -> None:
    true_dps, rate_dps, still = stop_and_go(0.4, 6, stop_s=3.0)
    late = np.r_[np.zeros(50), still[:-50]]
    yaw_deg, _, found_dps = estimated(rate_dps, late)
    assert abs(found_dps[-1] - 0.4) < 0.02
    assert np.abs(yaw_deg - yaw_of(true_dps))[-6000:].max() < 1.0
    assert stepped(rate_dps, late).witness.refuted == 0


def test_a_bias_that_jumps_while_it_says_rest_is_followed() -> None:
    rate_dps = np.r_[np.full(2000, 0.1), np.full(2000, 0.35)] + np.random.default_rng(7).normal(0.0, 0.05, 4000)
    s = stepped(rate_dps, np.ones(4000))
    assert s.witness.refuted == 0
    assert s.bias_dps == pytest.approx(0.35, abs=0.01)
    assert abs(s.yaw_deg) < 1.0


def test_a_sensor_that_takes_its_own_bias_out_begins_with_none() -> None:
    """`turn_on_dps: 0`: a level from the first sample on is a spin, one of the drift's size is a rest."""
    noise = np.random.default_rng(8).normal(0.0, 0.05, 3000)
    spin, *_ = estimated(0.6 + noise, NOBODY, RestlevelParams(turn_on_dps=0.0))
    assert spin[-1] == pytest.approx(18.0, abs=0.5)
    _, sigma_deg, bias_dps = estimated(0.003 + noise, NOBODY, RestlevelParams(turn_on_dps=0.0))
    assert bias_dps[-1] == pytest.approx(0.003, abs=0.003)
    assert sigma_deg[-1] < 0.2
