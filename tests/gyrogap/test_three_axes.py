"""Sessions of three axes: how turn and gravity reach a device that is tilted, crossed, biased or scaled."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from gyrogap.estimators import smooth_rates
from gyrogap.features import features_of
from gyrogap.physics.bench import Columns
from gyrogap.physics.kinds import InjectedEffect
from gyrogap.rows import draw_case

GRAVITY_MPS2 = 9.80665


def measured(*effects: InjectedEffect) -> Columns:
    """A session of a device whose table is level and whose accelerometer has no offset."""
    case = draw_case(11, "none", 11)
    axes = case.stand.device.three_axes
    assert axes is not None
    ideal = replace(axes, table_tilt_deg=0.0, offset_mps2=(0.0, 0.0, 0.0))
    case.stand.device = replace(case.stand.device, three_axes=ideal)
    return replace(case, modeled=()).held_out(effects, "test").columns(0)


def of(*effects: InjectedEffect) -> dict[str, Any]:
    columns = measured(*effects)
    features = features_of(columns)
    rate_dps, encoder_dps, _ = smooth_rates(columns)
    gain = float(np.polyfit(encoder_dps, rate_dps, 1)[0])
    return {name: features[name] for name in ("turn_x", "turn_y", "force_x", "force_y", "force")} | {
        "scale": gain - 1.0
    }


def test_a_healthy_device_turns_and_weighs_about_z() -> None:
    expected = {"turn_x": 0.0, "turn_y": 0.0, "force_x": 0.0, "force_y": 0.0, "force": GRAVITY_MPS2, "scale": 0.0}
    assert of() == pytest.approx(expected, abs=2e-3)


def test_a_tilt_leans_turn_and_gravity() -> None:
    sine = np.sin(np.radians(10.0))
    tilted = of(InjectedEffect("misalignment", {"tilt_deg": 10.0, "about_deg": 0.0}))
    assert abs(tilted["turn_y"]) == pytest.approx(sine, abs=2e-3)
    assert tilted["force_y"] == pytest.approx(GRAVITY_MPS2 * tilted["turn_y"], abs=0.03)
    assert tilted["turn_x"] == pytest.approx(0.0, abs=2e-3)
    assert tilted["scale"] == pytest.approx(np.cos(np.radians(10.0)) - 1.0, abs=2e-3)


def test_cross_axis_sensitivity_leans_the_turn_alone() -> None:
    """X reads 5 % of z, y reads -2 %."""
    crossed = of(InjectedEffect("gyro_cross_axis", {"xz_percent": 5.0, "yz_percent": -2.0}))
    assert (crossed["turn_x"], crossed["turn_y"]) == pytest.approx((0.05, -0.02), abs=2e-3)
    assert (crossed["force_x"], crossed["force_y"], crossed["scale"]) == pytest.approx((0.0, 0.0, 0.0), abs=2e-3)


def test_errors_of_the_accelerometer_leave_the_gyro_alone() -> None:
    """An offset of 1 m/s² along y, and a gain of 4 %."""
    biased = of(InjectedEffect("accel_bias", {"offset_mps2": 1.0, "about_deg": 90.0}))
    assert (biased["force_x"], biased["force_y"]) == pytest.approx((0.0, 1.0), abs=5e-3)
    scaled = of(InjectedEffect("accel_scale", {"error_percent": 4.0}))
    assert scaled["force"] == pytest.approx(1.04 * GRAVITY_MPS2, abs=5e-3)
    assert (biased["turn_x"], scaled["turn_y"], scaled["scale"]) == pytest.approx((0.0, 0.0, 0.0), abs=2e-3)


def test_electronics_act_on_all_axes_and_a_scale_error_on_z() -> None:
    """A dead band of 3 deg/s silences x and y; lost samples are lost on all axes."""
    axes = measured(InjectedEffect("deadband", {"width_dps": 3.0})).axes
    assert axes is not None
    assert not axes.gyro_dps[:, :2].any()
    lossy = measured(InjectedEffect("sample_drop", {"share_percent": 30.0}))
    assert lossy.axes is not None
    assert len(lossy.axes.gyro_dps) == len(lossy.axes.accel_mps2) == len(lossy.seq)
    healthy, scaled = measured().axes, measured(InjectedEffect("scale_factor", {"error_percent": 5.0})).axes
    assert healthy is not None
    assert scaled is not None
    assert np.array_equal(healthy.gyro_dps[:, :2], scaled.gyro_dps[:, :2])


def test_the_yaw_rate_is_that_of_z() -> None:
    """The column of devices of one axis."""
    columns = measured()
    assert columns.axes is not None
    assert np.array_equal(columns.axes.gyro_dps[:, 2], columns.rate_dps)
