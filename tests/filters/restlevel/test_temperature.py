"""Bias against temperature: when a line is believed, what it is worth in motion and at a start, when it is given up."""

import numpy as np
import pytest
from recordings_support import Recordings

from gyrodrift.evaluation.auxiliary import Auxiliary
from gyrodrift.evaluation.kernels.restlevel import walk
from gyrodrift.filters.restlevel.bias_state import TempLine
from gyrodrift.filters.restlevel.memory import begun, learned
from gyrodrift.filters.restlevel.model import RestlevelParams, RestlevelState
from gyrodrift.filters.restlevel.step import coefficients, step
from gyrodrift.filters.restlevel.temperature import measure_level
from gyrodrift.session.files import load_session
from gyrodrift.values.arrays import Floats

pytestmark = pytest.mark.xdist_group("restlevel_kernel")

RATE_HZ = 50.0
SLOPE_DPS_C = 0.02
NOBODY = np.empty(0)


def warming(rests: int, last_s: float, seed: int = 1) -> tuple[Floats, Floats, Floats]:
    """True rate, bias and temperature: rests of 25 s that warm up by 2 °C each, turns of 5 s, and a long drive."""
    pieces = [np.r_[np.zeros(1250), 30.0 * np.sin(np.arange(250) / 20.0)] for _ in range(rests)]
    drive = np.arange(round(last_s * RATE_HZ)) / RATE_HZ
    true_dps: Floats = np.concatenate([*pieces, 40.0 * np.sin(drive) * (1.0 + 0.3 * np.sin(drive / 7.0))])
    temp_c: Floats = 20.0 + 2.0 * np.arange(len(true_dps), dtype=np.float64) / (30.0 * RATE_HZ)
    temp_c += np.random.default_rng(seed).normal(0.0, 0.05, len(temp_c))
    bias_dps: Floats = 0.3 + SLOPE_DPS_C * (temp_c - 20.0)
    return true_dps, bias_dps, temp_c


def measured(true_dps: Floats, bias_dps: Floats, seed: int = 1) -> Floats:
    return true_dps + bias_dps + np.random.default_rng(seed).normal(0.0, 0.05, len(true_dps))


def stepped(rate_dps: Floats, temp_c: Floats, state: RestlevelState | None = None) -> RestlevelState:
    c, s = coefficients(RestlevelParams()), state or RestlevelState()
    for n, (dps, warm_c) in enumerate(zip(rate_dps.tolist(), temp_c.tolist(), strict=True)):
        step(c, s, n / RATE_HZ, dps, np.nan, warm_c)
    return s


def test_a_drive_that_warms_up_is_corrected_on_its_way() -> None:
    """Three minutes without a rest in which the bias moves by 0.24 deg/s; half of that on the mean is 22 deg."""
    true_dps, bias_dps, temp_c = warming(8, 180.0)
    rate_dps = measured(true_dps, bias_dps)
    dt_s = np.r_[0.0, np.full(len(rate_dps) - 1, 1.0 / RATE_HZ)]
    truth = np.cumsum(0.5 * (true_dps + np.r_[0.0, true_dps[:-1]])) / RATE_HZ
    blind, *_ = walk(dt_s, rate_dps, RestlevelParams())
    warm, _, found_dps = walk(dt_s, rate_dps, RestlevelParams(), Auxiliary(NOBODY, temp_c))
    assert abs(blind - truth)[-1] > 15.0
    assert abs(warm - truth)[-1] < 5.0
    assert found_dps[-1] == pytest.approx(bias_dps[-1], abs=0.05)


def test_sigma_holds_a_bias_that_warms_up_before_any_line_is_known() -> None:
    """Three minutes of motion after one rest, in which 0.02 deg/s per °C make 22 deg; half a degree without."""
    true_dps, bias_dps, temp_c = warming(1, 180.0)
    dt_s = np.r_[0.0, np.full(len(true_dps) - 1, 1.0 / RATE_HZ)]
    truth = np.cumsum(0.5 * (true_dps + np.r_[0.0, true_dps[:-1]])) / RATE_HZ
    yaw_deg, sigma_deg, _ = walk(dt_s, measured(true_dps, bias_dps), RestlevelParams(), Auxiliary(NOBODY, temp_c))
    _, blind_deg, _ = walk(dt_s, measured(true_dps, bias_dps), RestlevelParams())
    assert abs(yaw_deg - truth)[-1] < 2.5 * sigma_deg[-1]
    assert sigma_deg[-1] > 1.5 * blind_deg[-1]


def test_the_status_says_what_is_known() -> None:
    """Measurements, slope and its standard deviation."""
    true_dps, bias_dps, temp_c = warming(8, 0.0)
    report = stepped(measured(true_dps, bias_dps), temp_c).temp_curve
    assert report is not None
    assert report["slope_dps_c"] == pytest.approx(SLOPE_DPS_C, abs=2.5 * report["slope_sigma_dps_c"])
    assert report["slope_sigma_dps_c"] < 0.004
    assert report["points"] >= 8
    assert RestlevelState().temp_curve is None


def test_a_line_is_as_certain_as_hysteresis_allows(recordings: Recordings) -> None:
    """The thermal chamber, whose bias changes by 0.6 deg/s over 90 °C on different ways up and down."""
    session = load_session(recordings.path("temperature_sweep"))
    assert session.temp_c is not None
    s = RestlevelState()
    samples = (session.t_device_s.tolist(), session.rate_dps.tolist(), session.temp_c.tolist())
    for t_s, dps, temp_c in zip(*samples, strict=True):
        step(coefficients(RestlevelParams()), s, t_s, dps, np.nan, temp_c)
    assert abs(s.line.slope_dps_c) < 0.02
    assert s.line.slope_var**0.5 < 0.002


def test_a_level_that_jumps_says_nothing_of_the_slope() -> None:
    """A part that was knocked: 0.5 deg/s from one rest to the next."""
    line = TempLine(temp_c=20.0)
    for number in range(10):
        line.temp_c = 20.0 + 2.0 * number
        measure_level(line, 0.3 + 0.02 * (line.temp_c - 20.0), 1e-6, 60.0 * number, 2.5e-7)
    slope_dps_c = line.slope_dps_c
    assert slope_dps_c == pytest.approx(0.02, abs=0.003)
    line.temp_c += 2.0
    measure_level(line, 1.2, 1e-6, 700.0, 2.5e-7)
    assert line.slope_dps_c == pytest.approx(slope_dps_c, abs=0.002)
    assert line.level_dps == pytest.approx(1.2, abs=0.01)


def test_a_remembered_line_says_where_the_bias_is_at_another_temperature() -> None:
    """The run before ended at 36 °C, this one begins at 26 °C, moving."""
    true_dps, bias_dps, temp_c = warming(8, 0.0)
    memory = learned(stepped(measured(true_dps, bias_dps), temp_c), None, 0.0)
    assert memory is not None
    state = begun(RestlevelParams(), memory, 60.0, 26.0)
    likeliest = max(state.remembered, key=lambda item: item.weight)
    assert likeliest.bias_dps == pytest.approx(0.3 + SLOPE_DPS_C * 6.0, abs=0.03)
    assert likeliest.bias_var < 0.15**2
    assert state.line.slope_dps_c == memory.slope_dps_c


def test_plain_and_compiled_agree() -> None:
    true_dps, bias_dps, temp_c = warming(8, 30.0)
    rate_dps = measured(np.r_[true_dps, true_dps[:4500]], np.r_[bias_dps, bias_dps[:4500] + 0.1])
    temp_c = np.r_[temp_c, temp_c[:4500]]
    t_s = np.arange(len(rate_dps)) / RATE_HZ
    yaw_deg, _, found_dps = walk(np.diff(t_s, prepend=0.0), rate_dps, RestlevelParams(), Auxiliary(NOBODY, temp_c))
    s = stepped(rate_dps, temp_c)
    assert (s.yaw_deg, s.bias_dps) == (yaw_deg[-1], found_dps[-1])
