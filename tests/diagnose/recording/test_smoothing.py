"""The Gaussian beside scipy's, and by itself."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from gyrodrift.diagnose.recording.smoothing import gaussian


@pytest.mark.parametrize("sigma", [0.3, 2.0, 15.0, 50.0])
@pytest.mark.parametrize("count", [1, 7, 1024, 5000])
def test_it_is_that_of_scipy(sigma: float, count: int) -> None:
    """Shorter and longer than the Gaussian, which is mirrored at the ends."""
    values = np.cumsum(np.random.default_rng(count).normal(size=count))
    assert gaussian(values, sigma) == pytest.approx(gaussian_filter1d(values, sigma), rel=1e-13, abs=1e-13)


def test_a_constant_stays_one() -> None:
    """Up to the ends."""
    assert gaussian(np.full(100, 7.0), 3.0) == pytest.approx(np.full(100, 7.0), rel=1e-14)


def test_it_spreads_what_stands_alone() -> None:
    """To a Gaussian of that standard deviation, and of the same sum."""
    alone = np.zeros(201)
    alone[100] = 1.0
    smooth = gaussian(alone, 10.0)
    assert smooth.sum() == pytest.approx(1.0)
    assert smooth[110] / smooth[100] == pytest.approx(np.exp(-0.5))
    assert smooth @ np.square(np.arange(-100.0, 101.0)) == pytest.approx(100.0, rel=2e-3)
