"""How late the gyro is, by the rates of gyro and encoder."""

import numpy as np
import pytest

from gyrodrift.diagnose.recording.delay import best_lag, smoothed_rates
from gyrodrift.values.arrays import Floats

PERIOD_S = 0.01
T_S: Floats = np.arange(6000, dtype=np.float64) * PERIOD_S


def angle_deg(t_s: Floats) -> Floats:
    """A motion without a period."""
    result: Floats = 40.0 * np.sin(1.3 * t_s) + 25.0 * np.sin(2.1 * t_s + 1.0) + 5.0 * np.sin(7.7 * t_s)
    return result


@pytest.mark.parametrize("delay_s", [-0.3, -0.004, 0.0, 0.013, 0.065, 1.2])
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("count_deg", [1e-3, 0.1, 0.7])
def test_the_delay_is_found_to_a_fraction_of_a_sample(delay_s: float, sign: float, count_deg: float) -> None:
    rng = np.random.default_rng(5)
    rate_dps = sign * np.gradient(angle_deg(T_S - delay_s), PERIOD_S) + rng.normal(0.0, 0.2, len(T_S))
    counted_deg = np.rint(angle_deg(T_S) / count_deg) * count_deg
    lag = best_lag(smoothed_rates(rate_dps, counted_deg, count_deg, PERIOD_S), PERIOD_S)
    assert lag.delay * PERIOD_S == pytest.approx(delay_s, abs=0.002)
    assert lag.samples == pytest.approx(lag.delay, abs=1.0)
    assert np.sign(lag.correlation) == sign


def test_what_never_moves_has_no_delay() -> None:
    still = np.zeros(1000)
    assert best_lag(smoothed_rates(still, still, 0.1, PERIOD_S), PERIOD_S) == (0, 0.0, 0.0)
