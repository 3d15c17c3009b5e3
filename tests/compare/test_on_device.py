"""The method `on-device`: the yaw of the device's own filter as recorded, beside the filters of the host."""

from dataclasses import replace
from math import nan
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal

pytest.importorskip("numba", reason="comparing needs the workstation extra")
from firmware_sim.motion.profile import load_motion
from firmware_sim.rig import Base, Rig, with_own_yaw
from gyrodrift.compare.comparison import Comparison, ComparisonRequest, compare
from gyrodrift.compare.methods.registry import methods
from gyrodrift.compare.report.files import summary
from gyrodrift.evaluation.auxiliary import hold_last
from gyrodrift.session.files import load_session, write_session
from gyrodrift.session.session import Session
from gyrodrift.simulation.sessions import Simulation

pytestmark = pytest.mark.xdist_group("restlevel_kernel")  # its compilation takes seconds

CHOSEN = tuple(method for method in methods() if method.key in ("euler", "hdr", "restlevel", "on-device"))


def simulated(own_yaw: str | None, seed: int = 1) -> Session:
    """A turntable for two minutes, with a bias of 0.3 deg/s."""
    rig = with_own_yaw(Rig(base=Base(bias_dps=0.3)), own_yaw)
    return Simulation(rig, load_motion("turntable"), seed, minutes=2.0).whole()


def compared(folder: Path, *sessions: Session) -> Comparison:
    paths = [folder / f"{index}.mcap" for index in range(len(sessions))]
    for path, session in zip(paths, sessions, strict=True):
        write_session(path, [session])
    return compare(ComparisonRequest(paths, CHOSEN))


def scores(comparison: Comparison) -> dict[str, tuple[float, float | None]]:
    """Mean E and coverage by method."""
    stated = comparison.mean_uncertainties
    return {
        entry.method.key: (comparison.means[row].e_deg, None if (of := stated[row]) is None else of.coverage)
        for row, entry in enumerate(comparison.entries)
    }


def test_the_filter_in_the_device_is_judged_as_that_of_the_host(tmp_path: Path) -> None:
    """Error and coverage are equal where the same filter ran on the same counts."""
    comparison = compared(tmp_path, simulated("restlevel"), simulated("restlevel", seed=2))
    by_key = scores(comparison)
    assert by_key["on-device"] == pytest.approx(by_key["restlevel"], abs=1e-4)
    assert by_key["on-device"][0] < 0.1 * by_key["euler"][0]
    assert any(line.strip(" *").startswith("on-device") for line in summary(comparison))


def test_a_filter_without_a_sigma_has_no_coverage(tmp_path: Path) -> None:
    by_key = scores(compared(tmp_path, simulated("hdr")))
    assert by_key["on-device"][0] == pytest.approx(by_key["hdr"][0], abs=1e-3)
    assert by_key["on-device"][1] is None


def test_it_is_not_offered_where_a_session_has_no_yaw_of_the_device(tmp_path: Path) -> None:
    comparison = compared(tmp_path, simulated("restlevel"), simulated(None))
    assert "on-device" not in scores(comparison)
    assert "on-device" not in {method.key for method in comparison.missing}


def test_gaps_are_held_and_the_zero_is_that_of_the_first_sample(tmp_path: Path) -> None:
    """A device may send every tenth yaw, and may have run for long before the recording began."""
    whole = simulated("restlevel")
    assert whole.device_yaw_deg is not None
    sparse = np.where(np.arange(len(whole.rate_dps)) % 10 == 4, whole.device_yaw_deg + 5000.0, nan)
    comparison = compared(tmp_path, replace(whole, device_yaw_deg=sparse))
    assert load_session(tmp_path / "0.mcap").device_yaw_deg is not None
    assert scores(comparison)["on-device"][0] < 15.0  # ten samples of the fastest turn


def test_a_missing_value_is_the_last_one_before_it() -> None:
    assert_array_equal(hold_last(np.array([nan, 1.0, nan, nan, 2.0, nan])), [1.0, 1.0, 1.0, 1.0, 2.0, 2.0])
    assert_array_equal(hold_last(np.array([nan, nan])), [nan, nan])
