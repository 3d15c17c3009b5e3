"""Levels that values take."""

import numpy as np
import pytest

from gyrodrift.diagnose.recording.order_statistics import distinct

RNG = np.random.default_rng(5)


@pytest.mark.parametrize("step", [0.0, 0.0305, 360.0 / 512])
@pytest.mark.parametrize("count", [0, 1, 2, 8, 5000])
def test_distinct_values_rise_and_come_once(count: int, step: float) -> None:
    values = RNG.normal(0.0, 100.0, count)
    values = np.rint(values / step) * step if step else values
    values[:: max(2, count // 4)] = np.resize([np.nan, 0.0, np.inf, -0.0], len(values[:: max(2, count // 4)]))
    assert np.array_equal(distinct(values), sorted({*np.round(values[np.isfinite(values)], 9)}))
