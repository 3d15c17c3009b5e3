"""At one speed, what errs once per turn is one effect, and at two it is two; a device that warms by itself likewise."""

from collections.abc import Sequence

import numpy as np
import pytest
from inference_support import response

from firmware_sim.effects.environment import sensor_temperature_c
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.regimes import Regimes, regimes_of
from gyrodrift.diagnose.inference.alternatives import Alternatives, Rival
from gyrodrift.diagnose.inference.indistinct import (
    AT_ONE_HEATING,
    AT_ONE_SPEED,
    Heating,
    is_one_heating,
    is_one_speed,
    tied_where_same,
)
from gyrodrift.diagnose.inference.surrogate import Cause
from gyrodrift.diagnose.recording.motion import ReplayedMotion

PERIOD_S, BLOCK = 0.01, 100
HEATED = ("temp_bias", "warmup")
RNG = np.random.default_rng(5)


def turning(*rates_dps: float) -> Regimes:
    """A rest of 10 s, then each rate for 20 s, not quite evenly."""
    rate_dps: Floats = np.repeat([0.0, *rates_dps], [1000, *[2000] * len(rates_dps)])
    rate_dps = rate_dps + np.where(rate_dps == 0.0, 0.0, RNG.normal(0.0, 0.3, len(rate_dps)))
    angle_deg = np.cumsum(rate_dps) * PERIOD_S
    return regimes_of(ReplayedMotion(PERIOD_S, angle_deg, rate_dps, np.full(len(rate_dps), 25.0), 0.0), BLOCK)


@pytest.mark.parametrize(
    ("sessions", "is_one"),
    [
        ([(20.0,), (20.0,)], True),
        ([(20.0, -20.0), (-21.0,)], True),
        ([(20.0, 50.0)], False),
        ([(20.0,), (50.0,)], False),
        ([()], False),
        ([(), (20.0,)], True),
    ],
)
def test_all_sessions_together_have_one_speed_or_more(sessions: Sequence[Sequence[float]], *, is_one: bool) -> None:
    assert is_one_speed([turning(*rates_dps) for rates_dps in sessions]) == is_one


def test_an_effect_once_per_turn_is_tied_with_the_other_that_was_tried() -> None:
    """However far behind; what is no such effect stays as it was."""
    rivals = (Rival("encoder_eccentricity", -9.0, is_out_of_catalogue=False), Rival("latency", -5.0, False))
    gravity, scale = (
        Alternatives(Cause(response(name, {"rate": 1.0}), 3), 50.0, rivals, np.zeros(8))
        for name in ("g_sensitivity", "scale_factor")
    )
    tried = ["g_sensitivity", "encoder_eccentricity", "scale_factor", "latency"]
    found = tied_where_same([gravity, scale], tried, AT_ONE_SPEED)
    assert found[0].tied_with == ("encoder_eccentricity",)
    assert [one.name for one in found[0].rivals] == ["encoder_eccentricity", "latency"]
    assert found[1].rivals == rivals
    assert tied_where_same([gravity], ["g_sensitivity"], AT_ONE_SPEED)[0].rivals == rivals


def warming(powered_s: float, air_c: Floats | float) -> Heating:
    """Four minutes in air of a temperature, from so long after power-on, by the simulator's own law."""
    powered_at_s: Floats = powered_s + np.arange(240, dtype=np.float64)
    air: Floats = np.full(240, 1.0) * air_c
    return Heating(powered_at_s, sensor_temperature_c(air, powered_at_s) + RNG.normal(0.0, 0.02, 240))


def test_a_device_that_warms_by_itself_knows_one_course_of_its_temperature() -> None:
    """From power-on and later on, in cold air and in warm; air that changes meanwhile is another course."""
    assert is_one_heating([warming(0.0, 20.0), warming(0.0, 23.0), warming(300.0, 21.0)])
    assert not is_one_heating([warming(0.0, 20.0), warming(0.0, np.linspace(20.0, 24.0, 240))])
    assert not is_one_heating([warming(5000.0, np.linspace(20.0, 30.0, 240))])


def test_a_bias_by_temperature_is_a_warm_up_there_and_a_warm_up_is_what_it_is() -> None:
    """A warm-up may be quicker than the temperature: then the likelihood has said so."""
    temp, warm = (Alternatives(Cause(response(name, {"time": 1.0}), 3), 50.0, (), np.zeros(8)) for name in HEATED)
    found = tied_where_same([temp, warm], HEATED, AT_ONE_HEATING)
    assert [one.tied_with for one in found] == [("warmup",), ()]
