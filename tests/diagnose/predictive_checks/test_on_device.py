"""Heading error of the device's own filter in a diagnosis; the verdict does not depend on it."""

from dataclasses import replace
from pathlib import Path

import pytest

pytest.importorskip("numba", reason="diagnosing needs the workstation extra")
from diagnosis_support import diagnosis
from page_support import words

from firmware_sim.motion.profile import load_motion
from firmware_sim.rig import Base, Rig, with_axes, with_own_yaw
from gyrodrift.diagnose.predictive_checks.on_device import OnDeviceYaw, on_device_yaw
from gyrodrift.diagnose.report.files import content, summary
from gyrodrift.diagnose.report.head import verdict
from gyrodrift.report.page import page
from gyrodrift.session.files import write_session
from gyrodrift.simulation.sessions import Simulation

pytestmark = pytest.mark.xdist_group("restlevel_kernel")  # its compilation takes seconds


def recorded(folder: Path, *own_yaws: str | None, axes: int = 1) -> list[Path]:
    """A session of a minute for each filter."""
    paths = []
    for number, own_yaw in enumerate(own_yaws):
        rig = with_own_yaw(with_axes(Rig(base=Base(bias_dps=0.3)), axes), own_yaw)
        paths.append(folder / f"{number}.mcap")
        write_session(paths[-1], [Simulation(rig, load_motion("turntable"), 1, number, minutes=1.0).whole()])
    return paths


@pytest.mark.parametrize(("own_yaw", "axes"), [("restlevel", 1), ("attitude", 3)])
def test_the_filter_of_the_device_has_the_error_of_the_same_filter_here(
    tmp_path: Path, own_yaw: str, axes: int
) -> None:
    errors = on_device_yaw(recorded(tmp_path, own_yaw, own_yaw, axes=axes))
    assert errors is not None
    assert errors.e_device_deg == pytest.approx(errors.e_restlevel_deg, abs=0.01)
    assert errors.within_2_sigma is not None
    assert errors.within_2_sigma > 0.9


def test_hdr_has_no_sigma_and_another_error(tmp_path: Path) -> None:
    errors = on_device_yaw(recorded(tmp_path, "hdr"))
    assert errors is not None
    assert errors.e_device_deg > 2.0 * errors.e_restlevel_deg
    assert errors.within_2_sigma is None


def test_a_session_without_a_yaw_of_the_device_gives_none(tmp_path: Path) -> None:
    assert on_device_yaw(recorded(tmp_path, "restlevel", None)) is None
    assert on_device_yaw([]) is None


def test_the_report_has_it_only_where_it_is_known() -> None:
    plain = diagnosis({})
    own = replace(plain, on_device=OnDeviceYaw(1.25, 0.5, 0.97))
    added = set(summary(own)) - set(summary(plain))
    assert added == {
        "heading error on the recordings: 1.25 deg filter in the device, 97 % within its 2 σ, 0.5 deg restlevel"
    }
    assert content(own) == content(plain) | {
        "on_device": {"e_device_deg": 1.25, "e_restlevel_deg": 0.5, "within_2_sigma": 0.97}
    }
    assert "filter in the device" in words(page("", [verdict(own)]))
    assert "filter in the device" not in words(page("", [verdict(plain)]))
