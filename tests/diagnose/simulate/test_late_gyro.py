"""A gyro that is far later than its rig says bends no motion."""

import numpy as np
import pytest

from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import Base, Rig, parse_effect
from gyrodrift.diagnose.recording.motion_posterior import motion_posterior_of
from gyrodrift.diagnose.recording.outliers import clean
from gyrodrift.diagnose.recording.recording import recording_of
from gyrodrift.diagnose.simulate.known_effects import gyro_model_of
from gyrodrift.diagnose.simulate.twin import rebuilt
from gyrodrift.simulation.sessions import Simulation
from gyrodrift.values.arrays import Floats

MINUTES = 2.0


@pytest.mark.parametrize("delay_ms", [40.0, 65.0, 150.0])
@pytest.mark.parametrize("counts", [1024, 36_000])
def test_the_motion_is_the_same_however_late_the_gyro_is(counts: int, delay_ms: float) -> None:
    """Rates as they come would be taken for those of another moment."""
    rig = Rig(base=Base(sample_rate_hz=100.0, encoder_cpr=counts))
    profile = load_profile("turntable")
    late = rig.model_copy(update={"effects": (parse_effect(f"latency:delay_ms={delay_ms:g}"),)})
    observed = clean(recording_of(Simulation(late, profile, 3, 0, MINUTES).whole()))
    t_s: Floats = np.arange(len(observed.rate_dps), dtype=np.float64) * observed.recording.period_s
    true_dps = profile.motion_at(t_s)[1]

    def off_dps(rate_dps: Floats) -> float:
        return float(np.sqrt(np.mean(np.square(rate_dps - true_dps)[50:-50])))

    result = off_dps(rebuilt(observed, rig).posterior.mean.rate_dps)
    expected = off_dps(rebuilt(observed, late).posterior.mean.rate_dps)
    believed = off_dps(motion_posterior_of(observed, gyro_model_of(rig)).mean.rate_dps)
    assert result < 1.5 * expected + 0.1
    assert result < 0.5 * believed
