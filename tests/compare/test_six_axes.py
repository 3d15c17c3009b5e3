"""Methods on three axes: filters of this package beside those of other packages, on a motion with a known heading."""

from pathlib import Path

import numpy as np
import pytest
from hand_motion import BIAS_DPS, COLUMNS, HandMotion, hand_motion

pytest.importorskip("numba", reason="comparing needs the workstation extra")
from gyrodrift.compare.comparison import Comparison, ComparisonRequest, compare
from gyrodrift.compare.methods.method import Method
from gyrodrift.compare.methods.registry import by_key, methods
from gyrodrift.evaluation.auxiliary import NO_AUXILIARY, InertialColumns

pytestmark = pytest.mark.xdist_group("restlevel_kernel")  # its compilation takes seconds

SIX_AXES = ("restlevel", "xio", "vqf", "vqf_offline", "madgwick", "mahony")


@pytest.fixture(scope="module")
def motion() -> HandMotion:
    return hand_motion(60.0, tilt_deg=15.0, yaw_deg=20.0)


def on(key: str, motion: HandMotion) -> Method:
    chosen = by_key()[key]
    if not chosen.is_installed:
        pytest.skip(f"{chosen.title} needs the package {chosen.package}")
    return chosen.on(InertialColumns(motion.gyro_dps, motion.accel_mps2), NO_AUXILIARY)


@pytest.mark.parametrize("key", SIX_AXES)
def test_without_a_bias_every_filter_follows_a_tilted_turn(key: str, motion: HandMotion) -> None:
    """Conventions of frames, signs and units agree; a mistake in one costs tens of degrees."""
    method = on(key, motion)
    yaw_deg = method.run(motion.t_s, motion.gyro_dps[:, 2], method.defaults)
    assert yaw_deg[0] == 0.0
    assert np.abs(yaw_deg - motion.heading_deg).max() < 6.0


@pytest.mark.parametrize("key", SIX_AXES)
def test_lost_samples_do_not_shift_the_heading(key: str, motion: HandMotion) -> None:
    kept = np.random.default_rng(4).random(len(motion.t_s)) > 0.1
    kept[0] = True
    thinned = HandMotion(motion.t_s[kept], motion.gyro_dps[kept], motion.accel_mps2[kept], motion.heading_deg[kept])
    method = on(key, thinned)
    yaw_deg = method.run(thinned.t_s, thinned.gyro_dps[:, 2], method.defaults)
    assert np.abs(yaw_deg - thinned.heading_deg).max() < 8.0


@pytest.mark.parametrize("key", SIX_AXES)
def test_missing_accelerations_give_no_nan(key: str, motion: HandMotion) -> None:
    accel_mps2 = motion.accel_mps2.copy()
    accel_mps2[:50], accel_mps2[3000:3200] = np.nan, np.nan
    method = on(key, HandMotion(motion.t_s, motion.gyro_dps, accel_mps2, motion.heading_deg))
    assert np.isfinite(method.run(motion.t_s, motion.gyro_dps[:, 2], method.defaults)).all()


def compared(*paths: Path) -> Comparison:
    return compare(ComparisonRequest(paths, methods()))


def test_a_biased_gyro_in_the_hand_keeps_its_heading_with_restlevel_only_on_three_axes(tmp_path: Path) -> None:
    motion = hand_motion(90.0, tilt_deg=20.0, yaw_deg=20.0, bias_dps=BIAS_DPS)
    tilted = compared(motion.write(tmp_path / "tilted.csv"))
    flat = compared(motion.write(tmp_path / "flat.csv", COLUMNS[:3]))
    errors = {
        name: {entry.method.key: mean.e_deg for entry, mean in zip(result.entries, result.means, strict=True)}
        for name, result in (("tilted", tilted), ("flat", flat))
    }
    assert errors["tilted"]["restlevel"] < 2.0
    assert errors["flat"]["restlevel"] > 10.0
    assert {"madgwick", "mahony"} <= errors["tilted"].keys() | {method.key for method in tilted.missing}
    assert not {"madgwick", "mahony"} & errors["flat"].keys()
    certainty = tilted.mean_uncertainties[[entry.method.key for entry in tilted.entries].index("restlevel")]
    assert certainty is not None


def test_a_folder_of_one_and_three_axes_is_compared_without_the_filters_that_need_acceleration(tmp_path: Path) -> None:
    motion = hand_motion(20.0)
    result = compared(motion.write(tmp_path / "six.csv"), motion.write(tmp_path / "one.csv", COLUMNS[:3]))
    assert not {"madgwick", "mahony"} & {entry.method.key for entry in result.entries}
    assert len(result.sessions) == 2


def test_tuning_makes_no_method_worse_on_its_sessions_of_three_axes(tmp_path: Path) -> None:
    """The search runs on the rate of the heading; what it finds has to hold for the attitude filter."""
    path = hand_motion(30.0, tilt_deg=25.0, bias_dps=BIAS_DPS).write(tmp_path / "hand.csv")
    chosen = (by_key()["restlevel"],)
    result = compare(ComparisonRequest((path,), methods=chosen, train=(path,), iterations=12))
    default, tuned = result.means
    assert tuned.pi_deg2 <= default.pi_deg2
