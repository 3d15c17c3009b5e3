"""Rest: neither a turn nor fast shaking without a mean rate counts as rest."""

import numpy as np
import pytest

from gyrodrift.diagnose.features.regimes import regimes_of
from gyrodrift.diagnose.recording.motion import ReplayedMotion


def shaken(frequency_hz: float, amplitude_dps: float, rate_hz: float) -> ReplayedMotion:
    """Ten seconds of rest, ten of a swing, ten of rest."""
    t_s = np.arange(round(30.0 * rate_hz)) / rate_hz
    swings = (t_s > 10.0) & (t_s < 20.0)
    rate_dps = np.where(swings, amplitude_dps * np.sin(2.0 * np.pi * frequency_hz * t_s), 0.0)
    return ReplayedMotion(1.0 / rate_hz, np.cumsum(rate_dps) / rate_hz, rate_dps, np.full(len(t_s), 25.0), 0.0)


@pytest.mark.parametrize("seed", range(8))
def test_what_shakes_does_not_rest_nor_turn_steadily(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rate_hz = float(rng.choice([50.0, 100.0, 200.0, 400.0]))
    motion = shaken(rng.uniform(0.5, 12.0), rng.uniform(10.0, 60.0), rate_hz)
    regimes = regimes_of(motion, round(rate_hz))
    at_rest = regimes.at_rest
    t_s = np.arange(len(at_rest)) / rate_hz
    assert not at_rest[(t_s > 10.0) & (t_s < 20.0)].any()
    assert regimes.is_steady[(t_s > 10.5) & (t_s < 19.5)].mean() < 0.05
    assert at_rest[t_s < 8.5].all()
    assert at_rest[t_s > 21.5].all()
