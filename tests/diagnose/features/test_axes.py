"""Features of the mounting of a sensor with three axes: sines of its tilt, from the turn and from gravity."""

from dataclasses import replace

import numpy as np
import pytest
from features_support import FACTS, T_S, TRUE_DEG, TRUE_DPS, observed, recorded, true_design, white

from gyrodrift.diagnose.features.axes import turn_lean
from gyrodrift.diagnose.features.vector import NUMBER, OF_AXES, Facts, measure
from gyrodrift.diagnose.recording.outliers import clean
from gyrodrift.diagnose.recording.recording import Recording
from gyrodrift.values.arrays import Floats

THREE = Facts(FACTS.dps_per_lsb, FACTS.encoder_cpr, FACTS.step_dps, has_axes=True, has_gravity=True)
G = 9.8


def tilted(tilt_deg: float, gravity_deg: float | None = None) -> Recording:
    """A sensor tilted toward y, with noise, biases that drift, and gravity that leans by another angle if given."""
    tilt, lean = np.deg2rad([tilt_deg, tilt_deg if gravity_deg is None else gravity_deg])
    drift = np.linspace(0.0, 0.3, len(T_S))
    across = np.column_stack([1.5 + white(0.1, 2) - drift, TRUE_DPS * np.sin(tilt) - 0.7 + white(0.1, 3) + drift])
    force: Floats = np.array([0.0, G * np.sin(lean), G * np.cos(lean)]) + white(0.05, 5, 3 * len(T_S)).reshape(-1, 3)
    return replace(recorded(TRUE_DPS * np.cos(tilt)), gyro_xy_dps=across, accel_mps2=force)


def values(recording: Recording, facts: Facts = THREE) -> dict[str, float]:
    features = measure(clean(recording), true_design(), facts).values
    return {name: float(features[NUMBER[name]]) for name in ("turn_across", "gravity_across")}


@pytest.mark.parametrize("tilt_deg", [3.0, 12.0])
def test_both_features_are_sines_of_the_tilt(tilt_deg: float) -> None:
    sine = np.sin(np.deg2rad(tilt_deg))
    assert values(tilted(tilt_deg)) == pytest.approx({"turn_across": sine, "gravity_across": sine}, abs=0.002)


def test_a_level_sensor_shows_neither() -> None:
    assert max(values(tilted(0.0)).values()) < 0.002


def test_a_scale_error_shows_in_neither() -> None:
    level = tilted(0.0)
    assert values(replace(level, rate_dps=1.1 * level.rate_dps)) == values(level)


def test_gravity_and_turn_are_measured_apart() -> None:
    """A bias of the accelerometer leans gravity alone."""
    features = values(tilted(0.0, gravity_deg=5.0))
    assert features["turn_across"] < 0.002
    assert features["gravity_across"] == pytest.approx(np.sin(np.deg2rad(5.0)), abs=0.002)


def test_the_direction_of_the_lean_is_known() -> None:
    lean = turn_lean(tilted(12.0), true_design())
    assert np.degrees(np.arctan2(lean.y, lean.x)) == pytest.approx(90.0, abs=0.5)


def test_devices_without_axes_have_zeros() -> None:
    single = observed(TRUE_DPS)
    assert not measure(single.cleaned, single.design, THREE).values[OF_AXES].any()
    assert values(tilted(12.0), FACTS) == {"turn_across": 0.0, "gravity_across": 0.0}
    without_gravity = values(tilted(12.0), replace(THREE, has_gravity=False))
    assert without_gravity["turn_across"] > 0.2
    assert without_gravity["gravity_across"] == 0.0


def test_without_a_turn_nothing_leans() -> None:
    """A slope over the rate needs a rate."""
    still = replace(true_design().motion, rate_dps=np.zeros(len(T_S)), angle_deg=np.full(len(T_S), TRUE_DEG[0]))
    assert turn_lean(tilted(12.0), replace(true_design(), motion=still)).sine == 0.0
