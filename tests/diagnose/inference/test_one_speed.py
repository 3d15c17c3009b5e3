"""At one speed, what errs once per turn is one effect; at two it is two."""

from collections.abc import Sequence

import numpy as np
import pytest
from inference_support import response

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.regimes import Regimes, regimes_of
from gyrodrift.diagnose.inference.alternatives import Alternatives, Rival
from gyrodrift.diagnose.inference.one_speed import is_one_speed, tied_at_one_speed
from gyrodrift.diagnose.inference.surrogate import Cause
from gyrodrift.diagnose.recording.motion import ReplayedMotion

PERIOD_S, BLOCK = 0.01, 100
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
    found = tied_at_one_speed([gravity, scale], ["g_sensitivity", "encoder_eccentricity", "scale_factor", "latency"])
    assert found[0].tied_with == ("encoder_eccentricity",)
    assert [one.name for one in found[0].rivals] == ["encoder_eccentricity", "latency"]
    assert found[1].rivals == rivals
    assert tied_at_one_speed([gravity], ["g_sensitivity"])[0].rivals == rivals
