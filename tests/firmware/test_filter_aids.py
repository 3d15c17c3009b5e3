"""Headings and turn rates of a second sensor: the filters in C against those in Python."""

from collections.abc import Callable, Iterator
from typing import Any

import c_attitude_support as three
import c_restlevel_support as one
import numpy as np
from c_filter_support import CFilters, assert_portions_change_nothing

from gyrodrift.filters.aids.reading import AidedFilter, AidReading
from gyrodrift.filters.attitude.aided import AIDED as AIDED_ATTITUDE
from gyrodrift.filters.attitude.model import AttitudeState
from gyrodrift.filters.attitude.step import coefficients as attitude_coefficients
from gyrodrift.filters.attitude.step import step as attitude_step
from gyrodrift.filters.restlevel.aided import AIDED as AIDED_RESTLEVEL
from gyrodrift.filters.restlevel.model import RestlevelParams, RestlevelState
from gyrodrift.filters.restlevel.step import coefficients, step
from gyrodrift.values.arrays import Floats

SECONDS, HZ, SEED = 120, 100, 1
HEADING, TURN_RATE = 10_000.0, -10_000.0
SIGMA_DEG, SIGMA_DPS = 2.0, 0.5


def turning(seed: int) -> tuple[Floats, Floats, Floats]:
    """Times, true rates that never rest, and commands with a heading or a turn rate every second, some wrong."""
    rng = np.random.default_rng(seed)
    t_s = np.arange(SECONDS * HZ) / HZ
    rate_dps = 15.0 * np.sin(t_s / 3.0) + 8.0 * np.sin(1.7 * t_s)
    yaw_deg = np.concatenate(([0.0], np.cumsum(0.5 * (rate_dps[1:] + rate_dps[:-1]) / HZ)))
    commands = np.full(len(t_s), np.nan)
    for second in range(1, SECONDS):
        i = second * HZ + second % 7
        is_wrong = rng.uniform() < 0.1
        heading_deg = rng.uniform(-180.0, 180.0) if is_wrong else yaw_deg[i] + rng.normal(0.0, SIGMA_DEG)
        commands[i] = HEADING + heading_deg if second % 3 else TURN_RATE + rate_dps[i] + rng.normal(0.0, SIGMA_DPS)
    return t_s, rate_dps, commands


def python_yaws(
    aided: AidedFilter, c: Any, s: Any, sample: Callable[[int], bool], commands: Floats
) -> Iterator[tuple[float, float]]:
    """Yaw and its sigma of the filter in Python after each sample."""
    waiting: tuple[float, bool] | None = None
    for i, command in enumerate(commands.tolist()):
        before_deg = s.yaw_deg
        sample(i)
        if waiting is not None:
            value, is_heading = waiting
            waiting = value + (s.yaw_deg - before_deg - s.correction_deg) * is_heading, is_heading
            if aided.has_block_ended(s):
                if aided.add_scale_error is not None:
                    aided.add_scale_error(c, s, 0.0)
                variance = SIGMA_DEG**2 if is_heading else SIGMA_DPS**2
                aided.take(c, s, AidReading(is_heading, waiting[0], variance, period_deg=360.0 * is_heading))
                waiting = None
        if command >= HEADING / 2.0:
            waiting = command - HEADING, True
        elif command <= TURN_RATE / 2.0:
            waiting = aided.rate_dps(s) - (command - TURN_RATE), False
        yield s.yaw_deg, s.yaw_sigma_deg


def assert_agrees(output: Any, python: list[tuple[float, float]], rate_dps: Floats, apart_deg: float) -> None:
    yaw_deg, sigma_deg = np.array(python).T
    assert np.abs(output.rows[:, 0] - yaw_deg).max() < apart_deg
    assert np.abs(output.rows[:, 1] - sigma_deg).max() < apart_deg
    true_deg = np.concatenate(([0.0], np.cumsum(0.5 * (rate_dps[1:] + rate_dps[:-1]) / HZ)))
    assert np.abs(yaw_deg - true_deg)[SECONDS * HZ // 2 :].mean() < SIGMA_DEG


def test_one_axis_takes_headings_and_turn_rates(c_filters: CFilters) -> None:
    t_s, rate_dps, commands = turning(SEED)
    inputs = one.samples(one.measured(np.random.default_rng(SEED), rate_dps))
    inputs[:, 3] = commands
    c, s = coefficients(RestlevelParams()), RestlevelState()
    python = python_yaws(AIDED_RESTLEVEL, c, s, lambda i: step(c, s, float(t_s[i]), float(inputs[i, 0])), commands)
    library = c_filters.get("filter_restlevel.c", "double")
    assert_agrees(library.run(t_s, inputs), list(python), rate_dps, 1e-9)
    assert_portions_change_nothing(library, t_s, inputs, "now and then", correction=10)


def test_three_axes_take_headings_and_turn_rates(c_filters: CFilters) -> None:
    """The rate of the heading is that of the attitude before or after the sample."""
    t_s, rate_dps, commands = turning(SEED)
    rng = np.random.default_rng(SEED)
    gyro_dps = rng.normal(0.0, 0.05, (len(t_s), 3)) + 0.2
    gyro_dps[:, 2] = one.measured(rng, rate_dps)
    accel_mps2 = rng.normal(0.0, 0.03, (len(t_s), 3)) + np.array((0.0, 0.0, 9.81))
    inputs = three.samples(gyro_dps, accel_mps2)
    inputs[:, three.COMMAND] = commands
    c, s = attitude_coefficients(RestlevelParams()), AttitudeState()

    def sample(i: int) -> bool:
        return attitude_step(c, s, float(t_s[i]), *inputs[i, : three.COMMAND].tolist())

    python = python_yaws(AIDED_ATTITUDE, c, s, sample, commands)
    library = c_filters.get("filter_attitude.c", "double")
    assert_agrees(library.run(t_s, inputs), list(python), rate_dps, 1e-3)
    assert_portions_change_nothing(library, t_s, inputs, "now and then", correction=21)
