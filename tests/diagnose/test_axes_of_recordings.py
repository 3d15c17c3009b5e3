"""The axes that a diagnosis compares: those that all recordings and the simulated rig have."""

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from firmware_sim.rig import Rig, ThreeAxes, with_axes
from gyrodrift.diagnose import stages
from gyrodrift.diagnose.recording.recording import Recording
from gyrodrift.diagnose.simulate.candidate_kind import Hints
from gyrodrift.diagnose.simulate.candidates import candidates
from gyrodrift.diagnose.stages import axes_remarks, with_recorded_axes, with_stated_axes

SINGLE = Rig()
THREE = with_axes(SINGLE, 3)
HINTS = Hints(20.0, 20.0, 0.5, 0.01, 0.01, 0.01, 200.0, 0.01, 0.0, 0.01)


def recording(*, axes: bool = False, gravity: bool = False) -> Recording:
    """Fields of a recording that decide on its axes."""
    values = np.zeros((10, 3))
    columns = {
        "gyro_xy_dps": values[:, :2] if axes else None,
        "accel_mps2": values if gravity else None,
        "has_motion": True,
        "host_s": None,
        "temp_c": None,
        "has_counter": True,
    }
    return cast("Recording", SimpleNamespace(counts_samples=True, **columns))


SIX, GYRO, YAW = recording(axes=True, gravity=True), recording(axes=True), recording()


def axes_of(rig: Rig) -> ThreeAxes | None:
    return rig.base.three_axes


def test_recordings_with_three_axes_give_the_rig_three() -> None:
    assert with_recorded_axes(SINGLE, [SIX, SIX]) == THREE
    axes = axes_of(with_recorded_axes(SINGLE, [SIX, GYRO]))
    assert axes is not None
    assert axes.mps2_per_lsb == 0.0
    assert with_recorded_axes(THREE, [SIX]) == THREE


def test_an_accelerometer_that_is_silent_for_most_of_a_recording_is_none() -> None:
    """Gravity is not compared then, and the rates about x and y are."""
    silent = recording(axes=True, gravity=True)
    assert silent.accel_mps2 is not None
    silent.accel_mps2[:6] = np.nan
    axes = axes_of(with_recorded_axes(SINGLE, [SIX, silent]))
    assert axes is not None
    assert axes.mps2_per_lsb == 0.0


@pytest.mark.parametrize("recordings", [[YAW], [SIX, YAW]])
def test_a_recording_of_the_yaw_rate_alone_leaves_one_axis(recordings: list[Recording]) -> None:
    assert axes_of(with_recorded_axes(SINGLE, recordings)) is None
    single = with_recorded_axes(THREE, recordings)
    assert axes_of(single) is None
    assert with_stated_axes(single, THREE) == THREE
    assert with_stated_axes(single, SINGLE) == single


def test_a_difference_of_axes_is_remarked_on() -> None:
    assert axes_remarks(SINGLE, [YAW, YAW]) == axes_remarks(THREE, [SIX, GYRO]) == []
    (lacks,), (exceeds,) = axes_remarks(SINGLE, [SIX]), axes_remarks(THREE, [YAW])
    assert "the recordings have three axes, and the rig has one" in lacks
    assert "the rig has three axes, and the recordings have one" in exceeds
    (some,) = axes_remarks(SINGLE, [SIX, YAW])
    assert "only 1 of 2 recordings have three axes" in some


def test_a_tilt_is_tried_only_with_three_axes_in_all_recordings() -> None:
    every = candidates(HINTS)
    tried, _ = stages.testable_among(every, [SIX, GYRO], frozenset(), has_axes=True)
    assert "misalignment" in {candidate.name for candidate in tried}
    tried, untestable = stages.testable_among(every, [SIX, YAW], frozenset(), has_axes=False)
    assert "misalignment" not in {candidate.name for candidate in tried}
    assert {item.effect: item.why for item in untestable}["misalignment"] == "no rates about x and y"
