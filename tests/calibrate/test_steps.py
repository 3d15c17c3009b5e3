"""The parts of a calibration: a rest, whole turns and their spread, bias against temperature; what each refuses."""

from dataclasses import replace
from math import nan

import numpy as np
import pytest
from support import near

from gyrodrift.calibrate.guide import CalibrationPlan, Guide, GuideStep, Key
from gyrodrift.calibrate.rest import rest_of
from gyrodrift.calibrate.scale import Turns, check_turns, checked_scales
from gyrodrift.calibrate.warming import line_of
from gyrodrift.values.arrays import Floats
from gyrodrift.values.calibration import Calibration
from gyrodrift.values.errors import CalibrationError
from gyrodrift.values.sample import Sample

RATE_HZ = 100.0
RNG = np.random.default_rng(7)


def samples_of(rates_dps: list[float] | Floats, temp_c: float | Floats = 25.0) -> list[Sample]:
    temps = np.broadcast_to(temp_c, len(rates_dps))
    return [
        Sample(i, i / RATE_HZ, i / RATE_HZ, float(dps), nan, float(temp))
        for i, (dps, temp) in enumerate(zip(rates_dps, temps, strict=True))
    ]


def at_rest(seconds: float, bias_dps: float = 0.3) -> Floats:
    return bias_dps + 0.035 * RNG.standard_normal(round(seconds * RATE_HZ))


def test_a_rest_tells_bias_and_noise() -> None:
    rest = rest_of(samples_of(at_rest(20.0)))
    assert rest.bias_dps == near(0.3, 4.0 * rest.bias_se_dps)
    assert rest.bias_se_dps == near(0.035 / 2000**0.5, 0.0005)
    assert rest.noise_dps_rthz == near(0.0035, 0.0002)
    assert rest.temp_c == 25.0


@pytest.mark.parametrize(
    ("rates_dps", "reason"),
    [
        (np.concatenate([at_rest(5.0), at_rest(1.0, 5.0), at_rest(4.0)]), "the device moved after 5.* s of rest"),
        (at_rest(10.0) + np.linspace(0.0, 2.0, 1000), "the device moved after .* of rest"),
        (
            at_rest(10.0) + 3.0 * np.sin(np.arange(1000)) * (np.arange(1000) // 100 == 7),
            "was shaken after 7.0 s of rest",
        ),
        (at_rest(10.0, 90.0), "the rate at rest is 90.0 deg/s, more than the bias of any gyro"),
        (at_rest(0.1), "10 samples during the rest"),
    ],
    ids=["a push", "a slow turn", "a knock", "a steady turn", "too short"],
)
def test_motion_at_rest_is_refused(rates_dps: Floats, reason: str) -> None:
    with pytest.raises(CalibrationError, match=reason):
        rest_of(samples_of(rates_dps))


@pytest.mark.parametrize(
    ("angle_deg", "turns", "reason"),
    [
        (2.0, 1, "the measured axis is not vertical"),
        (6.3, 1, "degrees and radians are mixed up"),
        (1442.0, 5, "nearer to 4 turns: count them again"),
        (180.5, 1, "a scale for another range"),
        (310.0, 1, "not a whole turn"),
        (-361.0, 1, "the sign of the other direction: was it counter-clockwise"),
        (379.0, 1, "earlier ones 360.0 deg: did it stop at the mark"),
    ],
)
def test_a_turn_that_cannot_be_is_refused(angle_deg: float, turns: int, reason: str) -> None:
    """Far from whole, of the other sign, or unlike those before."""
    before = [Turns(is_ccw, 1, angle) for is_ccw, angle in ((True, 360.0), (False, -362.0))]
    with pytest.raises(CalibrationError, match=reason):
        check_turns(Turns(is_ccw=True, turns=turns, angle_deg=angle_deg), before)


def test_the_spread_is_that_of_the_stops_at_the_mark() -> None:
    scales, stated = [], []
    for _ in range(300):
        stops = 0.5 * RNG.standard_normal(9)
        moves = 1.01 * np.diff(stops) + np.tile([363.6, -363.6], 4)
        result = checked_scales([Turns(angle > 0.0, 1, angle) for angle in moves.tolist()])
        scales.append(result.scale_ccw)
        stated.append(result.scale_ccw_se)
    assert np.mean(scales) == near(1.0 / 1.01, 4.0 * float(np.std(scales)) / 300**0.5)
    assert np.sqrt(np.mean(np.square(stated))) == near(float(np.std(scales)), 0.15 * float(np.std(scales)))


@pytest.mark.parametrize(
    ("angles_deg", "reason"),
    [
        ([360.0, -360.0, 361.0, -359.0], "too few turns: 2 counter-clockwise and 2 clockwise"),
        ([350.0, -366.0, 370.0, -350.0, 352.0, -371.0], "the turns differ too much"),
    ],
)
def test_a_calibration_that_says_nothing_is_refused(angles_deg: list[float], reason: str) -> None:
    with pytest.raises(CalibrationError, match=reason):
        checked_scales([Turns(angle > 0.0, 1, angle) for angle in angles_deg])


def test_a_line_of_bias_over_temperature_is_not_moved_by_odd_blocks() -> None:
    temps_c = np.linspace(22.0, 34.0, 60)
    biases_dps = 0.3 + 0.02 * (temps_c - 25.0) + 0.002 * RNG.standard_normal(60)
    biases_dps[::6] += 0.15
    line = line_of(temps_c, biases_dps)
    assert line.slope_dps_per_c == near(0.02, 4.0 * line.slope_se_dps_per_c)
    assert line.bias_dps == near(0.3 + 0.02 * (line.temp_c - 25.0), 0.002)
    assert (line.low_c, line.high_c) == (22.0, 34.0)


@pytest.mark.parametrize(
    ("span_c", "slope", "count", "reason"),
    [
        (2.0, 0.02, 60, "the temperature changed by only 2.0 °C"),
        (12.0, 0.0, 60, "does not follow the temperature along a line"),
        (12.0, 0.02, 20, "20 blocks of 5 s at rest"),
    ],
)
def test_a_temperature_run_that_shows_no_line_is_refused(span_c: float, slope: float, count: int, reason: str) -> None:
    temps_c = np.linspace(22.0, 22.0 + span_c, count)
    with pytest.raises(CalibrationError, match=reason):
        line_of(temps_c, 0.3 + slope * temps_c + 0.01 * RNG.standard_normal(count))


def by_hand(plan: CalibrationPlan) -> tuple[Guide, list[str]]:
    statement: list[str] = []
    guide = Guide(plan, statement.append)
    guide.begin()
    guide.press(Key.ENTER)
    return guide, statement


def test_a_temperature_run_gives_the_slope_of_the_bias() -> None:
    guide, statement = by_hand(CalibrationPlan(rest_s=5.0, warming_s=300.0))
    temps_c = np.concatenate([np.full(600, 20.0), np.linspace(20.0, 28.0, 30600)])
    noise_dps = at_rest(len(temps_c) / RATE_HZ)
    guide.take(samples_of(noise_dps + 0.01 * (temps_c - 20.0), temps_c))
    assert guide.step is GuideStep.TURNING
    assert guide.line_of_bias is not None
    assert guide.line_of_bias.slope_dps_per_c == near(0.01, 4.0 * guide.line_of_bias.slope_se_dps_per_c)
    assert any("deg/s per °C" in item for item in statement)


def test_by_hand_a_rest_in_which_it_moved_is_done_again() -> None:
    guide, statement = by_hand(CalibrationPlan(rest_s=5.0, warming_s=300.0))
    guide.take(samples_of(np.concatenate([at_rest(3.0), at_rest(3.0, 9.0)])))
    assert guide.line == ""
    assert "the device moved after" in statement[-2]
    guide.press(Key.ENTER)
    guide.take([sample._replace(temp_c=nan) for sample in samples_of(at_rest(6.0))])
    assert guide.step is GuideStep.TURNING
    assert any("sends no temperature" in item for item in statement)


def test_a_turn_is_taken_back_by_a_key() -> None:
    """Next comes the same direction, from the mark."""
    guide, statement = by_hand(CalibrationPlan(rest_s=5.0))
    ramp = np.concatenate([at_rest(7.0), 90.3 + at_rest(4.0, 0.0), at_rest(4.0)])
    guide.take(samples_of(ramp))
    guide.press(Key.ENTER)
    assert guide.turns[0].angle_deg == near(360.0, 0.5)
    guide.press(Key.UNDO)
    assert guide.turns == []
    assert guide.step is GuideStep.AT_MARK
    assert "counter-clockwise" in statement[-1]


def test_a_filter_that_runs_keeps_its_bias_under_a_new_calibration() -> None:
    old = Calibration("2026-01-01", scale_ccw=0.98, scale_cw=0.99, bias_dps=0.2)
    new = Calibration(
        "2026-02-01", sign=-1, scale_ccw=1.03, scale_cw=1.01, bias_dps=5.0, bias_dps_per_c=0.1, temp_c=20.0
    )
    for learnt_dps in (0.4, -0.3):
        measured_dps = old.measured_dps(learnt_dps, 23.0)
        assert old.rate_dps(measured_dps, 23.0) == near(learnt_dps)
        following = new.following(old, learnt_dps, 23.0)
        assert following.rate_dps(measured_dps, 23.0) == near(learnt_dps)
        assert replace(following, bias_dps=5.0) == new


@pytest.mark.promise("Clients of outputs")
@pytest.mark.parametrize("still_s", [0.0, 1.0, 2.0, 3.0, 8.0])
@pytest.mark.parametrize("rate_hz", [100.0, 200.0])
def test_a_mark_without_a_turn_is_refused(still_s: float, rate_hz: float) -> None:
    """A mark without a turn is refused, whenever the key is pressed."""
    guide, statement = by_hand(CalibrationPlan(rest_s=5.0))
    rates_dps = 0.3 + 0.035 * RNG.standard_normal(round((9.0 + still_s) * rate_hz))
    samples = [Sample(i, i / rate_hz, i / rate_hz, float(dps)) for i, dps in enumerate(rates_dps)]
    taken = 0
    while guide.step is not GuideStep.TURNING:
        guide.take(samples[taken : taken + 1])
        taken += 1
    pressed = taken + round(still_s * rate_hz)
    guide.take(samples[taken:pressed])
    guide.press(Key.ENTER)
    guide.take(samples[pressed:])
    assert guide.turns == []
    assert guide.step.value == "at the mark"
    assert statement[-2] == "Not accepted: the device was not turned since the last stop."


def test_a_rest_whose_time_stands_still_is_refused() -> None:
    samples = [sample._replace(t_device_s=1.0) for sample in samples_of(at_rest(1.0))]
    with pytest.raises(CalibrationError, match="stands still or goes back"):
        rest_of(samples)
