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
    assert pooled_z(np.array(z)[:, None])[0] == pytest.approx(pooled)


def test_what_deviates_is_listed_worst_first_with_its_share() -> None:
    result = deviations(row({"rate": 5.0, "abs_rate": -40.0, "lag": 4.4}), 4.5)
    assert [(item.feature, item.z) for item in result] == [("abs_rate", -40.0), ("rate", 5.0)]
    assert [item.share for item in result] == pytest.approx([400.0 / 425.0, 25.0 / 425.0])
    assert result[0].stage == "sensor"


def test_the_worst_features_are_listed_where_none_passes_the_threshold() -> None:
    z = row({"rate": 2.0, "abs_rate": -3.0, "lag": 1.0})
    assert deviations(z, 4.5) == ()
    assert [item.feature for item in deviations(z, 4.5, least=2)] == ["abs_rate", "rate"]


def test_features_are_listed_in_a_given_order() -> None:
    z = row({"rate": 3.0, "abs_rate": 4.0})
    result = listed([NUMBER["rate"], NUMBER["abs_rate"]], z)
    assert [deviation.feature for deviation in result] == ["rate", "abs_rate"]
    assert [deviation.share for deviation in result] == pytest.approx([9.0 / 25.0, 16.0 / 25.0])
    assert [item.share for item in shared(result[:1])] == [1.0]
    assert shared([]) == ()
