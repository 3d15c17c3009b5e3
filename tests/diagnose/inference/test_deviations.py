"""Deviating features: normal deviates of several sessions in one, and the share of each session."""

import numpy as np
import pytest
from inference_support import row

from gyrodrift.diagnose.features.vector import NUMBER
from gyrodrift.diagnose.inference.evidence import pooled_z
from gyrodrift.diagnose.inference.gap import deviations, listed, shared


@pytest.mark.parametrize(
    ("z", "pooled"),
    [
        ([3.0, 3.0, 3.0, 3.0], 6.0),
        ([-3.0, -3.0, -3.0, -3.0], -6.0),
        ([3.0, -3.0, 3.0, -3.0], 4.0),  # a norm of 6, less the 2 that chance has
        ([1.0, 1.0, 1.0, -9.0], -(np.sqrt(84.0) - 2.0)),  # a shift of −3, and the scatter has its sign
        ([5.0], 5.0),
    ],
)
def test_sessions_are_pooled_as_a_shift_or_a_scatter(z: list[float], pooled: float) -> None:
    """Whichever is clearer."""
    assert pooled_z(np.array(z)[:, None])[0] == pytest.approx(pooled)


def test_what_deviates_is_listed_worst_first_with_its_share() -> None:
    """Of the squares, each z held at 20."""
    found = deviations(row({"rate": 5.0, "abs_rate": -40.0, "lag": 4.4}), 4.5)
    assert [(one.feature, one.z) for one in found] == [("abs_rate", -40.0), ("rate", 5.0)]
    assert [one.share for one in found] == pytest.approx([400.0 / 425.0, 25.0 / 425.0])
    assert found[0].stage == "sensor"


def test_the_worst_features_are_listed_where_none_passes_the_threshold() -> None:
    """As many as are asked for."""
    z = row({"rate": 2.0, "abs_rate": -3.0, "lag": 1.0})
    assert deviations(z, 4.5) == ()
    assert [one.feature for one in deviations(z, 4.5, least=2)] == ["abs_rate", "rate"]


def test_features_are_listed_in_a_given_order() -> None:
    """With their shares of each other, which follow when some of them go."""
    z = row({"rate": 3.0, "abs_rate": 4.0})
    found = listed([NUMBER["rate"], NUMBER["abs_rate"]], z)
    assert [deviation.feature for deviation in found] == ["rate", "abs_rate"]
    assert [deviation.share for deviation in found] == pytest.approx([9.0 / 25.0, 16.0 / 25.0])
    assert [one.share for one in shared(found[:1])] == [1.0]
    assert shared([]) == ()
