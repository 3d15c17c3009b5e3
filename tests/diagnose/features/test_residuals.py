"""Coefficients of the rate error on its regressors, of errors of known form and size."""

import numpy as np
import pytest
from features_support import PERIOD_S, SECONDS, T_S, TRUE_DEG, TRUE_DPS, observed, observed_beside, white

from gyrodrift.diagnose.features.block_residuals import block_residual_dps, unexplained_dps
from gyrodrift.diagnose.features.design_matrix import COLUMNS
from gyrodrift.diagnose.features.vector import LINEAR, NUMBER, STATIC
from gyrodrift.diagnose.features.within_second import LAG_FEATURES
from gyrodrift.values.arrays import Floats

BLOCKS_DPS: Floats = TRUE_DPS.reshape(SECONDS, 100).mean(axis=1)


def new_part(values: Floats, *before: Floats) -> float:
    """Length of what a column is beyond a constant and those before it, by least squares."""
    columns = np.column_stack([np.ones(len(values)), *before])
    return float(np.linalg.norm(values - columns @ np.linalg.lstsq(columns, values)[0]))


def static_of(rate_dps: Floats) -> dict[str, float]:
    values = observed(rate_dps).values()
    return {column.name: values[column.name] for column in COLUMNS}


def test_a_scale_error_is_the_coefficient_of_the_rate() -> None:
    result = static_of(1.02 * TRUE_DPS)
    assert result.pop("rate") == pytest.approx(0.02 * np.std(BLOCKS_DPS) * np.sqrt(SECONDS), rel=1e-3)
    assert np.abs(list(result.values())).max() < 0.02


def test_an_asymmetry_is_partly_a_scale_error() -> None:
    result = static_of(TRUE_DPS + 0.01 * np.abs(TRUE_DPS))
    size = np.abs(BLOCKS_DPS)
    assert result["abs_rate"] == pytest.approx(0.01 * new_part(size, BLOCKS_DPS), rel=0.01)
    assert np.hypot(result["rate"], result["abs_rate"]) == pytest.approx(0.01 * new_part(size), rel=0.01)


def test_a_bias_is_calibration() -> None:
    assert np.abs(list(static_of(TRUE_DPS + 0.7).values())).max() < 0.01


def test_a_sign_is_kept() -> None:
    """A sine of the angle, of either sign."""
    error = 0.1 * np.sin(np.deg2rad(TRUE_DEG))
    up, down = static_of(TRUE_DPS + error), static_of(TRUE_DPS - error)
    assert up["turn_sine"] == pytest.approx(-down["turn_sine"], rel=0.02)
    assert up["turn_sine"] > 0.1


def test_block_residuals_are_means_of_the_error() -> None:
    off_dps = 0.3 * np.sin(2.0 * np.pi * T_S / 20.0)
    result = block_residual_dps(*observed(TRUE_DPS + off_dps))
    assert result == pytest.approx(off_dps.reshape(SECONDS, 100).mean(axis=1), abs=0.01)


def test_what_the_regressors_explain_is_taken_out() -> None:
    """White noise of 0.2 deg/s a sample leaves 0.02 deg/s a second, less the dimensions that are fitted."""
    remaining = unexplained_dps(*observed(1.03 * TRUE_DPS + white(0.2)))
    dimensions = SECONDS - 1 - len(COLUMNS)
    assert np.sqrt(float(remaining @ remaining) / dimensions) == pytest.approx(0.02, rel=0.15)


def wavy() -> tuple[Floats, Floats]:
    """Rate and angle of a motion that keeps changing: sines of 1.3 and 0.4 s, 0.6 and 5 Hz at most."""
    item, two = 2.0 * np.pi / 1.3, 2.0 * np.pi / 0.4
    return (
        30.0 * np.sin(item * T_S) + 8.0 * np.sin(two * T_S),
        -30.0 / item * np.cos(item * T_S) - 8.0 / two * np.cos(two * T_S),
    )


def test_a_lag_is_the_coefficient_of_the_acceleration() -> None:
    """A gyro that is 2 ms late reads too low by that times the acceleration."""
    rate_dps, angle_deg = wavy()
    item, two = 2.0 * np.pi / 1.3, 2.0 * np.pi / 0.4
    late_s = T_S - 0.002
    late_dps = 30.0 * np.sin(item * late_s) + 8.0 * np.sin(two * late_s)
    acceleration = np.gradient(rate_dps, PERIOD_S)
    # The Gaussian of 0.02 s, through which both go, takes this from a sine of 0.4 s.
    kept = np.exp(-0.5 * (two * 0.02) ** 2)
    size = np.sqrt(len(T_S) * 0.5 * ((30.0 * item) ** 2 + (8.0 * two * kept) ** 2))
    assert np.linalg.norm(acceleration) > size
    result = observed_beside(late_dps, angle_deg).values()
    assert result["lag"] == pytest.approx(-0.002 * size, rel=0.03)


def test_no_lag_has_no_coefficients() -> None:
    rate_dps, angle_deg = wavy()
    result = observed_beside(rate_dps, angle_deg).values()
    assert max(abs(result[feature.name]) for feature in LAG_FEATURES) < 1e-4 * 100.0 * np.sqrt(len(T_S))


def test_linear_features_are_linear() -> None:
    error = 0.02 * TRUE_DPS + 1e-5 * TRUE_DPS**2 + 0.05 * np.sin(np.deg2rad(TRUE_DEG))
    once, twice, none = (observed(TRUE_DPS + factor * error).values() for factor in (1.0, 2.0, 0.0))
    for name, number in NUMBER.items():
        if LINEAR[number]:
            assert twice[name] - none[name] == pytest.approx(2.0 * (once[name] - none[name]), rel=0.02, abs=0.01)
    assert LINEAR[:STATIC].all()
