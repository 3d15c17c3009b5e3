"""Features in units that a person knows."""

import numpy as np
import pytest

from gyrodrift.diagnose.features.feature import Feature
from gyrodrift.diagnose.features.vector import FEATURES, NUMBER
from gyrodrift.values.arrays import Floats


@pytest.mark.parametrize("feature", FEATURES, ids=lambda feature: feature.name)
def test_every_feature_has_a_unit_and_keeps_its_order(feature: Feature) -> None:
    assert feature.reading.unit
    read = feature.reading.of(np.array([-1e3, -2.0, -0.1, 0.0, 0.1, 2.0, 1e3]))
    assert np.isfinite(read).all()
    assert (np.diff(read) >= 0.0).all()
    assert read[4] < read[5]


@pytest.mark.parametrize(
    ("name", "value", "read"),
    [
        ("drop_share", np.sqrt(0.02), 2.0),
        ("wander_20s", np.log(0.01**2), 0.01),
        ("arrival_scatter", np.log(0.003), 3.0),
        ("angle_step", 3.0, 8.0),
        ("clock_ratio", 2e-5, 20.0),
        ("rate", 0.25, 0.25),
        ("slip_power", 2.0 * np.log(3.0), 3.0),
    ],
)
def test_a_reading_is_what_a_person_would_count(name: str, value: float, read: float) -> None:
    values: Floats = np.array([value])
    assert FEATURES[NUMBER[name]].reading.of(values)[0] == pytest.approx(read)
