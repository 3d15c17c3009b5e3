"""Starts at rest with a running motor, then two minutes of motion without a stop."""

import numpy as np
import pytest

from gyrodrift.values.arrays import Floats

pytest.importorskip("numba", reason="comparing needs the workstation extra")
from gyrodrift.compare.methods.registry import by_key
from gyrodrift.evaluation.auxiliary import Auxiliary
from gyrodrift.evaluation.kernels.restlevel import walk
from gyrodrift.filters.restlevel.model import RestlevelParams

pytestmark = pytest.mark.xdist_group("restlevel_kernel")  # its compilation takes seconds

RATE_HZ, MOVING_S = 100.0, 120.0
QUIET_DPS = 0.03
"""Noise of the sensor without a motor, deg/s at 100 Hz: an MPU-6050 by its data sheet, 0.005 deg/s/√Hz at 50 Hz."""

HUMS_DPS = (0.1, 0.3, 0.5, 1.0, 2.0, 4.0)
KNOT_S, TYPICAL_DPS = 4.0, 40.0
"""The rate goes in a straight line to a normal random value every KNOT_S."""

STARTS = [(bias_dps, seed) for bias_dps in (0.35, 1.0) for seed in range(6)]


def start(hum_dps: float, quiet_s: float, rest_s: float, bias_dps: float, seed: int) -> tuple[Floats, Floats, Floats]:
    """Times, rates and true angle of a device whose motor starts after `quiet_s` and that moves after `rest_s`."""
    dice = np.random.default_rng(seed)
    t_s = np.arange(round((rest_s + MOVING_S) * RATE_HZ)) / RATE_HZ
    knots_s = np.arange(0.0, MOVING_S + KNOT_S, KNOT_S)
    knots_dps = np.r_[0.0, TYPICAL_DPS * dice.normal(size=len(knots_s) - 1)]
    true_dps = np.interp(t_s - rest_s, knots_s, knots_dps)
    noise_dps = np.where(t_s < quiet_s, QUIET_DPS, hum_dps) * dice.normal(size=len(t_s))
    angle_deg = np.r_[0.0, np.cumsum(0.5 * (true_dps[1:] + true_dps[:-1]) / RATE_HZ)]
    return t_s, true_dps + bias_dps + noise_dps, angle_deg


def mean_errors_deg(hum_dps: float, quiet_s: float, rest_s: float) -> dict[str, float]:
    """Mean |yaw error| over the starts by method, deg; `witness`: restlevel that is told the rest."""
    errors_deg: dict[str, list[float]] = {}
    for bias_dps, seed in STARTS:
        t_s, rate_dps, angle_deg = start(hum_dps, quiet_s, rest_s, bias_dps, seed)
        yaws_deg = {key: BY_KEY[key].run(t_s, rate_dps, BY_KEY[key].defaults) for key in METHODS}
        witness = Auxiliary(np.where(t_s < rest_s, 1.0, np.nan), np.empty(0))
        yaws_deg["witness"] = walk(np.diff(t_s, prepend=0.0), rate_dps, RestlevelParams(), witness)[0]
        for key, yaw_deg in yaws_deg.items():
            errors_deg.setdefault(key, []).append(float(np.abs(yaw_deg - angle_deg).mean()))
    return {key: float(np.mean(values)) for key, values in errors_deg.items()}


BY_KEY = by_key()
METHODS = [key for key in ("euler", "start", "vqf", "restlevel") if BY_KEY[key].is_installed]


@pytest.mark.parametrize(("quiet_s", "rest_s"), [(0.0, 5.0), (0.0, 20.0), (5.0, 10.0)])
def test_five_quiet_seconds_or_a_witness_give_the_bias_although_a_motor_runs(quiet_s: float, rest_s: float) -> None:
    by_hum = {hum_dps: mean_errors_deg(hum_dps, quiet_s, rest_s) for hum_dps in HUMS_DPS}
    print(f"\nmotor runs from {quiet_s:g} s on, motion from {rest_s:g} s on; mean |yaw error| in deg by noise in deg/s")
    for hum_dps, errors_deg in by_hum.items():
        print(f"{hum_dps:4g}  " + "  ".join(f"{key} {error_deg:.2f}" for key, error_deg in errors_deg.items()))
    for hum_dps, errors_deg in by_hum.items():
        if quiet_s or hum_dps <= 0.3:
            assert errors_deg["restlevel"] < 0.1 * errors_deg["euler"]
        assert errors_deg["witness"] < 0.6 * errors_deg["euler"]
