"""The static curve: its parameters come back from the ten-minute protocol, played with the shipped noise."""

import numpy as np
import pytest
from effects_bench import FINE, Record, effect_of, fitted, profile_of, put_in, record, rig_of, sized

from firmware_sim.effects.effect import Effect
from firmware_sim.motion.profile import load_profile

COUNT_DPS = 0.00763
SLOW_RAMP = profile_of(
    {"kind": "ramp", "seconds": 1.0, "to_dps": -2.0}, {"kind": "ramp", "seconds": 100.0, "to_dps": 2.0}
)


def identified(effect: Effect | None) -> Record:
    return record(rig_of(effect), load_profile("identify"), 594.0)


@sized("scale_factor")
def test_the_gain_error_is_the_slope_of_the_error_over_the_rate(effect: Effect | None) -> None:
    run = identified(effect)
    _, slope = fitted(run.error_dps, 1.0, run.true_dps)
    assert 100.0 * slope == pytest.approx(put_in(effect, "error_percent"), abs=0.001)


@sized("scale_asymmetry")
def test_the_asymmetry_is_the_part_that_goes_with_the_size_of_the_rate(effect: Effect | None) -> None:
    run = identified(effect)
    _, gain, even = fitted(run.error_dps, 1.0, run.true_dps, np.abs(run.true_dps))
    assert 100.0 * even == pytest.approx(put_in(effect, "error_percent"), abs=0.002)
    assert 100.0 * gain == pytest.approx(0.0, abs=0.001)


@sized("nonlinearity")
def test_the_cubic_is_the_third_power_beside_the_gain(effect: Effect | None) -> None:
    run = identified(effect)
    *_, cubic = fitted(run.error_dps, 1.0, run.true_dps, (run.true_dps / 250.0) ** 3)
    assert 100.0 * cubic / 250.0 == pytest.approx(put_in(effect, "error_percent_fs"), abs=0.0025)


@sized("deadband")
def test_the_dead_band_ends_at_the_smallest_output_that_is_not_zero(effect: Effect | None) -> None:
    size_dps = np.abs(record(rig_of(effect), SLOW_RAMP, 101.0).rate_dps)
    smallest_dps = size_dps[size_dps > 0.0].min() - COUNT_DPS
    assert smallest_dps == pytest.approx(put_in(effect, "width_dps"), abs=2.0 * COUNT_DPS)


def test_outside_of_the_dead_band_the_rate_is_untouched() -> None:
    """Suppression subtracts nothing: without noise, what is left differs by half a count."""
    base = FINE.model_copy(update={"dps_per_lsb": 1e-4})
    run = record(rig_of(effect_of("deadband"), base=base), SLOW_RAMP, 101.0)
    outside = np.abs(run.true_dps) > 0.5001
    assert np.abs(run.error_dps[outside]).max() <= 0.51e-4
    assert not run.rate_dps[np.abs(run.true_dps) < 0.4999].any()


@sized("saturation")
def test_the_range_ends_at_the_output_that_comes_again_and_again(effect: Effect | None) -> None:
    rate_dps = identified(effect).rate_dps
    for extreme_dps in (rate_dps.max(), rate_dps.min()):
        ends = int(np.sum(rate_dps == extreme_dps))
        if effect is None:
            assert ends < 10
            assert abs(extreme_dps) > 179.0
        else:
            assert ends > 2000
            assert abs(extreme_dps) == pytest.approx(put_in(effect, "limit_dps"), abs=COUNT_DPS / 2.0 + 1e-9)


@sized("quantization")
def test_the_step_is_the_distance_of_the_levels(effect: Effect | None) -> None:
    levels_dps = np.unique(record(rig_of(effect), SLOW_RAMP, 101.0).rate_dps)
    step_dps = np.diff(levels_dps).mean()
    assert step_dps == pytest.approx(put_in(effect, "step_dps") or COUNT_DPS, abs=COUNT_DPS / 10.0)
