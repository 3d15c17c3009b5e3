"""Restlevel in C against restlevel in Python, sample by sample: the same bits in double, 0.01 deg an hour in float."""

from math import inf, nan

import numpy as np
import pytest
from c_attitude_support import samples as inertial
from c_filter_support import INTERLEAVINGS, CFilter, CFilters, FilterOutput, assert_portions_change_nothing
from c_restlevel_sessions import SESSIONS, plain, with_temperature_and_rest_sensor
from c_restlevel_support import BIAS, SIGMA, YAW, in_python, samples, values_of
from hypothesis import given
from hypothesis import strategies as st
from recordings_support import Recordings, packed_names
from support import quick

from gyrodrift.filters.restlevel.bias_state import RecalledNoise
from gyrodrift.filters.restlevel.memory import RestlevelMemory, begun
from gyrodrift.filters.restlevel.model import RestlevelParams
from gyrodrift.session.files import load_session
from gyrodrift.values.arrays import Floats

FLOAT_DEG_H = 0.01
"""Largest yaw difference of a float, deg for each hour begun."""

CORRECTION = 10
"""Column of the correction in the last sample."""

FUSED_DEG = 1e-9
"""Largest difference by fused operations in double, deg."""


@pytest.fixture(scope="session")
def double(c_filters: CFilters) -> CFilter:
    return c_filters.get("filter_restlevel.c", "double")


@pytest.fixture(scope="session")
def single(c_filters: CFilters) -> CFilter:
    return c_filters.get("filter_restlevel.c", "float")


def assert_same_bits(output: FilterOutput, python: FilterOutput) -> None:
    assert output.is_valid
    assert (output.taken == python.taken).all()
    first = np.argmax((output.rows != python.rows).any(axis=1))
    assert np.array_equal(output.rows, python.rows), (first, output.rows[first], python.rows[first])


def assert_close(output: FilterOutput, python: FilterOutput, t_s: Floats) -> None:
    """Yaw within the limit, or what a float of that size resolves.

    A decision at a gate may fall the other way by the last digit, and then yaw differs by a small share of its sigma.
    """
    hours = max(1.0, np.ptp(t_s) / 3600.0)
    resolution_deg = np.spacing(np.abs(python.rows[:, YAW]).astype(np.float32))
    apart_deg = np.abs(output.rows[:, YAW] - python.rows[:, YAW])
    print(f"{apart_deg.max():.2g} deg at up to {np.abs(python.rows[:, YAW]).max():.0f} deg")
    assert (output.taken == python.taken).all()
    assert (apart_deg < FLOAT_DEG_H * hours + resolution_deg + 0.05 * python.rows[:, SIGMA]).all()


@pytest.mark.parametrize("name", packed_names())
def test_recordings_agree_with_python(double: CFilter, single: CFilter, recordings: Recordings, name: str) -> None:
    """Every output after every sample in double; yaw in float."""
    session = load_session(recordings.path(name))
    t_s, inputs = session.t_device_s, samples(session.rate_dps, temp_c=session.temp_c)
    python = in_python(t_s, inputs)
    assert_same_bits(double.run(t_s, inputs), python)
    assert_close(single.run(t_s, inputs), python, t_s)


@pytest.mark.parametrize("name", SESSIONS)
def test_simulated_sessions_give_the_same_bits_in_double(double: CFilter, name: str) -> None:
    """Slow and fast sensors, gaps, steps, hanging sensors, a rest sensor and temperature."""
    t_s, inputs = SESSIONS[name]()
    assert_same_bits(double.run(t_s, inputs), in_python(t_s, inputs))


@pytest.mark.parametrize("name", SESSIONS)
def test_simulated_sessions_give_the_same_yaw_in_float(double: CFilter, single: CFilter, name: str) -> None:
    """Against double, which is Python by the test above."""
    t_s, inputs = SESSIONS[name]()
    if name == "huge":
        assert np.isfinite(single.run(t_s, inputs).rows).all()
    else:
        assert_close(single.run(t_s, inputs), double.run(t_s, inputs), t_s)


@pytest.mark.parametrize("turn_dps", quick((1.0, 60.0, 900.0), 900.0))
def test_an_hour_in_float_keeps_yaw(double: CFilter, single: CFilter, turn_dps: float) -> None:
    """Rests and turns, up to hundreds of thousands of degrees."""
    t_s, inputs = plain(50.0, 3600.0, turn_dps)
    assert_close(single.run(t_s, inputs), double.run(t_s, inputs), t_s)


@pytest.mark.parametrize("damaged_dps", [1e12, -1e9])
def test_a_float_goes_on_after_damaged_rates(single: CFilter, damaged_dps: float) -> None:
    t_s, inputs = plain(100.0, 120.0)
    inputs[3000:3060, 0] = damaged_dps
    inputs[-1500:, 0] = inputs[:1500, 0]
    rows = single.run(t_s, inputs).rows
    assert np.isfinite(rows).all()
    assert abs(rows[-1, BIAS] - inputs[:1500, 0].mean()) < 0.05


@pytest.mark.parametrize("name", quick(("50 Hz", "temperature and rest sensor", "turning on and on"), "50 Hz"))
def test_fused_operations_change_the_last_digits_alone(c_filters: CFilters, double: CFilter, name: str) -> None:
    """A compiler for a processor that has them may use them."""
    t_s, inputs = SESSIONS[name]()
    fused = c_filters.get("filter_restlevel.c", "double", "-O3", "-march=native", "-ffp-contract=fast")
    assert np.abs(fused.run(t_s, inputs).rows[:, :3] - double.run(t_s, inputs).rows[:, :3]).max() < FUSED_DEG


rates = st.one_of(st.floats(-2.0, 2.0), st.sampled_from([0.0, -0.0, nan, inf, -inf, 300.0, -300.0, 1e9, 1.1e12]))
steps_s = st.one_of(st.floats(1e-4, 0.1), st.sampled_from([0.01, 0.01, 0.01, 0.0, -0.05, 5.0, 1e6, 1e-13, nan, inf]))
words = st.sampled_from([nan, 1.0, 1.0, 1.0, 0.0, 0.5, -1.0])
temps_c = st.one_of(st.floats(15.0, 60.0), st.sampled_from([nan, inf, -1e9, 1e9]))
commands = st.sampled_from([0.0] * 20 + [1.0, 2.0, 3.0])
settings = st.builds(
    RestlevelParams,
    window_s=st.floats(0.01, 0.5),
    quiet=st.floats(0.1, 50.0),
    turn_on_dps=st.one_of(st.floats(0.001, 50.0), st.just(0.0)),
    walk_dps_rts=st.floats(0.0, 0.1),
    drift_dps_s=st.floats(0.0, 0.1),
    still_start=st.floats(0.0, 0.999),
    rest_share=st.floats(0.0, 0.999),
    scale_percent=st.floats(0.0, 10.0),
)
periods = st.tuples(steps_s, rates, words, temps_c, commands, st.integers(1, 80))


@given(params=settings, stream=st.lists(periods, min_size=1, max_size=20), seed=st.integers(0, 9))
def test_any_samples_give_the_same_bits(
    double: CFilter, single: CFilter, params: RestlevelParams, stream: list[tuple[float, ...]], seed: int
) -> None:
    """Values that a sensor holds for a while, damaged times and rates included, with what is refused."""
    steps, rate_dps, still, temp_c, commanded = (
        np.repeat([period[column] for period in stream], [int(period[5]) for period in stream]) for column in range(5)
    )
    rng = np.random.default_rng(seed)
    t_s = np.where(np.isfinite(steps), np.cumsum(np.nan_to_num(steps, posinf=0.0)), steps)
    inputs = samples(rate_dps + rng.choice([0.0, 0.05]) * rng.normal(size=len(t_s)), still, temp_c)
    inputs[:, 3] = commanded
    python = in_python(t_s, inputs, params)
    assert_same_bits(double.run(t_s, inputs, values_of(params)), python)
    output = single.run(t_s, inputs, values_of(params))
    assert (output.taken == python.taken).all()
    assert np.isfinite(output.rows).all()


@pytest.mark.parametrize("real", ["float", "double"])
@pytest.mark.parametrize("saved_after", [0, 1234, 6000])
def test_a_copy_of_the_state_saves_the_filter(c_filters: CFilters, real: str, saved_after: int) -> None:
    t_s, inputs = with_temperature_and_rest_sensor()
    library = c_filters.get("filter_restlevel.c", real)
    usual, restored = library.run(t_s, inputs), library.run(t_s, inputs, saved_after=saved_after)
    assert np.array_equal(usual.rows, restored.rows)


@pytest.mark.parametrize("name", ["50 Hz", "stuck", "running motor"])
def test_without_auxiliary_inputs_nothing_changes(c_filters: CFilters, double: CFilter, name: str) -> None:
    """A board without rest sensor and thermometer may leave out their code."""
    t_s, inputs = SESSIONS[name]()
    library = c_filters.get("filter_restlevel_alone.c", "double", "-DGD_RESTLEVEL_AUXILIARY=0")
    alone = library.run(t_s, inputs[:, 0])
    assert np.array_equal(alone.rows[:, :6], double.run(t_s, inputs).rows[:, :6])
    assert library.state_bytes < double.state_bytes


@pytest.mark.parametrize(
    ("bias_dps", "sigma_dps", "age_s"),
    [(0.31, 0.01, 0.0), (-2.0, 0.002, 300.0), (0.0, 0.02, 86400.0), (0.31, 0.0, 1e9)],
)
def test_a_remembered_bias_agrees_with_python(
    c_filters: CFilters, bias_dps: float, sigma_dps: float, age_s: float
) -> None:
    """A board keeps the last bias over a reset; the noise it sees again."""
    t_s, inputs = plain(50.0, 120.0)
    expected = RestlevelMemory(bias_dps, sigma_dps, None, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0)
    state = begun(RestlevelParams(), expected, age_s, None)
    state.recalled = RecalledNoise()
    python = in_python(t_s[500:], inputs[500:], state=state)
    for real, limit_deg in (("double", 1e-9), ("float", FLOAT_DEG_H)):
        library = c_filters.get("filter_restlevel_alone.c", real, "-DREMEMBERED")
        output = library.run(t_s[500:], inputs[500:, 0], [bias_dps, sigma_dps, age_s])
        assert output.is_valid
        assert np.abs(output.rows[:, :6] - python.rows[:, :6]).max() < limit_deg


@pytest.mark.parametrize(
    "values", [[nan, 0.1, 0.0], [0.1, -1.0, 0.0], [0.1, inf, 0.0], [0.1, 0.1, -1.0], [2e5, 0.1, 1.0]]
)
def test_a_bias_that_is_none_is_not_remembered(c_filters: CFilters, single: CFilter, values: list[float]) -> None:
    """The filter then begins as a new one."""
    t_s, inputs = plain(50.0, 20.0)
    refused = c_filters.get("filter_restlevel_alone.c", "float", "-DREMEMBERED").run(t_s, inputs[:, 0], values)
    assert not refused.is_valid
    assert np.array_equal(refused.rows, single.run(t_s, inputs).rows[:, :8])


def test_the_clock_of_microseconds_gives_the_same_yaw(double: CFilter, single: CFilter) -> None:
    t_s, inputs = plain(200.0, 120.0)
    late_us = np.random.default_rng(7).uniform(0.0, 400.0, len(t_s))  # else the last digit decides where a block ends
    t_us = 2.0**32 - 30e6 + np.rint(t_s * 1e6 + late_us)
    t_us[5000] = t_us[4999]
    python = in_python(t_us * 1e-6, inputs)
    for library in (double, single):
        output = library.run(t_us % 2.0**32, inputs, is_us=True)
        assert (output.taken == python.taken).all()
        assert output.taken.sum() == len(t_us) - 1
        assert np.abs(output.rows[:, YAW] - python.rows[:, YAW]).max() < 1e-3
        assert np.allclose(output.rows[:, SIGMA], python.rows[:, SIGMA], rtol=1e-3, atol=1e-4)


def test_parameters_out_of_bounds_are_refused(double: CFilter) -> None:
    """The filter then runs with the defaults."""
    t_s, inputs = plain(50.0, 20.0)
    usual, good = double.run(t_s, inputs), values_of(RestlevelParams())
    for index, bad in [(0, 0.0), (1, 101.0), (2, -1.0), (3, nan), (4, 10.5), (5, 1.0), (6, -0.1), (7, inf)]:
        refused = double.run(t_s, inputs, [*good[:index], bad, *good[index + 1 :]])
        assert not refused.is_valid
        assert np.array_equal(refused.rows, usual.rows)
    assert double.run(t_s, inputs, good).is_valid


@pytest.mark.parametrize("hypotheses", [2, 8, *(pytest.param(n, marks=pytest.mark.evaluation) for n in (3, 4, 5))])
def test_any_number_of_hypotheses_runs(c_filters: CFilters, hypotheses: int) -> None:
    """Two to eight; fewer may cost accuracy, and never more than memory."""
    t_s, inputs = plain(100.0, 300.0)
    library = c_filters.get("filter_restlevel.c", "float", f"-DGD_RESTLEVEL_HYPOTHESES={hypotheses}")
    rows = library.run(t_s, inputs).rows
    assert np.isfinite(rows).all()
    assert (rows[:, SIGMA] >= 0.0).all()


PAUSES = {"40 minutes": 2400.0, "two hours": 7200.0, "the clock begins again": -25.0}


def with_a_pause(t_s: Floats, pause_s: float) -> Floats:
    """Stamps of the 32-bit clock, in us, with a pause in the middle."""
    t_us = np.rint(t_s * 1e6) + np.where(t_s >= t_s[len(t_s) // 2], pause_s * 1e6, 0.0)
    return np.asarray(t_us % 2.0**32)


@pytest.mark.parametrize("name", ["hdr", "restlevel", "attitude"])
@pytest.mark.parametrize("pause_s", PAUSES.values(), ids=PAUSES)
def test_a_pause_of_any_length_refuses_one_sample(c_filters: CFilters, name: str, pause_s: float) -> None:
    """Yaw is held over it, and its sigma says what may have happened."""
    t_s, library = np.arange(6000) / 100.0, c_filters.get(f"filter_{name}.c", "float")
    inputs = inputs_at_rest(name, len(t_s))
    output = library.run(with_a_pause(t_s, pause_s), inputs, is_us=True)
    assert output.taken.sum() >= len(t_s) - 1
    assert np.abs(np.diff(output.rows[2900:3100, YAW])).max() < 0.1
    if name != "hdr":
        assert output.rows[2999, SIGMA] < 5.0
        assert output.rows[3001, SIGMA] > 50.0


@pytest.mark.parametrize("name", ["hdr", "restlevel", "attitude"])
@pytest.mark.parametrize("off_s", [300.0, -300.0, 3000.0])
def test_one_bad_stamp_costs_one_sample(c_filters: CFilters, name: str, off_s: float) -> None:
    t_s, library = np.arange(6000) / 100.0, c_filters.get(f"filter_{name}.c", "float")
    inputs, t_us = inputs_at_rest(name, len(t_s)), 1e9 + np.rint(t_s * 1e6)
    usual = library.run(t_us, inputs, is_us=True)
    t_us[3000] += off_s * 1e6
    output = library.run(t_us % 2.0**32, inputs, is_us=True)
    assert output.taken.sum() >= len(t_s) - 1
    assert np.abs(output.rows[-1, YAW] - usual.rows[-1, YAW]) < 0.1
    assert name == "hdr" or output.rows[-1, SIGMA] < usual.rows[-1, SIGMA] + 0.1


def inputs_at_rest(name: str, count: int) -> Floats:
    """Inputs of a filter at rest: a bias of 0.3 deg/s and noise."""
    noise = np.random.default_rng(8).normal(0.0, 0.05, (count, 6))
    if name == "hdr":
        return np.asarray(0.3 + noise[:, 0])
    if name == "restlevel":
        return samples(0.3 + noise[:, 0])
    return inertial(0.3 + noise[:, :3], noise[:, 3:] + (0.0, 0.0, 9.81))


@pytest.mark.parametrize("interleaving", INTERLEAVINGS)
@pytest.mark.parametrize("real", ["float", "double"])
@pytest.mark.parametrize("session", ["50 Hz", "restarts", "temperature and rest sensor", "zeroed", "huge"])
def test_work_in_portions_gives_the_same_bits(c_filters: CFilters, session: str, real: str, interleaving: str) -> None:
    """Whenever no work is left, all outputs are those of the filter that does the work at the end of a block."""
    assert_portions_change_nothing(
        c_filters.get("filter_restlevel.c", real), *SESSIONS[session](), interleaving, CORRECTION
    )
