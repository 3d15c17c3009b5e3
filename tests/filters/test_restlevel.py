"""Restlevel: an independent reading of its equations, the same bits however it is run, and what it makes of motions."""

from copy import deepcopy
from itertools import product
from math import inf, isfinite, isnan, nan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from recordings_support import Recordings
from scipy.signal import lfilter
from support import quick

from gyrodrift.evaluation.auxiliary import NO_AUXILIARY, Auxiliary
from gyrodrift.evaluation.kernels.restlevel import _follow, array_of, walk
from gyrodrift.evaluation.reference import accepted
from gyrodrift.filters.beliefs import MAX_HYPOTHESES
from gyrodrift.filters.restlevel.model import RestlevelParams, RestlevelState
from gyrodrift.filters.restlevel.step import coefficients, step
from gyrodrift.session.files import load_session
from gyrodrift.values.arrays import Floats

pytestmark = pytest.mark.xdist_group("restlevel_kernel")

RATE_HZ = 100.0
REAL = ("broad_01", "broad_06", "broad_14", "mpu6050_still", "temperature_sweep")

rates = st.one_of(st.floats(-2.0, 2.0), st.sampled_from([0.0, -0.0, nan, inf, -inf, 300.0, -300.0, 1e9]))
steps_s = st.one_of(st.floats(1e-4, 0.1), st.sampled_from([0.01, 0.01, 0.01, 0.0, -0.05, 5.0, 1e6, nan]))
words = st.sampled_from([nan, 1.0, 1.0, 1.0, 0.0])
temps_c = st.one_of(st.floats(15.0, 60.0), st.sampled_from([nan, inf, -1e9, 1e9]))
params = st.builds(
    RestlevelParams,
    window_s=st.floats(0.01, 0.5),
    quiet=st.floats(0.1, 50.0),
    turn_on_dps=st.one_of(st.floats(0.001, 50.0), st.just(0.0)),
    walk_dps_rts=st.floats(0.0, 0.1),
    drift_dps_s=st.floats(0.0, 0.1),
    still_start=st.floats(0.0, 0.999),
    rest_share=st.floats(0.0, 0.999),
)


def walked(
    t_s: Floats,
    rate_dps: Floats,
    p: RestlevelParams,
    state: RestlevelState | None = None,
    auxiliary: Auxiliary = NO_AUXILIARY,
) -> Floats:
    """Yaw, its sigma and the bias after each sample, shape (3, n), by the plain filter."""
    statement = auxiliary.filled(len(t_s))
    c, s = coefficients(p), state or RestlevelState()
    rows = []
    for sample in zip(*(item.tolist() for item in (t_s, rate_dps, *statement)), strict=True):
        step(c, s, *sample)
        rows.append((s.yaw_deg, s.yaw_sigma_deg, s.bias_dps))
    return np.array(rows).T


def estimates(t_s: Floats, rate_dps: Floats, p: RestlevelParams, auxiliary: Auxiliary = NO_AUXILIARY) -> Floats:
    return walk(np.diff(t_s, prepend=t_s[:1]), rate_dps, p, auxiliary)


def measured(true_dps: Floats, bias_dps: float | Floats, seed: int = 1) -> tuple[Floats, Floats, Floats]:
    """Times, rates with a bias and noise, and the true yaw."""
    t_s = np.arange(len(true_dps)) / RATE_HZ
    rate_dps = true_dps + bias_dps + np.random.default_rng(seed).normal(0.0, 0.05, len(true_dps))
    middle_dps = 0.5 * (true_dps + np.r_[true_dps[0], true_dps[:-1]])
    return t_s, rate_dps, np.cumsum(middle_dps) / RATE_HZ


def frozen(*pieces: tuple[float, float]) -> Floats:
    """Rates in deg/s, each for so many seconds, with half a second from one to the next."""
    knots_s, knots_dps, now_s = [0.0], [pieces[0][0]], 0.0
    for rate_dps, seconds in pieces:
        knots_s += [now_s + 0.5, now_s + seconds]
        knots_dps += [rate_dps, rate_dps]
        now_s += seconds
    return np.interp(np.arange(round(now_s * RATE_HZ)) / RATE_HZ, knots_s, knots_dps)


TURNS = [(0.0, 5.0), (30.0, 4.0), (0.0, 5.0), (-12.0, 6.0), (0.0, 4.0), (5.0, 5.0)]


@pytest.mark.parametrize("name", REAL)
def test_the_compiled_filter_has_the_same_bits(name: str, recordings: Recordings) -> None:
    session = load_session(recordings.path(name))
    t_s, rate_dps = session.t_device_s[:20_000], session.rate_dps[:20_000]
    compiled = estimates(t_s, rate_dps, RestlevelParams())
    np.testing.assert_array_equal(compiled, walked(t_s, rate_dps, RestlevelParams()))


@given(params, st.lists(st.tuples(steps_s, rates, words, temps_c), max_size=400))
def test_bits_are_the_same_whatever_comes(p: RestlevelParams, stream: list[tuple[float, float, float, float]]) -> None:
    """Plain and compiled, with values that no sensor sends; what is finite stays so."""
    t_s = np.cumsum([0.0, *(0.0 if isnan(step_s) else step_s for step_s, *_ in stream)])
    rate_dps = np.array([0.1, *(rate for _, rate, *_ in stream)])
    still, temp_c = (np.array([nan, *(sample[index] for sample in stream)]) for index in (2, 3))
    plain, kept = walked(t_s, rate_dps, p, auxiliary=Auxiliary(still, temp_c)), accepted(t_s, rate_dps)
    auxiliary = Auxiliary(still[kept], temp_c[kept])
    np.testing.assert_array_equal(estimates(t_s[kept], rate_dps[kept], p, auxiliary), plain[:, kept])
    assert np.isfinite(plain).all()


def test_saved_half_way_it_goes_on_with_the_same_bits() -> None:
    """A deep copy of the state is the filter."""
    t_s, rate_dps, _ = measured(frozen(*TURNS * 4), 0.3)
    whole = walked(t_s, rate_dps, RestlevelParams())
    for cut in (1, 17, 2500, 9999):
        state = RestlevelState()
        walked(t_s[:cut], rate_dps[:cut], RestlevelParams(), state)
        saved = deepcopy(state)
        walked(t_s[cut:][::-1], rate_dps[cut:], RestlevelParams(), state)
        np.testing.assert_array_equal(walked(t_s[cut:], rate_dps[cut:], RestlevelParams(), saved), whole[:, cut:])


def test_a_plain_state_goes_on_compiled_with_the_same_bits() -> None:
    t_s, rate_dps, _ = measured(frozen(*TURNS * 4), 0.3)
    whole, state, cut = walked(t_s, rate_dps, RestlevelParams()), RestlevelState(), 5000
    walked(t_s[:cut], rate_dps[:cut], RestlevelParams(), state)
    result = np.zeros((3, len(t_s) - cut))
    auxiliary, steps_s = (np.empty(0), np.empty(0)), np.diff(t_s)[cut - 1 :]
    _follow(array_of(coefficients(RestlevelParams())), array_of(state), steps_s, rate_dps[cut:], *auxiliary, result)
    np.testing.assert_array_equal(result, whole[:, cut:])


def test_it_does_not_grow() -> None:
    t_s, rate_dps, _ = measured(frozen(*TURNS * 20), 0.3)
    c, s = coefficients(RestlevelParams()), RestlevelState()
    places = len(s.hypotheses)
    for each_s, each_dps in zip(t_s.tolist(), rate_dps.tolist(), strict=True):
        step(c, s, each_s, each_dps)
        assert sum(h.weight > 0.0 for h in s.hypotheses) <= MAX_HYPOTHESES
    assert len(s.hypotheses) == places


def test_what_cannot_be_used_is_passed_by_and_counted() -> None:
    """Times that do not advance, and what is no number."""
    c, s = coefficients(RestlevelParams()), RestlevelState()
    assert not step(c, s, nan, 1.0)
    assert not step(c, s, 0.0, inf)
    assert step(c, s, 0.0, 1.0)
    before = deepcopy(s)
    for t_s, rate_dps in ((0.0, 1.0), (-1.0, 1.0), (inf, 1.0), (1.0, nan)):
        assert not step(c, s, t_s, rate_dps)
    before.rejected = s.rejected
    assert s == before
    assert s.rejected == 6


@pytest.mark.parametrize("bias_dps", [0.0, 0.02, -0.5, 3.0])
def test_turns_and_rests_are_told_apart_whatever_the_bias(bias_dps: float) -> None:
    t_s, rate_dps, true_deg = measured(frozen(*TURNS * 6), bias_dps)
    yaw_deg, _, found_dps = estimates(t_s, rate_dps, RestlevelParams())
    assert np.abs(yaw_deg - true_deg)[1200:].max() < 0.5
    assert found_dps[-1] == pytest.approx(bias_dps, abs=0.005)


@pytest.mark.parametrize("spin_dps", [0.2, 0.5, 1.5, 20.0])
def test_a_spin_that_begins_after_a_rest_is_no_drift(spin_dps: float) -> None:
    """Ten minutes of it, with a bias of its own size."""
    t_s, rate_dps, true_deg = measured(frozen((0.0, 10.0), (spin_dps, 600.0)), -0.4)
    yaw_deg, _, _ = estimates(t_s, rate_dps, RestlevelParams())
    assert np.abs(yaw_deg - true_deg).max() < 5.0


def with_engine(true_dps: Floats, drift_dps: float = 0.0) -> tuple[Floats, Floats, Floats, Floats]:
    """Ten seconds of rest, then an engine of 0.5 deg/s; times, rates, true yaw, bias of 0.4 deg/s that drifts."""
    bias_dps = 0.4 + drift_dps * np.linspace(0.0, 1.0, len(true_dps))
    t_s, rate_dps, true_deg = measured(true_dps, bias_dps)
    engine = np.random.default_rng(2).normal(0.0, 0.5, len(true_dps))
    return t_s, rate_dps + engine * (t_s > 10.0), true_deg, bias_dps


def test_a_running_engine_is_no_motion() -> None:
    """Its rest holds yaw while the bias drifts, and follows the drift."""
    t_s, rate_dps, true_deg, bias_dps = with_engine(np.zeros(30_000), drift_dps=0.1)
    yaw_deg, sigma_deg, found_dps = estimates(t_s, rate_dps, RestlevelParams())
    assert np.abs(yaw_deg - true_deg).max() < 1.0
    assert abs(found_dps[-1] - bias_dps[-1]) < 0.03
    assert sigma_deg[-1] < 10.0


@pytest.mark.parametrize("bend_dps", [0.15, 0.3, -1.0])
def test_an_even_drive_with_a_running_engine_is_no_rest(bend_dps: float) -> None:
    t_s, rate_dps, true_deg, _ = with_engine(frozen((0.0, 12.0), (bend_dps, 60.0), (-bend_dps, 60.0)))
    yaw_deg, _, found_dps = estimates(t_s, rate_dps, RestlevelParams())
    assert np.abs(yaw_deg - true_deg).max() < 1.5
    assert found_dps[-1] == pytest.approx(0.4, abs=0.02)


def test_what_to_make_of_a_spin_from_the_first_sample_is_a_setting() -> None:
    t_s, rate_dps, true_deg = measured(frozen((0.6, 300.0)), 0.0)
    resting, *_ = estimates(t_s, rate_dps, RestlevelParams(still_start=0.99))
    turning, *_ = estimates(t_s, rate_dps, RestlevelParams(still_start=0.0))
    assert abs(resting[-1]) < 1.0
    assert abs(turning[-1] - true_deg[-1]) < 1.0


def test_a_device_that_moves_from_the_first_sample_finds_its_bias_at_its_rests() -> None:
    t_s, rate_dps, true_deg = measured(frozen((25.0, 6.0), *TURNS * 4), 0.7)
    yaw_deg, _, _ = estimates(t_s, rate_dps, RestlevelParams())
    assert abs(yaw_deg[500] - true_deg[500]) > 3.0
    assert np.abs(yaw_deg - true_deg)[-4000:].max() < 0.5


def test_yaw_stands_still_in_a_long_rest_while_the_bias_drifts() -> None:
    """An hour in which the bias goes up and down by half a degree a second."""
    bias_dps = 0.5 * np.sin(np.arange(360_000) / RATE_HZ / 600.0)
    t_s, rate_dps, _ = measured(np.zeros(360_000), bias_dps)
    yaw_deg, _, found_dps = estimates(t_s, rate_dps, RestlevelParams())
    assert np.abs(yaw_deg[200:]).max() < 0.5
    assert np.abs(found_dps - bias_dps)[1000:].max() < 0.05


@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(seed, marks=pytest.mark.evaluation) for seed in range(2, 6))])
def test_a_bias_that_flickers_is_not_a_spin(seed: int) -> None:
    """An hour at rest; wobbles of seconds to minutes, larger than what the noise makes of a block."""
    dice, bias_dps = np.random.default_rng(seed), np.full(360_000, 0.2)
    for memory_s in (1.0, 5.0, 25.0, 125.0):
        kept = np.exp(-1.0 / (RATE_HZ * memory_s))
        shocks = dice.normal(0.0, 0.008 * np.sqrt(1.0 - kept**2), len(bias_dps))
        bias_dps += lfilter([1.0], [1.0, -kept], shocks)
    t_s, rate_dps, _ = measured(np.zeros(360_000), bias_dps, seed)
    yaw_deg, *_ = estimates(t_s, rate_dps, RestlevelParams())
    assert np.abs(yaw_deg[200:]).max() < 1.0


@pytest.mark.parametrize("seed", quick(range(20), 0, 1, 2, 3))
def test_a_rest_at_the_start_is_found_whatever_chance_does_to_its_first_blocks(seed: int) -> None:
    """The noise is known from few samples then; ten seconds at rest are enough to tell a slow spin by."""
    t_s, rate_dps, true_deg = measured(frozen((0.0, 10.0), (1.5, 60.0)), 0.5, seed)
    yaw_deg, *_ = estimates(t_s, rate_dps, RestlevelParams())
    assert np.abs(yaw_deg - true_deg)[1000:].max() < 2.0


@pytest.mark.parametrize(
    ("bias_dps", "first_dps", "lsb_dps"),
    quick(
        product((0.03, 0.6, -1.5), (0.0, None), (0.004, 0.0305, 0.061)),
        *((0.03, 0.0, 0.061), (0.6, None, 0.0305), (-1.5, 0.0, 0.004), (-1.5, None, 0.061)),
    ),
)
def test_samples_that_repeat_at_first_do_not_end_its_learning(
    bias_dps: float, first_dps: float | None, lsb_dps: float
) -> None:
    """Zeros while a device starts, or a part that stands between two of its steps for a while."""
    t_s, rate_dps, true_deg = measured(frozen(*TURNS * 6), bias_dps)
    rate_dps = np.round(rate_dps / lsb_dps) * lsb_dps
    rate_dps[:35] = rate_dps[0] if first_dps is None else first_dps
    yaw_deg, _, found_dps = estimates(t_s, rate_dps, RestlevelParams())
    assert found_dps[-1] == pytest.approx(bias_dps, abs=0.01)
    assert np.abs(yaw_deg - true_deg)[-3000:].max() < 2.0


@pytest.mark.parametrize(
    ("zeros", "lsb_dps"),
    quick(product((35, 509, 510, 3001), (0.0, 0.0076, 0.0175)), (35, 0.0), (509, 0.0076), (510, 0.0175), (3001, 0.0)),
)
def test_zeros_while_a_device_starts_are_no_rest(zeros: int, lsb_dps: float) -> None:
    t_s, rate_dps, true_deg = measured(np.zeros(12_000), 0.6, zeros)
    rate_dps = np.round(rate_dps / lsb_dps) * lsb_dps if lsb_dps else rate_dps
    rate_dps[:zeros] = 0.0
    yaw_deg, sigma_deg, found_dps = estimates(t_s, rate_dps, RestlevelParams())
    assert found_dps[-1] == pytest.approx(0.6, abs=0.01)
    assert np.abs(yaw_deg - true_deg)[-6000:].max() < 3.0 * sigma_deg[-1] < 1.5


FREEZES = [(60.0, 0.3), (62.0, 1.0), (73.0, 30.0), (110.0, 5.0)]
"""When in a recording of turns the sensor hangs, and for how long, s: at rest, in a turn, and in both."""


def hung(rate_dps: Floats, lsb_dps: float, at_dps: float | None) -> Floats:
    said_dps = np.round(rate_dps / lsb_dps) * lsb_dps
    for begun_s, seconds in FREEZES:
        first = round(begun_s * RATE_HZ)
        said_dps[first : first + round(seconds * RATE_HZ)] = said_dps[first - 1] if at_dps is None else at_dps
    return np.asarray(said_dps)


@pytest.mark.promise("Recovery")
@pytest.mark.parametrize("at_dps", [None, 0.0, 40.0])
def test_a_sensor_that_hangs_says_nothing_and_its_rests_are_found_again(at_dps: float | None) -> None:
    """Restlevel learns nothing from a hanging sensor, and finds its rests again afterwards."""
    t_s, rate_dps, true_deg = measured(frozen(*TURNS * 6, (0.0, 20.0)), 0.4)
    rate_dps = hung(rate_dps, 0.0076, at_dps)
    yaw_deg, sigma_deg, found_dps = estimates(t_s, rate_dps, RestlevelParams())
    assert found_dps[-1] == pytest.approx(0.4, abs=0.01)
    last_s, seconds = FREEZES[-1]
    after = round((last_s + seconds + 1.0) * RATE_HZ)
    drift_deg = (yaw_deg - true_deg)[after:]
    assert np.abs(drift_deg - drift_deg[0]).max() < 2.0
    state = RestlevelState()
    walked(t_s, rate_dps, RestlevelParams(), state)
    assert state.rest_probability > 0.95
    assert state.noise.sample_var == pytest.approx(0.05**2, rel=0.5)
    if at_dps == 40.0:
        assert abs(drift_deg[-1]) < 3.0 * sigma_deg[-1]


def test_a_device_that_says_zero_at_rest_is_at_rest() -> None:
    t_s, rate_dps, true_deg = measured(frozen(*[(0.0, 10.0), (30.0, 4.0)] * 4, (0.0, 20.0)), 0.01)
    rate_dps = np.round(rate_dps / 0.0076) * 0.0076
    clamped = np.abs(rate_dps) < 0.3
    clamped[:800] = False
    rate_dps[clamped] = 0.0
    state = RestlevelState()
    yaw_deg, _, _ = walked(t_s, rate_dps, RestlevelParams(), state)
    assert state.rest_probability > 0.95
    assert abs(yaw_deg[-1] - true_deg[-1]) < 2.0


def test_a_part_that_is_quieter_than_its_steps_loses_nothing_but_a_share_of_one() -> None:
    dice = np.random.default_rng(4)
    true_dps = frozen(*TURNS * 60)
    rate_dps = np.round((true_dps + 0.6 + dice.normal(0.0, 0.009, len(true_dps))) / 0.061) * 0.061
    t_s = np.arange(len(true_dps)) / RATE_HZ
    yaw_deg, _, found_dps = estimates(t_s, rate_dps, RestlevelParams())
    assert found_dps[-1] == pytest.approx(0.6, abs=0.5 * 0.061)
    assert abs(yaw_deg[-1] - true_dps.sum() / RATE_HZ) < 0.5 * 0.061 * t_s[-1]


@given(bias_dps=st.floats(-60.0, 60.0), moves_s=st.floats(1.0, 60.0), seed=st.integers(0, 99))
def test_sigma_holds_a_bias_that_is_far_out(bias_dps: float, moves_s: float, seed: int) -> None:
    """A device that moves first, and rests after: what its bias has made of yaw is no surprise."""
    t_s, rate_dps, _ = measured(frozen((40.0, moves_s), (0.0, 10.0), (-40.0, 5.0), (0.0, 5.0)), bias_dps, seed)
    c, s = coefficients(RestlevelParams()), RestlevelState()
    for each_s, each_dps in zip(t_s.tolist(), rate_dps.tolist(), strict=True):
        step(c, s, each_s, each_dps)
        assert s.yaw_sigma_deg >= 0.0
        for h in s.hypotheses:
            if h.weight > 0.0:
                assert min(h.yaw_var, h.bias_var) >= 0.0
                assert h.covariance**2 <= h.yaw_var * h.bias_var * (1.0 + 1e-6) + 1e-9


def test_what_is_left_gently_after_a_second_or_two_was_a_curve() -> None:
    """A vehicle that is under way when the device is switched on: the ends of its curves are no rests."""
    t_s = np.arange(12_000) / RATE_HZ
    curves_dps = 0.9 + 3.0 * np.cos(2.0 * np.pi * t_s / 25.0) + 1.5 * np.cos(2.0 * np.pi * t_s / 17.3)
    t_s, rate_dps, true_deg = measured(curves_dps, 0.1)
    yaw_deg, *_ = estimates(t_s, rate_dps, RestlevelParams())
    assert abs(yaw_deg - true_deg)[-1] < 1.5 * 0.1 * t_s[-1]


def test_one_that_does_not_know_says_so() -> None:
    t_s = np.arange(60_00) / RATE_HZ
    t_s, rate_dps, true_deg = measured(60.0 * np.sin(t_s), 0.4)
    yaw_deg, sigma_deg, bias_dps = estimates(t_s, rate_dps, RestlevelParams(scale_percent=0.0))
    assert bias_dps[-1] == 0.0
    assert abs(yaw_deg[-1] - true_deg[-1]) == pytest.approx(24.0, abs=0.5)
    # A part in two has taken its own bias out: of 0.5 deg/s 0.36 are left.
    assert sigma_deg[-1] == pytest.approx(0.36 * 60.0, rel=0.05)


@pytest.mark.parametrize("bias_dps", [4.4, -3.0])
def test_a_raw_part_at_rest_shows_its_bias(bias_dps: float) -> None:
    """Parts such as the MPU-6050 have several deg/s of zero-rate offset."""
    t_s, rate_dps, true_deg = measured(np.r_[np.zeros(2000), 60.0 * np.sin(np.arange(4000) / RATE_HZ)], bias_dps)
    yaw_deg, _, found_dps = estimates(t_s, rate_dps, RestlevelParams())
    assert found_dps[-1] == pytest.approx(bias_dps, abs=0.02)
    assert np.abs(yaw_deg - true_deg)[200:].max() < 1.5


@pytest.mark.parametrize("value_dps", [-0.021, 0.5])
def test_one_value_of_a_fine_sensor_at_power_on_is_no_rest(value_dps: float) -> None:
    """A bus that hangs repeats it; then the sensor rests at another rate."""
    t_s, rate_dps, _ = measured(np.zeros(4000), 0.17)
    rate_dps = np.round(rate_dps / 0.0076) * 0.0076
    rate_dps[:1000] = value_dps
    _, sigma_deg, found_dps = estimates(t_s, rate_dps, RestlevelParams())
    assert found_dps[-1] == pytest.approx(0.17, abs=0.01)
    assert sigma_deg[-1] < 0.2


@pytest.mark.parametrize("repeats", [5, 10])
def test_repeated_rows_are_no_further_measurements(repeats: int) -> None:
    """A slow sensor that is read more often."""
    t_s, rate_dps, true_deg = measured(frozen((0.0, 20.0), *TURNS * 2, (0.0, 10.0)), 0.17)
    rate_dps = np.repeat(np.round(rate_dps[::repeats] / 0.0076) * 0.0076, repeats)[: len(t_s)]
    yaw_deg, sigma_deg, found_dps = estimates(t_s, rate_dps, RestlevelParams())
    assert found_dps[-1] == pytest.approx(0.17, abs=0.03)
    assert abs(yaw_deg - true_deg)[-1] < 3.0 * sigma_deg[-1]


def test_its_certainty_is_right() -> None:
    inside = []
    for seed in range(40):
        dice = np.random.default_rng(seed)
        pieces = [
            (float(dice.choice([0.0, 1.0]) * dice.normal(0.0, 30.0)), float(dice.uniform(2.0, 8.0))) for _ in range(40)
        ]
        true_dps = frozen((0.0, 5.0), *pieces)
        bias_dps = dice.normal(0.0, 0.5) + np.cumsum(dice.normal(0.0, 0.0005 / 10.0, len(true_dps)))
        t_s, rate_dps, true_deg = measured(true_dps, bias_dps, seed)
        yaw_deg, sigma_deg, _ = estimates(t_s, rate_dps, RestlevelParams(scale_percent=0.0))
        inside.append(np.mean(np.abs(yaw_deg - true_deg) <= 2.0 * sigma_deg + 1e-6))
    assert 0.9 < np.mean(inside) < 0.9995


def test_a_sensor_of_coarse_steps_is_at_rest_where_nothing_changes() -> None:
    """Samples that are all alike show no noise at all; one step of the resolution is none either."""
    t_s, rate_dps, true_deg = measured(frozen(*TURNS * 4), 0.33)
    coarse_dps = np.round(rate_dps / 0.5) * 0.5
    yaw_deg, *_ = estimates(t_s, coarse_dps, RestlevelParams())
    assert isfinite(yaw_deg[-1])
    assert np.abs(yaw_deg - true_deg).mean() < 0.3 * np.abs(np.cumsum(coarse_dps) / RATE_HZ - true_deg).mean()
