"""A sensor that is tilted on its table: one axis reads the cosine; three axes and gravity show the tilt."""

from itertools import islice

import numpy as np
import pytest
from effects_bench import fitted, record, rig_of

from firmware_sim.effects.effect import Floats
from firmware_sim.effects.sensor_mount import Misalignment
from firmware_sim.measure import TriaxialBlock, measure
from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import Base, Rig, ThreeAxes

GRAVITY = 9.80665


@pytest.mark.parametrize("tilt_deg", [0.0, 4.0, 10.0, 60.0])
def test_a_single_axis_reads_the_cosine_of_the_tilt(tilt_deg: float) -> None:
    run = record(rig_of(Misalignment(tilt_deg=tilt_deg)), load_profile("identify"), 594.0)
    _, slope = fitted(run.error_dps, 1.0, run.true_dps)
    assert 1.0 + slope == pytest.approx(np.cos(np.deg2rad(tilt_deg)), abs=1e-5)


def read(*effects: Misalignment) -> tuple[Floats, Floats, Floats]:
    """Rates, deg/s, and force, m/s², of a quiet device with three axes, shape (n, 3), and the rate of its table."""
    axes = ThreeAxes(mps2_per_lsb=1e-3, accel_noise_mps2_rthz=0.0)
    base = Base(noise_dps_rthz=0.0, dps_per_lsb=1e-2, three_axes=axes)
    profile = load_profile("identify")
    (block,) = islice(measure(Rig(base=base, effects=effects), profile, 1, block_samples=20_000), 1)
    assert isinstance(block, TriaxialBlock)
    counts = np.column_stack([block.gyro_xy_raw, block.rate_raw]).astype(np.float64)
    force = block.accel_raw.astype(np.float64) * axes.mps2_per_lsb
    return counts * base.dps_per_lsb, force, profile.motion_at(block.seq / 100.0)[1]


@pytest.mark.parametrize("about_deg", [0.0, 90.0, -30.0])
def test_three_axes_share_turn_and_gravity_in_the_same_way(about_deg: float) -> None:
    rates, force, true_dps = read(Misalignment(tilt_deg=12.0, about_deg=about_deg))
    tilt, toward = np.deg2rad(12.0), np.deg2rad(about_deg + 90.0)
    up = np.array([np.sin(tilt) * np.cos(toward), np.sin(tilt) * np.sin(toward), np.cos(tilt)])
    assert np.allclose(rates, true_dps[:, None] * up, atol=0.0051)
    assert np.allclose(force, GRAVITY * up, atol=0.00051)


def test_without_a_tilt_three_axes_read_a_level_table() -> None:
    """An effect of size 0 changes no value."""
    for with_effect, without in zip(read(Misalignment(tilt_deg=0.0)), read(), strict=True):
        assert np.array_equal(with_effect, without)
