"""A filter over samples of one axis and of three."""

from math import nan

import numpy as np
import pytest
from hand_motion import BIAS_DPS, HandMotion, hand_motion
from scipy.spatial.transform import Rotation

from gyrodrift.filters.filter import Filter
from gyrodrift.filters.hdr_filter import HDR
from gyrodrift.filters.restlevel.model import RestlevelParams
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.filters.run import FilterRun
from gyrodrift.values.arrays import Floats
from gyrodrift.values.mount import Mount
from gyrodrift.values.sample import Inertial


def rates_only(run: FilterRun, motion: HandMotion) -> None:
    for t_s, gyro in zip(motion.t_s.tolist(), motion.gyro_dps.tolist(), strict=True):
        run.step(t_s, gyro[2])


def all_axes(run: FilterRun, motion: HandMotion) -> list[float]:
    """Yaw after each sample."""
    yaw_deg = []
    columns = (motion.t_s.tolist(), motion.gyro_dps.tolist(), motion.accel_mps2.tolist())
    for t_s, gyro, accel in zip(*columns, strict=True):
        run.step(t_s, gyro[2], Inertial(*gyro, *accel))
        yaw_deg.append(run.state.yaw_deg)
    return yaw_deg


def test_one_axis_gets_the_bits_of_the_step_itself() -> None:
    motion, run = hand_motion(20.0), FilterRun(RESTLEVEL, RESTLEVEL.params())
    rates_only(run, motion)
    state, c = RESTLEVEL.state(), RESTLEVEL.coefficients(RESTLEVEL.params())
    for t_s, gyro in zip(motion.t_s.tolist(), motion.gyro_dps.tolist(), strict=True):
        RESTLEVEL.step(c, state, t_s, gyro[2], nan, nan)
    assert run.three_axes is None
    assert (run.state.yaw_deg, run.state.yaw_sigma_deg) == (state.yaw_deg, state.yaw_sigma_deg)


def test_a_tilted_gyro_keeps_its_heading_on_three_axes_and_loses_it_on_one() -> None:
    motion = hand_motion(60.0, tilt_deg=25.0, yaw_deg=25.0, bias_dps=BIAS_DPS)
    tilted, flat = FilterRun(RESTLEVEL, RESTLEVEL.params()), FilterRun(RESTLEVEL, RESTLEVEL.params(), "1")
    error_deg = np.abs(all_axes(tilted, motion) - motion.heading_deg)
    one_axis_error_deg = np.abs(all_axes(flat, motion) - motion.heading_deg)
    assert error_deg.max() < 3.0
    assert one_axis_error_deg.max() > 20.0
    assert flat.three_axes is None


def test_yaw_and_attitude_agree() -> None:
    """The twist of q about the vertical is yaw, and roll and pitch are those of the motion."""
    motion, run = hand_motion(30.0), FilterRun(RESTLEVEL, RESTLEVEL.params())
    yaw_deg = all_axes(run, motion)[-1]
    w, _, _, z = run.state.q
    assert np.rad2deg(2.0 * np.arctan2(z, w)) == pytest.approx(yaw_deg, abs=1e-6)
    roll_deg, pitch_deg = Mount().roll_pitch_deg(run.state.q)
    up = motion.accel_mps2[-1]
    assert roll_deg == pytest.approx(np.rad2deg(np.arctan2(up[1], up[2])), abs=2.0)
    assert pitch_deg == pytest.approx(np.rad2deg(np.arcsin(-up[0] / np.linalg.norm(up))), abs=2.0)


def test_a_filter_of_one_axis_runs_on_the_rate_of_the_heading() -> None:
    """HDR is plain integration in the first minute: there is no bias, so the heading is right."""
    motion, run = hand_motion(60.0, tilt_deg=25.0, yaw_deg=25.0), FilterRun(HDR, HDR.params())
    yaw_deg = all_axes(run, motion)
    assert np.abs(yaw_deg - motion.heading_deg).max() < 3.0
    w, _, _, z = run.state.q
    assert np.rad2deg(2.0 * np.arctan2(z, w)) == pytest.approx(yaw_deg[-1], abs=1e-6)


def test_auto_waits_for_an_acceleration_and_goes_on_at_the_same_yaw() -> None:
    motion, run = hand_motion(10.0), FilterRun(RESTLEVEL, RESTLEVEL.params())
    for index in range(800):
        run.step(float(motion.t_s[index]), float(motion.gyro_dps[index, 2]), Inertial(*motion.gyro_dps[index].tolist()))
    assert run.three_axes is None
    yaw_deg = run.state.yaw_deg
    run.step(float(motion.t_s[800]), 0.0, Inertial(*motion.gyro_dps[800].tolist(), *motion.accel_mps2[800].tolist()))
    assert run.three_axes is not None
    assert run.state.yaw_deg == pytest.approx(yaw_deg)


def test_three_axes_without_acceleration_take_a_level_start() -> None:
    motion, run = hand_motion(30.0), FilterRun(RESTLEVEL, RESTLEVEL.params(), "3")
    for t_s, gyro in zip(motion.t_s.tolist(), motion.gyro_dps.tolist(), strict=True):
        run.step(t_s, gyro[2], Inertial(*gyro))
    assert run.three_axes is not None
    assert run.state.yaw_deg == pytest.approx(motion.heading_deg[-1], abs=3.0)


def test_a_zero_restarts_the_sigma_on_three_axes() -> None:
    motion, run = hand_motion(40.0), FilterRun(RESTLEVEL, RESTLEVEL.params())
    all_axes(run, motion)
    sigma_deg = run.state.yaw_sigma_deg
    yaw_deg = run.state.yaw_deg
    run.zero()
    assert (run.state.yaw_sigma_deg, run.state.yaw_deg) == (0.0, yaw_deg)
    run.step(40.0, 0.0, Inertial(0.0, 0.0, 0.0, 0.0, 0.0, 9.81))
    assert run.state.yaw_sigma_deg < 0.2 * sigma_deg


def test_a_calibrated_scale_of_one_axis_is_not_that_of_three() -> None:
    """A calibration about the vertical knows z alone; a matrix of the gyro gives the scale of all axes."""
    motion = hand_motion(20.0, tilt_deg=25.0)
    calibrated, default = RestlevelParams(scale_percent=0.05), RestlevelParams()
    plain, one_axis, matrix = (FilterRun(RESTLEVEL, default) for _ in range(3))
    one_axis.use(calibrated, default)
    matrix.use(calibrated, calibrated)
    assert all_axes(one_axis, motion) == all_axes(plain, motion)
    all_axes(matrix, motion)
    assert matrix.state.yaw_sigma_deg < plain.state.yaw_sigma_deg
    assert one_axis.state.yaw_sigma_deg == plain.state.yaw_sigma_deg


def test_a_board_on_its_side_has_the_heading_of_its_device() -> None:
    motion = hand_motion(40.0, tilt_deg=15.0, yaw_deg=15.0, bias_dps=BIAS_DPS)
    mount = Mount("+x", "+y")
    turn = HandMotion(
        motion.t_s, rows_to_sensor(mount, motion.gyro_dps), rows_to_sensor(mount, motion.accel_mps2), motion.heading_deg
    )
    flat = FilterRun(RESTLEVEL, RESTLEVEL.params())
    sideways = FilterRun(RESTLEVEL, RESTLEVEL.params(), mount=mount)
    yaw_deg = all_axes(flat, motion)
    assert all_axes(sideways, turn) == pytest.approx(yaw_deg, abs=1e-6)
    ours, theirs = flat.attitude(), sideways.attitude()
    assert (theirs.roll_deg, theirs.pitch_deg, theirs.tilt_deg) == pytest.approx(
        (ours.roll_deg, ours.pitch_deg, ours.tilt_deg), abs=1e-6
    )
    biases_dps = (theirs.bias_x_dps, theirs.bias_y_dps, theirs.bias_z_dps)
    assert mount.to_device(biases_dps) == pytest.approx((ours.bias_x_dps, ours.bias_y_dps, ours.bias_z_dps), abs=1e-6)
    up = np.array(turn.accel_mps2[-1]) / np.linalg.norm(turn.accel_mps2[-1])
    assert rotated(theirs[:4], up)[2] == pytest.approx(1.0, abs=0.01)


def test_three_axes_begin_with_the_sigma_of_one() -> None:
    """An accelerometer that starts late makes the yaw so far no better known."""
    motion, run = hand_motion(20.0), FilterRun(RESTLEVEL, RESTLEVEL.params())
    rates_only(run, motion)
    sigma_deg = run.state.yaw_sigma_deg
    assert sigma_deg > 0.1
    run.step(20.0, 0.0, Inertial(0.0, 0.0, 0.0, 0.0, 0.0, 9.81))
    assert run.three_axes is not None
    assert run.state.yaw_sigma_deg == pytest.approx(sigma_deg, rel=1e-6)


@pytest.mark.parametrize("chosen", [RESTLEVEL, HDR])
def test_a_device_that_sends_one_rate_from_now_on_has_one_axis(chosen: Filter) -> None:
    motion, run = hand_motion(20.0, tilt_deg=40.0), FilterRun(chosen, chosen.params(), mount=Mount("+y", "+x"))
    yaw_deg = all_axes(run, motion)[-1]
    for index in range(1, 1001):
        assert run.step(20.0 + 0.01 * index, 0.0)
    assert run.three_axes is None
    run.step(30.01, 0.0, Inertial(0.0, 0.0, 0.0, 0.0, 9.81, 0.0))
    assert run.three_axes is not None
    assert run.state.yaw_deg == pytest.approx(yaw_deg, abs=5.0)


def rows_to_sensor(mount: Mount, rows: Floats) -> Floats:
    return np.array([mount.to_sensor((x, y, z)) for x, y, z in rows.tolist()])


def rotated(q: tuple[float, ...], vector: Floats) -> Floats:
    return np.asarray(Rotation.from_quat(q, scalar_first=True).apply(vector), dtype=np.float64)


@pytest.mark.parametrize(("missing_s", "yaw_deg"), [(0.2, 90.0), (1.0, 60.0)])
def test_yaw_is_held_over_missing_rates(missing_s: float, yaw_deg: float) -> None:
    """A few tenths of a second are interpolated; after more, sigma covers the turn that is unknown."""
    run, dice = FilterRun(RESTLEVEL, RESTLEVEL.params()), np.random.default_rng(1)
    for i in range(1150):
        t_s = i / 50.0
        rate_dps = 30.0 * (10.0 <= t_s < 13.0) + dice.normal(0.0, 0.05)
        run.step(t_s, nan if 11.0 <= t_s < 11.0 + missing_s else rate_dps)
    assert run.state.yaw_deg == pytest.approx(yaw_deg, abs=1.5)
    assert abs(run.state.yaw_deg - 90.0) < 2.0 * run.state.yaw_sigma_deg
