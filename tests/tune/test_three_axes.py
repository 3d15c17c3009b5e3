"""Tuned parameters of restlevel have to hold where it runs on three axes."""

from pathlib import Path

import pytest
from hand_motion import BIAS_DPS, COLUMNS, hand_motion

pytest.importorskip("numba", reason="tuning needs the workstation extra")
from gyrodrift.evaluation.dataset import Source, load_with_reference
from gyrodrift.filters.restlevel.model import RestlevelParams
from gyrodrift.tune.choice import worse_on_three_axes

WITHOUT_BIAS = RestlevelParams(turn_on_dps=0.001, walk_dps_rts=1e-6)
"""A gyro whose bias is known to be 0: wrong for any board."""


@pytest.mark.parametrize(("columns", "end"), [(COLUMNS, "the config has the defaults"), (COLUMNS[:3], "")])
def test_parameters_that_are_worse_on_three_axes_than_the_defaults_are_told(
    tmp_path: Path, columns: tuple[str, ...], end: str
) -> None:
    path = hand_motion(30.0, tilt_deg=25.0, bias_dps=BIAS_DPS).write(tmp_path / "hand.csv", columns)
    warning = worse_on_three_axes(WITHOUT_BIAS, [load_with_reference(Source(path))])
    assert bool(warning) == bool(end)
    assert warning.endswith(end)


def test_parameters_that_are_better_are_kept(tmp_path: Path) -> None:
    path = hand_motion(30.0, tilt_deg=25.0).write(tmp_path / "hand.csv")
    assert not worse_on_three_axes(WITHOUT_BIAS, [load_with_reference(Source(path))])
