"""Memory of restlevel: a start in motion, an honest spread, a complete state."""

import json
from dataclasses import asdict, replace

import numpy as np
import pytest
from recordings_support import Recordings

from gyrodrift.evaluation.kernels.restlevel import _follow, array_of
from gyrodrift.filters.restlevel.memory import RestlevelMemory, begun, knowledge, learned
from gyrodrift.filters.restlevel.model import RestlevelParams, RestlevelState
from gyrodrift.filters.restlevel.recall import remembered_weight
from gyrodrift.filters.restlevel.step import coefficients, step
from gyrodrift.filters.saved import restore, saved
from gyrodrift.session.files import load_session
from gyrodrift.values.arrays import Floats

pytestmark = pytest.mark.xdist_group("restlevel_kernel")

RATE_HZ = 100.0
DAY_S = 86_400.0


def run(rate_dps: Floats, state: RestlevelState, p: RestlevelParams | None = None) -> Floats:
    """Yaw and bias after each sample, shape (2, n)."""
    c, rows = coefficients(p or RestlevelParams()), []
    for n, dps in enumerate(rate_dps.tolist()):
        step(c, state, n / RATE_HZ, dps)
        rows.append((state.yaw_deg, state.bias_dps))
    return np.array(rows).T


def noise(count: int, seed: int) -> Floats:
    return np.random.default_rng(seed).normal(0.0, 0.05, count)


def memory_of(bias_dps: float, before: RestlevelMemory | None = None, age_s: float = 0.0) -> RestlevelMemory:
    """After 20 s at rest."""
    state = RestlevelState() if before is None else begun(RestlevelParams(), before, age_s, None)
    run(bias_dps + noise(2000, 1), state)
    expected = learned(state, before, age_s)
    assert expected is not None
    return expected


def weaving(count: int) -> tuple[Floats, Floats]:
    """True rate and yaw of a device that begins moving."""
    t_s = np.arange(count) / RATE_HZ
    true_dps = 40.0 * np.sin(t_s) * (1.0 + 0.3 * np.sin(t_s / 7.0))
    return true_dps, np.cumsum(0.5 * (true_dps + np.r_[true_dps[0], true_dps[:-1]])) / RATE_HZ


@pytest.mark.parametrize("bias_dps", [0.0, 0.6, -1.2])
def test_a_start_in_motion_is_not_blind(bias_dps: float) -> None:
    """Two minutes without a rest, an hour after the run before; a start at rest would be off by half as much."""
    true_dps, true_deg = weaving(12_000)
    rate_dps = true_dps + bias_dps + 0.01 + noise(12_000, 2)
    remembering, _ = run(rate_dps, begun(RestlevelParams(), memory_of(bias_dps), 3600.0, None))
    assert abs(remembering - true_deg)[-1] < 2.5


def test_nothing_is_remembered_of_a_run_without_a_sure_rest() -> None:
    state = RestlevelState()
    run(weaving(6000)[0] + noise(6000, 3), state)
    assert learned(state, None, 0.0) is None


@pytest.mark.parametrize("age_s", [5.0, 3600.0, DAY_S, 30.0 * DAY_S])
def test_age_widens_what_is_remembered(age_s: float) -> None:
    state = begun(RestlevelParams(), memory_of(0.4), age_s, None)
    result = state.remembered[0]
    walked_var = min(0.0005**2 * age_s, 0.25) + 0.05**2 * min(1.0, age_s / 600.0)
    assert result.bias_dps == pytest.approx(0.4, abs=0.005)
    assert result.bias_var == pytest.approx(walked_var, rel=0.1, abs=3e-5)


def test_a_sensor_that_removes_its_own_bias_does_so_anew_at_each_start() -> None:
    """A bias of 0.002 deg/s is one of those; after a restart of the service alone it is still the same bias."""
    nulled, raw = memory_of(0.002), memory_of(0.4)
    weights = [
        remembered_weight(begun(RestlevelParams(), memory, age_s, None))
        for memory, age_s in ((nulled, 0.0), (nulled, 3600.0), (raw, 3600.0))
    ]
    assert weights[0] == pytest.approx(0.95, abs=0.01)
    assert weights[1] < 0.5
    assert weights[2] == pytest.approx(0.95, abs=0.01)


def test_a_device_that_starts_elsewhere_each_time_is_known_to_do_so() -> None:
    restless = equal = memory_of(0.4)
    for number in range(8):
        restless = memory_of(0.4 + 0.3 * (-1) ** number, restless, 3600.0)
        equal = memory_of(0.4, equal, 3600.0)
    assert restless.starts == equal.starts == 8
    assert restless.drift_factor > 10.0
    assert equal.drift_factor < 0.7
    state = begun(RestlevelParams(), restless, 3600.0, None)
    assert state.remembered[0].bias_var > 0.2**2


def test_starts_that_are_remembered_grow_older() -> None:
    """The start before is a day older in the memory of a run a day later."""
    first = memory_of(0.4)
    second = memory_of(0.4, first, DAY_S)
    assert second.first[1].age_s == pytest.approx(first.first[0].age_s + DAY_S)


def test_a_bias_is_remembered_with_its_standard_deviation() -> None:
    state = RestlevelState()
    run(0.4 + noise(2000, 1), state)
    memory = learned(state, None, 0.0)
    assert memory is not None
    assert memory.bias_sigma_dps == pytest.approx(state.sure.bias_var**0.5)
    assert 0.0005 < memory.bias_sigma_dps < 0.02


def test_a_memory_that_is_wrong_is_given_up_at_the_first_rest() -> None:
    """A part that was changed for another one, unseen."""
    state = begun(RestlevelParams(), memory_of(0.4), 60.0, None)
    _, bias_dps = run(-0.8 + noise(2000, 4), state)
    assert bias_dps[-1] == pytest.approx(-0.8, abs=0.02)


def test_remembered_noise_is_of_the_rate_at_which_samples_come() -> None:
    memory = memory_of(0.4)
    same, peer = (begun(RestlevelParams(), item, 0.0, None) for item in (memory, replace(memory, period_s=0.002)))
    moving = weaving(100)[0]
    run(moving, same)
    run(moving, peer)
    assert same.noise.is_walk_measured
    assert same.noise.sample_var < 0.1**2 < peer.noise.sample_var


def test_a_second_pass_of_the_thermal_chamber_begins_where_the_first_did(recordings: Recordings) -> None:
    session = load_session(recordings.path("temperature_sweep"))
    assert session.temp_c is not None
    c, first = coefficients(RestlevelParams()), RestlevelState()
    rows = list(zip(session.t_device_s.tolist(), session.rate_dps.tolist(), session.temp_c.tolist(), strict=True))
    for t_s, rate_dps, temp_c in rows:
        step(c, first, t_s, rate_dps, np.nan, temp_c)
    memory = learned(first, None, 0.0)
    assert memory is not None
    assert memory.bias_dps == pytest.approx(session.rate_dps[-20:].mean(), abs=0.02)
    second = begun(RestlevelParams(), memory, 5.0, rows[0][2])
    result = []
    for t_s, rate_dps, temp_c in rows[:60]:
        step(c, second, t_s, rate_dps, np.nan, temp_c)
        result.append(second.bias_dps)
    truth = session.rate_dps[:20].mean()
    assert abs(np.array(result)[:30] - truth).max() < 0.02


def test_a_memory_survives_its_file() -> None:
    """Value by value; what is none is said."""
    memory = memory_of(0.4)
    assert knowledge(json.loads(json.dumps(asdict(memory)))) == memory
    for wrong in ({"bias_dps": "much"}, {"bias_sigma_dps": -1.0}, {"bias_dps": float("nan")}, {"first": [3]}):
        with pytest.raises(ValueError, match=next(iter(wrong))):
            knowledge(asdict(memory) | wrong)


def test_the_compiled_filter_begins_with_it_too() -> None:
    true_dps, _ = weaving(6000)
    rate_dps = np.r_[true_dps, np.zeros(600), true_dps] + 0.4 + noise(12_600, 5)
    memory = memory_of(0.4)
    plain = run(rate_dps, begun(RestlevelParams(), memory, 60.0, None))
    dt_s = np.diff(np.arange(len(rate_dps)) / RATE_HZ, prepend=0.0)
    result, state = np.zeros((3, len(rate_dps))), begun(RestlevelParams(), memory, 60.0, None)
    nothing = np.empty(0)
    _follow(array_of(coefficients(RestlevelParams())), array_of(state), dt_s, rate_dps, nothing, nothing, result)
    np.testing.assert_array_equal(result[[0, 2]], plain)


def test_a_state_is_kept_by_what_differs_from_a_new_one() -> None:
    rate_dps = np.r_[np.zeros(800), weaving(2000)[0], np.zeros(800)] + 0.4 + noise(3600, 6)
    state = RestlevelState()
    assert saved(state, RestlevelState()) == {}
    c = coefficients(RestlevelParams())
    for n in range(1800):
        step(c, state, n / RATE_HZ, float(rate_dps[n]))
    table = json.loads(json.dumps(saved(state, RestlevelState())))
    again = RestlevelState()
    restore(again, table)
    assert again == state
    for wrong in ({"flight": 1.0}, {"yaw_deg": "far"}, {"noise": {"colour": 1}}, {"t_s": np.nan}, {"blocks": 10**400}):
        with pytest.raises(ValueError, match=r"has no|is '|is nan|is 10000"):
            restore(RestlevelState(), wrong)
    for of_another_kind in ({"blocks": True}, {"noise": {"has_steps": 1}}, {"blocks": 1.0}):
        with pytest.raises(ValueError, match=r"is (True|1|1\.0)$"):
            restore(RestlevelState(), of_another_kind)


def test_zeros_and_falses_that_are_no_defaults_are_kept() -> None:
    state = RestlevelState()
    state.noise.resolution_dps, state.noise.same_blocks = 0.0, 3
    state.witness.is_believed = False
    again = RestlevelState()
    restore(again, json.loads(json.dumps(saved(state, RestlevelState()))))
    assert again == state


def test_a_saved_state_has_the_keys_of_its_file_format() -> None:
    """Recordings keep some keys that are not the names of the fields."""
    table = {
        "block": {"turned_deg": 1.0},
        "noise": {"mute_blocks": 2},
        "turns": {"turned_deg": 3.0, "seen": 4},
        "witness": {"is_claiming": True, "doubt": 5.0, "alike": 6},
        "hypotheses": {"0": {"settled": {"bias_dps": 7.0}}},
    }
    state = RestlevelState()
    restore(state, table)
    turns, witness = state.turns, state.witness
    assert (state.block.angle_deg, state.noise.same_blocks, turns.angle_deg, turns.count) == (1.0, 2, 3.0, 4)
    assert (witness.is_reporting_rest, witness.contradictions, witness.agreeing_blocks) == (True, 5.0, 6)
    assert state.hypotheses[0].safe.bias_dps == 7.0
    assert saved(state, RestlevelState()) == table


def test_a_first_temperature_may_be_anything() -> None:
    statement = replace(memory_of(0.4), temp_c=25.0)
    nothing = begun(RestlevelParams(), statement, DAY_S, None)
    assert all(begun(RestlevelParams(), statement, DAY_S, temp_c) == nothing for temp_c in (1e300, -1e300, 400.0))
