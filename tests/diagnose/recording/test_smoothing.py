"""The Gaussian: ends, width and sum."""

import numpy as np
import pytest

from gyrodrift.diagnose.recording.smoothing import gaussian


def test_a_constant_stays_one() -> None:
    assert gaussian(np.full(100, 7.0), 3.0) == pytest.approx(np.full(100, 7.0), rel=1e-14)


def test_it_spreads_what_stands_alone() -> None:
    alone = np.zeros(201)
    alone[100] = 1.0
    smooth = gaussian(alone, 10.0)
    assert smooth.sum() == pytest.approx(1.0)
    assert smooth[110] / smooth[100] == pytest.approx(np.exp(-0.5))
    assert smooth @ np.square(np.arange(-100.0, 101.0)) == pytest.approx(100.0, rel=2e-3)
