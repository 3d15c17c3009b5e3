"""The attitude filter in C against the one in Python, sample by sample: 1e-9 deg in double."""

import shutil
import subprocess
from collections.abc import Callable
from dataclasses import replace
from math import inf, nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from attitude_support import remembering
from c_attitude_support import COMMAND, COUNTS, SIGMA, TEMPERATURE, TILT, YAW, in_python, samples, values_of
from c_filter_support import (
    INTERLEAVINGS,
    CFilter,
    CFilters,
    FilterOutput,
    assert_portions_change_nothing,
    words,
    write_header,
)
from c_restlevel_support import GAP, RESTARTED
from firmware_support import run
from hand_motion import hand_motion
from hypothesis import given
from hypothesis import strategies as st
from six_axis_motions import MOTIONS
from six_axis_support import record
from support import quick

from gyrodrift.filters.restlevel.model import RestlevelParams
from gyrodrift.values.arrays import Floats

DOUBLE_DEG = 1e-9
"""Largest yaw difference of double: numpy sums in another order."""

OUTPUT_ROUNDING = 1e-7
"""Likewise of the other outputs: near 0, the arc cosine of the tilt has half of the digits."""

FLOAT_DEG, FLOAT_SHARE = 0.005, 2e-3
"""Largest yaw difference of float, and likewise as a share of the yaw sigma.
Measured: benchmark/bench/test_attitude_accuracy.py."""

CORRECTION = 21
"""Column of the correction in the last sample."""

USUAL = RestlevelParams()
Session = tuple[Floats, Floats]
"""Times and inputs."""


def of_motion(name: str, seconds: float = 30.0) -> Session:
    """A recording of a motion with the errors of a random part."""
    recorded = record(name, 3, seconds)
    return recorded.t_s, samples(recorded.gyro_dps, recorded.accel_mps2)


def still_then(rates: Callable[[Floats], Floats], seconds: float = 40.0, bias_dps: float = 0.4) -> Session:
    """A level device at 100 Hz whose rates (n, 3) follow from its times."""
    rng, t_s = np.random.default_rng(7), np.arange(round(100 * seconds)) / 100.0
    gyro = rates(t_s) + rng.normal(0.0, 0.05, (len(t_s), 3)) + (bias_dps, -bias_dps, 0.5 * bias_dps)
    return t_s, samples(gyro, rng.normal((0.0, 0.0, 9.81), 0.02, (len(t_s), 3)))


def about_z(begin_s: float, end_s: float, rate_dps: float) -> Callable[[Floats], Floats]:
    """Rates of an even turn about the vertical."""
    return lambda t_s: np.where((t_s >= begin_s) & (t_s < end_s), rate_dps, 0.0)[:, None] * np.array((0.0, 0.0, 1.0))


def without_some_accelerations() -> Session:
    """Every second one, and none for ten seconds and at the start."""
    t_s, inputs = of_motion("hand_slow")
    inputs[::2, 3:6] = nan
    inputs[(t_s < 0.5) | ((t_s > 20.0) & (t_s < 30.0)), 3:6] = nan
    return t_s, inputs


def without_accelerations() -> Session:
    """None at all."""
    t_s, inputs = of_motion("turntable", 20.0)
    inputs[:, 3:6] = nan
    return t_s, inputs


def at_the_end_of_the_range() -> Session:
    """Accelerations beyond 2 g, equal in a row, and zeros."""
    t_s, inputs = of_motion("hand_fast")
    inputs[np.arange(len(t_s)) % 7 < 2, 3] = 19.6
    inputs[1500:1530, 3:6] = 0.0
    return t_s, inputs


def with_gaps_and_refused_samples() -> Session:
    """Lost samples, a pause, times that stand still or go back, and rates that are none."""
    t_s, inputs = of_motion("hand_slow")
    rng = np.random.default_rng(5)
    t_s = t_s + rng.uniform(0.0, 0.004, len(t_s))
    t_s[len(t_s) // 2 :] += 40.0
    kept = rng.random(len(t_s)) > 0.1
    t_s, inputs = t_s[kept], inputs[kept]
    t_s[500], t_s[700], t_s[800], t_s[801] = t_s[499], t_s[698], nan, inf
    inputs[900, 0], inputs[901, 2], inputs[902, 1] = nan, 1e5, -inf
    return t_s, inputs


def with_restarts() -> Session:
    """Gaps and restarts that are told, with clocks that go on and that begin again, and biases that change."""
    t_s, inputs = of_motion("hand_slow")
    inputs[[500, 900, 1400], COMMAND] = GAP, RESTARTED, RESTARTED
    inputs[901:, :3] += (0.3, -0.2, 0.5)
    t_s[1401:] -= t_s[1401]
    return t_s, inputs


def with_spikes() -> Session:
    """Rates of single samples that jump and return."""
    t_s, inputs = of_motion("arm")
    inputs[np.random.default_rng(6).random(len(t_s)) < 0.01, 1] = 1500.0
    return t_s, inputs


def with_a_rest_sensor() -> Session:
    """Often right, then silent, then wrong; the yaw sigma restarts now and then."""
    t_s, inputs = of_motion("car_with_stops", 60.0)
    inputs[:, 6] = np.abs(inputs[:, :3] - np.median(inputs[:, :3], axis=0)).max(axis=1) < 1.0
    inputs[(t_s > 15.0) & (t_s < 20.0), 6] = nan
    inputs[t_s > 45.0, 6] = 1.0
    inputs[400::900, COMMAND] = 1.0
    return t_s, inputs


def with_a_temperature() -> Session:
    """Rests and turns of a device that warms up; some temperatures are missing or none."""
    t_s, inputs = still_then(lambda t_s: np.where(t_s % 14.0 > 12.0, 40.0, 0.0)[:, None] * np.ones(3), 60.0)
    temp_c = 20.0 + 0.2 * t_s
    inputs[:, :3] += np.outer(temp_c - 20.0, (0.01, -0.02, 0.015))
    inputs[:, TEMPERATURE] = temp_c
    inputs[::3, TEMPERATURE], inputs[::50, TEMPERATURE] = nan, 1e9
    return t_s, inputs


def falling() -> Session:
    """A fall, and gravity in another axis without a turn."""
    t_s, inputs = still_then(about_z(5.0, 8.0, 30.0))
    inputs[1500:1550, 3:6] *= 0.01
    inputs[2500:, 3], inputs[2500:, 5] = 9.81, 0.0
    return t_s, inputs


def overhead() -> Session:
    """Turned upside down, then about the vertical."""
    t_s, inputs = still_then(about_z(20.0, 26.0, -30.0))
    tilt_deg = np.clip(t_s - 10.0, 0.0, 2.0) * 90.0
    inputs[(t_s >= 10.0) & (t_s < 12.0), 0] += 90.0
    inputs[:, 4], inputs[:, 5] = 9.81 * np.sin(np.radians(tilt_deg)), 9.81 * np.cos(np.radians(tilt_deg))
    return t_s, inputs


def in_a_hand() -> Session:
    motion = hand_motion(40.0, seed=2, bias_dps=(0.8, -0.5, 0.6))
    return motion.t_s, samples(motion.gyro_dps, motion.accel_mps2)


ODD = {
    function.__name__: function
    for function in (
        without_some_accelerations,
        without_accelerations,
        at_the_end_of_the_range,
        with_gaps_and_refused_samples,
        with_restarts,
        with_spikes,
        with_a_rest_sensor,
        with_a_temperature,
        falling,
        overhead,
        in_a_hand,
    )
}
DIVIDED = ("with_gaps_and_refused_samples", "with_restarts", "with_a_rest_sensor", "with_a_temperature", "overhead")
"""Recordings whose work is done in portions."""

EVEN: dict[str, Callable[[], Session]] = {
    "an even turn of 2 deg/s from the start": lambda: still_then(about_z(0.0, 25.0, 2.0)),
    "an even turn of 60 deg/s": lambda: still_then(about_z(8.0, 30.0, 60.0)),
    "many turns": lambda: still_then(about_z(5.0, 35.0, 900.0)),
    "a raw part": lambda: still_then(about_z(20.0, 22.0, 40.0), bias_dps=15.0),
}
SETTINGS = [
    replace(USUAL, window_s=0.1),
    replace(USUAL, window_s=3.0),
    replace(USUAL, turn_on_dps=0.0, walk_dps_rts=0.0),
    replace(USUAL, turn_on_dps=20.0, scale_percent=0.0),
    replace(USUAL, still_start=0.0, rest_share=0.0),
    replace(USUAL, rest_share=0.9, walk_dps_rts=1.0, quiet=20.0),
]


def program(c_filters: CFilters, real: str) -> CFilter:
    return c_filters.get("filter_attitude.c", real)


def assert_the_same(c_filters: CFilters, session: Session, params: RestlevelParams = USUAL) -> None:
    """In double within rounding, in float near; counts are equal in both."""
    t_s, inputs = session
    values, python = values_of(params), in_python(t_s, inputs, params)
    double, single = (program(c_filters, real).run(t_s, inputs, values) for real in ("double", "float"))
    far = np.abs(double.rows - python.rows)
    print(f"double {far[:, YAW].max():.1e} deg, float {np.abs(single.rows - double.rows)[:, YAW].max():.1e} deg")
    assert (double.taken == python.taken).all()
    assert far[:, YAW].max() < DOUBLE_DEG
    assert far.max() < OUTPUT_ROUNDING
    assert_near(single, double)


def assert_near(single: FilterOutput, double: FilterOutput) -> None:
    """Float decides as double, and its yaw and sigma are near."""
    allowed_deg = FLOAT_DEG + FLOAT_SHARE * double.rows[:, SIGMA]
    assert (single.taken == double.taken).all()
    assert np.array_equal(single.rows[:, COUNTS], double.rows[:, COUNTS])
    assert (np.abs(single.rows[:, YAW] - double.rows[:, YAW]) < allowed_deg).all()
    assert (np.abs(single.rows[:, SIGMA] - double.rows[:, SIGMA]) < allowed_deg).all()
    assert np.abs(single.rows[:, TILT] - double.rows[:, TILT]).max() < 0.01


@pytest.mark.parametrize("name", quick(MOTIONS, "hand_slow", "car_with_stops", "even_turn"))
def test_motions_give_the_same_estimates(c_filters: CFilters, name: str) -> None:
    assert_the_same(c_filters, of_motion(name))


@pytest.mark.parametrize("name", ODD)
def test_odd_recordings_give_the_same_estimates(c_filters: CFilters, name: str) -> None:
    """Missing and stuck accelerations, gaps, refused samples, spikes, rest sensors, falls."""
    assert_the_same(c_filters, ODD[name]())


@pytest.mark.parametrize("interleaving", INTERLEAVINGS)
@pytest.mark.parametrize(("name", "real"), [*((name, "float") for name in DIVIDED), ("with_restarts", "double")])
def test_work_in_portions_gives_the_same_bits(c_filters: CFilters, name: str, real: str, interleaving: str) -> None:
    """Whenever no work is left, all outputs are those of the filter that does the work at the end of a block."""
    assert_portions_change_nothing(program(c_filters, real), *ODD[name](), interleaving, CORRECTION)


@pytest.mark.parametrize("name", quick(EVEN, "many turns", "a raw part"))
def test_even_turns_give_the_same_estimates(c_filters: CFilters, name: str) -> None:
    assert_the_same(c_filters, EVEN[name]())


@pytest.mark.parametrize("params", quick(SETTINGS, SETTINGS[0], SETTINGS[2], SETTINGS[5]))
def test_other_parameters_give_the_same_estimates(c_filters: CFilters, params: RestlevelParams) -> None:
    """Short and long blocks, no and large priors."""
    assert_the_same(c_filters, of_motion("arm", 30.0), params)


@pytest.mark.parametrize(
    ("values", "name"),
    [
        ([0.4, -0.4, 0.2, 0.01, 0.01, 0.02, 300.0], "with_restarts"),
        ([0.4, -0.4, 0.2, 0.01, 0.01, 0.02, 3600.0], "with_a_temperature"),
        ([1.5, -0.6, 0.9, 0.002, 0.01, 0.0, 86400.0], "hand_fast"),
        ([0.001, 0.0, -0.002, 0.001, 0.001, 0.001, 3600.0], "hand_slow"),
    ],
)
def test_remembered_biases_agree_with_python(c_filters: CFilters, values: list[float], name: str) -> None:
    """Right ones and wrong ones, at rest and in motion."""
    t_s, inputs = ODD[name]() if name in ODD else of_motion(name)
    first = 300 if name in MOTIONS else 0
    t_s, inputs = t_s[first:], inputs[first:]
    python = in_python(t_s, inputs, state=remembering(values[:3], values[3:6], values[6]))
    double, single = (
        c_filters.get("filter_attitude.c", real, "-DREMEMBERED").run(t_s, inputs, values)
        for real in ("double", "float")
    )
    assert double.is_valid
    assert np.abs(double.rows - python.rows)[:, YAW].max() < DOUBLE_DEG
    assert np.abs(double.rows - python.rows).max() < OUTPUT_ROUNDING
    assert np.abs(single.rows - double.rows)[:, YAW].max() < 10.0 * FLOAT_DEG


def test_biases_that_are_none_are_not_remembered(c_filters: CFilters) -> None:
    t_s, inputs = of_motion("hand_slow", 3.0)
    library = c_filters.get("filter_attitude.c", "double", "-DREMEMBERED")
    usual = program(c_filters, "double").run(t_s, inputs)
    for values in ([nan, 0.1, 0.1, 0.1, 0.1, 0.1, 0.0], [0.1, 0.1, 0.1, 0.1, -1.0, 0.1, 0.0], [0.1] * 6 + [-1.0]):
        refused = library.run(t_s, inputs, values)
        assert not refused.is_valid
        assert np.array_equal(refused.rows, usual.rows)


odd_rates = st.one_of(st.floats(-300.0, 300.0), st.sampled_from([0.0, 2000.0, -9999.0, 1e300, inf, nan]))
odd_forces = st.one_of(st.floats(-20.0, 20.0), st.sampled_from([0.0, 9.81, 19.6, -157.0, 3900.0, 1e300, inf, nan]))
odd_steps_s = st.one_of(st.just(0.01), st.floats(1e-3, 10.0), st.sampled_from([1e5, 0.0, -1.0]))
moves = st.lists(
    st.tuples(
        odd_steps_s,
        st.tuples(*[odd_rates] * 3),
        st.one_of(st.just((0.0, 0.0, 9.81)), st.tuples(*[odd_forces] * 3)),
        st.sampled_from([nan, 0.0, 1.0]),
        st.integers(1, 100),
    ),
    min_size=1,
    max_size=6,
)


@given(moves=moves)
def test_any_samples_are_accepted_as_in_python_and_stay_finite(c_filters: CFilters, moves: list[Any]) -> None:
    """Float and double refuse the samples that Python refuses."""
    rows = [(step, *gyro, *accel, still, nan, nan) for step, gyro, accel, still, count in moves for _ in range(count)]
    table = np.array(rows, dtype=np.float64)
    t_s, inputs = np.cumsum(table[:, 0]), table[:, 1:]
    python = in_python(t_s, inputs)
    for real in ("double", "float"):
        output = program(c_filters, real).run(t_s, inputs)
        assert (output.taken == python.taken).all()
        assert np.isfinite(output.rows).all()
        assert np.array_equal(output.rows[:, 17:19], python.rows[:, 17:19])


@pytest.mark.parametrize("real", ["float", "double"])
def test_a_copy_of_the_state_saves_the_filter(c_filters: CFilters, real: str) -> None:
    t_s, inputs = of_motion("arm", 20.0)
    library = program(c_filters, real)
    saved = library.run(t_s, inputs, saved_after=777)
    assert np.array_equal(library.run(t_s, inputs).rows, saved.rows, equal_nan=True)


@pytest.mark.parametrize("real", ["float", "double"])
def test_the_clock_of_microseconds_wraps(c_filters: CFilters, real: str) -> None:
    t_s, inputs = of_motion("stick", 20.0)
    t_us = 2**32 - 5_000_000 + np.rint(t_s * 1e6)
    t_us[1000], t_us[1800] = t_us[999], t_us[1798]
    library = program(c_filters, real)
    by_clock, by_seconds = library.run(t_us % 2**32, inputs, is_us=True), library.run(t_us * 1e-6, inputs)
    assert (by_clock.taken == by_seconds.taken).all()
    assert by_clock.taken.sum() == len(t_us) - 2
    assert np.abs(by_clock.rows[:, YAW] - by_seconds.rows[:, YAW]).max() < (1e-6 if real == "double" else 0.005)


def test_bad_parameters_are_refused(c_filters: CFilters) -> None:
    """The filter then runs with the defaults."""
    t_s, inputs = of_motion("arm", 3.0)
    usual = program(c_filters, "double").run(t_s, inputs)
    refused = program(c_filters, "double").run(t_s, inputs, [*values_of(USUAL)[:-1], nan])
    assert usual.is_valid
    assert not refused.is_valid
    assert np.array_equal(refused.rows, usual.rows)


def test_fewer_hypotheses_save_memory_and_still_know_rests(c_filters: CFilters) -> None:
    """A trade for small boards: on a recording with rests the yaw stays within its sigma."""
    t_s, inputs = of_motion("arm")
    whole = program(c_filters, "float")
    small = c_filters.get("filter_attitude.c", "float", "-DGD_ATTITUDE_HYPOTHESES=2")
    usual, output = whole.run(t_s, inputs).rows, small.run(t_s, inputs).rows
    assert small.state_bytes < whole.state_bytes - 8000
    assert (np.abs(output[:, YAW] - usual[:, YAW]) < 0.01 + 2.0 * usual[:, SIGMA]).all()


def test_the_state_has_the_size_that_the_docs_tell(c_filters: CFilters) -> None:
    assert 15_600 < program(c_filters, "float").state_bytes < 15_750


@pytest.mark.parametrize("real", ["float", pytest.param("double", marks=pytest.mark.evaluation)])
def test_any_samples_and_parameters_leave_a_sound_state(tmp_path: Path, real: str) -> None:
    write_header(tmp_path)
    sanitizers = "-fsanitize=address,undefined,float-divide-by-zero"
    if shutil.which("cc") is None or not can_sanitize(tmp_path, sanitizers):
        pytest.skip("there is no C compiler with sanitizers")
    program = "./fuzz_attitude"
    flags = ("-std=c11", "-O0", "-g", sanitizers, "-fno-sanitize-recover=all")
    run("cc", *flags, *words("fuzz_attitude.c", real), "-o", program, "-lm", folder=tmp_path)
    assert run(program, "0", "30", folder=tmp_path) == ""


def can_sanitize(folder: Path, sanitizers: str) -> bool:
    """Whether the libraries of the sanitizers are installed."""
    (folder / "empty.c").write_text("int main(void) { return 0; }\n")
    built = subprocess.run(["cc", sanitizers, "empty.c", "-o", "empty"], cwd=folder, capture_output=True, check=False)
    return built.returncode == 0
