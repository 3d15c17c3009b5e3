"""A device with three axes: six channels, effects on vectors, and the device with one axis inside it."""

from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import Floats
from firmware_sim.effects.triaxial.catalogue import TRIAXIAL
from firmware_sim.faults.catalogue import faulty_blocks, parse_fault
from firmware_sim.measure import ACCEL_MISSING, COUNTS_MAX, StillWord, TriaxialBlock, joined, measure
from firmware_sim.motion.attitude.profile import AttitudeProfile
from firmware_sim.motion.profile import config_folder, load_motion, load_profile
from firmware_sim.rig import Base, Rig, ThreeAxes, load_rig, parse_effect, with_axes, with_effects
from firmware_sim.yaml_file import FileError
from gyrodrift.simulation.sessions import rig_yaml

QUIET = ThreeAxes(mps2_per_lsb=1e-3, accel_noise_mps2_rthz=0.0)
BASE = Base(noise_dps_rthz=0.0, dps_per_lsb=1e-2, three_axes=QUIET)
ROUNDING_DPS, ROUNDING_MPS2 = 0.0051, 0.00051


def rig_of(*effects: str, **axes: Any) -> Rig:
    """Quiet rig with three axes and some effects, as on a command line."""
    base = BASE.model_copy(update={"three_axes": QUIET.model_copy(update=axes)})
    return with_effects(Rig(base=base), [parse_effect(text) for text in effects])


def played(rig: Rig, profile: str = "hand", samples: int = 6000, seed: int = 0, size: int = 4096) -> TriaxialBlock:
    """First measurements of a session."""
    blocks = list(islice(measure(rig, load_motion(profile), seed, block_samples=size), -(-samples // size)))
    whole = blocks[0]
    for block in blocks[1:]:
        whole = joined(whole, block)
    whole = whole.only(whole.seq < samples)
    assert isinstance(whole, TriaxialBlock)
    return whole


def values_of(block: TriaxialBlock, rig: Rig) -> tuple[Floats, Floats]:
    """Rates, deg/s, and accelerations, m/s², shape (n, 3)."""
    axes = rig.base.three_axes
    assert axes is not None
    counts = np.column_stack([block.gyro_xy_raw, block.rate_raw]).astype(np.float64)
    return counts * rig.base.dps_per_lsb, block.accel_raw.astype(np.float64) * axes.mps2_per_lsb


def measured(*effects: str, **axes: Any) -> tuple[Floats, Floats, Floats, Floats]:
    """Rates and accelerations of a hand with the effects, and the true ones."""
    rig = rig_of(*effects, **axes)
    block = played(rig)
    truth = load_motion("hand")
    assert isinstance(truth, AttitudeProfile)
    motion = truth.kinematics_at(block.seq / 100.0)
    gravity = QUIET.model_copy(update=axes).gravity_mps2
    return *values_of(block, rig), motion.rates_dps, motion.specific_force_mps2(gravity)


def test_a_device_without_errors_reads_the_motion() -> None:
    rates, accel, true_rates, true_force = measured(gravity_mps2=9.78)
    assert np.abs(rates - true_rates).max() < ROUNDING_DPS
    assert np.abs(accel - true_force).max() < ROUNDING_MPS2
    assert np.abs(rates).max(axis=0).min() > 50.0


@pytest.mark.parametrize("name", [None, *CATALOGUE])
def test_on_a_level_table_the_z_axis_is_the_device_with_one_axis(name: str | None) -> None:
    """Bit for bit, with any effect; all else is the same too."""
    rig = load_rig(None) if name is None else with_effects(load_rig(None), [parse_effect(name)])
    alone = next(measure(rig, load_profile("turntable"), 5))
    whole = next(measure(with_axes(rig, 3), load_profile("turntable"), 5))
    for column in alone.__slots__:
        assert np.array_equal(getattr(alone, column), getattr(whole, column)), column


def test_axes_have_noise_and_bias_of_their_own() -> None:
    axes = ThreeAxes(gyro_bias_x_dps=0.5, gyro_bias_y_dps=-0.7, mps2_per_lsb=1e-3, accel_noise_mps2_rthz=0.003)
    rig = Rig(base=Base(noise_dps_rthz=0.005, dps_per_lsb=1e-3, bias_dps=0.2, three_axes=axes))
    rates, accel = values_of(played(rig, "rest", 40000), rig)
    assert rates.mean(axis=0) == pytest.approx([0.5, -0.7, 0.2], abs=0.002)
    assert rates.std(axis=0) == pytest.approx([0.05] * 3, rel=0.02)
    assert accel.std(axis=0) == pytest.approx([0.03] * 3, rel=0.02)
    assert accel.mean(axis=0) == pytest.approx([0.0, 0.0, 9.80665], abs=0.001)
    correlation = np.corrcoef(np.column_stack([rates, accel]).T) - np.eye(6)
    assert np.abs(correlation).max() < 0.03


@pytest.mark.parametrize("name", TRIAXIAL)
def test_an_effect_on_vectors_is_0_unless_it_is_set(name: str) -> None:
    kind = TRIAXIAL[name]
    assert kind.model_validate(kind.typical).name == name
    text = "accel_range:limit_mps2=5" if name == "accel_range" else name
    plain, block = played(rig_of(), samples=3000), played(rig_of(text), samples=3000)
    same = [np.array_equal(getattr(block, column), getattr(plain, column)) for column in ("gyro_xy_raw", "accel_raw")]
    assert not all(same)
    assert np.array_equal(block.encoder_counts, plain.encoder_counts)


def test_a_misaligned_gyro_measures_in_a_rotated_frame() -> None:
    """The rotation vector is a parameter; the accelerometer has its own."""
    rates, accel, true_rates, true_force = measured(
        "gyro_misalignment:x_deg=2,y_deg=-3,z_deg=5", "accel_misalignment:x_deg=-4"
    )
    turn = Rotation.from_rotvec([2.0, -3.0, 5.0], degrees=True)
    assert np.abs(rates - turn.inv().apply(true_rates)).max() < ROUNDING_DPS
    tilt = Rotation.from_rotvec([-4.0, 0.0, 0.0], degrees=True)
    assert np.abs(accel - tilt.inv().apply(true_force)).max() < ROUNDING_MPS2


def test_cross_axis_and_scale_mix_and_stretch() -> None:
    """Xy is the share of y in x; the scale acts after it."""
    rates, accel, true_rates, true_force = measured(
        "gyro_cross_axis:xy_percent=2",
        "gyro_scale:x_percent=10",
        "accel_cross_axis:zx_percent=-3",
        "accel_scale:y_percent=5",
    )
    x, y, z = true_rates.T
    assert np.abs(rates - np.column_stack([1.1 * (x + 0.02 * y), y, z])).max() < ROUNDING_DPS
    x, y, z = true_force.T
    assert np.abs(accel - np.column_stack([x, 1.05 * y, z - 0.03 * x])).max() < ROUNDING_MPS2


def test_a_gyro_feels_acceleration() -> None:
    """Along an axis and across it, per g."""
    rates, _, true_rates, force = measured("gyro_g_sensitivity:x_dps_per_g=2,across_dps_per_g=0.5")
    x, y, z = force.T / 9.80665
    added = np.column_stack([2.0 * x + 0.5 * (y + z), 0.5 * (x + z), 0.5 * (x + y)])
    assert np.abs(rates - true_rates - added).max() < ROUNDING_DPS


def test_an_accelerometer_has_a_bias_a_range_and_steps() -> None:
    bias = "accel_bias:x_mps2=1,z_mps2=-2"
    _, accel, _, force = measured(bias, "accel_range:limit_mps2=9", "accel_steps:step_mps2=0.5")
    expected = np.rint(np.clip(force + np.array([1.0, 0.0, -2.0]), -9.0, 9.0) / 0.5) * 0.5
    assert np.mean(np.abs(accel - expected) < ROUNDING_MPS2) > 0.999


def test_an_accelerometer_walks() -> None:
    rig = rig_of("accel_walk:density_mps2_rts=0.05")
    ends = [values_of(played(rig, "rest", 10001, seed), rig)[1] for seed in range(12)]
    steps = np.concatenate([np.diff(accel[::1000], axis=0).ravel() for accel in ends])
    assert np.std(steps) == pytest.approx(0.05 * np.sqrt(10.0), rel=0.15)


def test_a_silent_accelerometer_has_no_counts() -> None:
    block = played(rig_of("accel_dropout:from_s=10,to_s=20"))
    is_missing = np.all(block.accel_raw == ACCEL_MISSING, axis=1)
    assert np.flatnonzero(is_missing).tolist() == list(range(1000, 2000))
    assert not np.any(block.accel_raw[~is_missing] == ACCEL_MISSING)
    assert np.array_equal(block.rate_raw, played(rig_of()).rate_raw)


def test_a_device_may_have_no_accelerometer() -> None:
    block = played(rig_of(mps2_per_lsb=0.0))
    assert block.accel_raw.shape == (6000, 0)
    assert block.gyro_xy_raw.shape == (6000, 2)


def test_motors_shake_gyro_and_accelerometer() -> None:
    text = "motor_vibration:gyro_dps=3,accel_mps2=2,frequency_hz=83,rest_share=0.25"
    rates, accel, true_rates, force = measured(text)
    shaken = [rates - true_rates, accel - force]
    moves = np.any(true_rates != 0.0, axis=1)
    for values, rms in zip(shaken, (3.0, 2.0), strict=True):
        assert values[moves].std(axis=0) == pytest.approx([rms] * 3, rel=0.05)
        assert values[~moves].std(axis=0) == pytest.approx([0.25 * rms] * 3, rel=0.1)


def test_a_low_pass_of_the_chip_quiets_vibration_on_all_axes() -> None:
    """Gyro and accelerometer alike, as H = 1/√(1 + (f/fc)²) says."""
    text = "motor_vibration:gyro_dps=20,accel_mps2=10,frequency_hz=80,wander_hz=0"
    rig = rig_of(text, "bandwidth:cutoff_hz=20", mps2_per_lsb=1e-3)
    rates, accel = values_of(played(rig, "rest", 4096), rig)
    passed = 1.0 / np.sqrt(1.0 + (80.0 / 20.0) ** 2)
    assert rates[200:].std(axis=0) == pytest.approx([20.0 * passed] * 3, rel=0.02)
    assert accel[200:].std(axis=0) == pytest.approx([10.0 * passed] * 3, rel=0.02)


def test_each_gyro_axis_marks_the_end_of_its_range() -> None:
    axes = QUIET.model_copy(update={"gyro_bias_x_dps": 50.0})
    rig = Rig(base=Base(noise_dps_rthz=0.0, dps_per_lsb=1e-3, three_axes=axes))
    block = played(rig, "rest", 100)
    assert block.is_clipped.all()
    assert set(block.gyro_xy_raw[:, 0].tolist()) == {COUNTS_MAX}
    assert set(block.gyro_xy_raw[:, 1].tolist()) == {0}
    assert not block.accel_clipped.any()


def test_an_accelerometer_marks_the_end_of_its_range() -> None:
    """Gravity exceeds ±0.5 g, and the counts stop there."""
    block = played(rig_of(mps2_per_lsb=0.5 * 9.80665 / 2**15), "rest", 100)
    assert block.accel_clipped.all()
    assert set(block.accel_raw[:, 2].tolist()) == {COUNTS_MAX}
    assert not block.is_clipped.any()


@pytest.mark.parametrize("size", [1, 7, 97, 300])
def test_the_size_of_the_blocks_makes_no_difference(size: int) -> None:
    rig = with_effects(load_rig(config_folder() / "rig-three-axes.yaml"), [parse_effect("accel_walk")])
    rig = with_effects(rig, [parse_effect("motor_vibration"), parse_effect("stale_hold:share_percent=20")])
    small, large = played(rig, samples=300, size=size), played(rig, samples=300)
    for column in ("rate_raw", "gyro_xy_raw", "accel_raw", "is_clipped"):
        assert np.array_equal(getattr(small, column), getattr(large, column)), column


def test_a_sample_that_is_read_twice_repeats_all_axes() -> None:
    axes = ThreeAxes(mps2_per_lsb=1e-3)
    rig = with_effects(Rig(base=Base(dps_per_lsb=1e-4, three_axes=axes)), [parse_effect("stale_hold:share_percent=30")])
    block = played(rig, "rest", 2000)
    repeats = np.diff(block.rate_raw) == 0
    assert 0.2 < repeats.mean() < 0.4
    for column in (block.gyro_xy_raw, block.accel_raw):
        assert np.array_equal(np.all(np.diff(column, axis=0) == 0, axis=1), repeats)


def test_rest_in_space_is_the_rest_of_all_axes() -> None:
    """A robot that drives straight ahead has no rate, and does not rest."""
    robot = load_motion("ramps")
    assert isinstance(robot, AttitudeProfile)
    block = next(measure(rig_of(), robot, 0, still=StillWord.TRUE))
    motion = robot.kinematics_at(block.seq / 100.0)
    drives_straight = np.all(motion.rates_dps == 0.0, axis=1) & np.any(motion.velocity_mps != 0.0, axis=1)
    assert block.still[drives_straight].max() == 0
    assert block.still[:400].min() == 1


@pytest.mark.parametrize("fault", ["double_rate", "stuck_value", "reset", "rate_change", "full_scale"])
def test_faults_keep_the_axes_together(fault: str) -> None:
    """A row has the acceleration of its own rate, or all of it hangs."""
    rig = rig_of()
    blocks = list(faulty_blocks(islice(measure(rig, load_motion("hand"), 0), 2), [parse_fault(fault)]))
    for block in blocks:
        assert isinstance(block, TriaxialBlock)
        assert len(block.gyro_xy_raw) == len(block.accel_raw) == len(block.seq)
    whole = joined(*blocks)
    assert isinstance(whole, TriaxialBlock)
    if fault == "stuck_value":
        assert len(np.unique(whole.accel_raw[300:], axis=0)) == 1
        return
    rates, accel = values_of(whole, rig)
    truth = load_motion("hand")
    assert isinstance(truth, AttitudeProfile)
    motion = truth.kinematics_at(whole.t_host_s - rig.base.host_delay_s)
    assert np.abs(accel - motion.specific_force_mps2(9.80665)).max() < 0.3
    assert np.abs(rates - motion.rates_dps)[:, :2].max() < 2.0


def test_the_shipped_rig_with_three_axes_plays() -> None:
    rig = load_rig(config_folder() / "rig-three-axes.yaml")
    assert rig.base.three_axes is not None
    assert rig.base.three_axes.model_fields_set == set(ThreeAxes.model_fields)
    assert len(played(rig, "drone", 500).seq) == 500


def test_a_rig_file_keeps_three_axes_and_says_nothing_of_them_for_one(tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    rig = with_effects(with_axes(load_rig(None), 3), [parse_effect("accel_bias"), parse_effect("warmup")])
    path.write_text(rig_yaml(rig))
    assert load_rig(path) == rig
    assert "three_axes" not in rig_yaml(load_rig(None))
    assert with_axes(rig, 1).base == load_rig(None).base
    assert with_axes(rig, 3) is rig


def test_an_effect_on_vectors_needs_three_axes() -> None:
    """The message says how to get them."""
    with pytest.raises(FileError, match=r"--effect accel_bias: needs a rig with three axes; add --axes 3"):
        with_effects(load_rig(None), [parse_effect("accel_bias")])


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("three_axes: {mps2_per_lsb: 2}", "base.three_axes.mps2_per_lsb: is 2"),
        ("three_axes: {effects: [{name: warmup}]}", "'warmup' is not known; there are 'motor_vibration'"),
        ("three_axes: {effects: [{name: accel_bias, x: 1}]}", "base.three_axes.effects.0.x: is not known here"),
        ("three_axes: {effects: [{x: 1}]}", "'name' is missing"),
    ],
)
def test_mistakes_of_a_rig_are_told_with_their_place(text: str, problem: str, tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(f"base:\n  {text}\n")
    with pytest.raises(FileError) as caught:
        load_rig(path)
    assert problem in str(caught.value)
