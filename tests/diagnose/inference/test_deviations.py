"""Which features deviate: normal deviates of several sessions in one, and what each has of all."""

import numpy as np
import pytest
from gyrodrift.diagnose.inference.fit import CauseSet
from gyrodrift.diagnose.inference.surrogate import Cause, Surrogate
from inference_support import evidence, response, rows

from gyrodrift.diagnose.features.vector import NUMBER
from gyrodrift.diagnose.inference.deviations import (
    Deviation,
    deviations,
    explained_share,
    held_out_z,
    moved_by,
    worst_first,
)
from gyrodrift.diagnose.inference.family_wise import pooled_z


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
    found = deviations(rows({"rate": 5.0, "abs_rate": -40.0, "lag": 4.4})[0], 4.5)
    assert [(one.feature, one.z) for one in found] == [("abs_rate", -40.0), ("rate", 5.0)]
    assert [one.share for one in found] == pytest.approx([400.0 / 425.0, 25.0 / 425.0])
    assert found[0].stage == "sensor"


@pytest.mark.parametrize(
    ("off", "stage"),
    [
        ({"equal_moving": 9.0}, "link"),
        ({"equal_moving": 9.0, "equal_rest": 8.0}, "sensor"),
        ({"equal_moving": 9.0, "equal_rest": 8.0, "equal_quick": 5.0}, "link"),
    ],
)
def test_values_that_are_equal_at_rest_too_are_the_sensors(off: dict[str, float], stage: str) -> None:
    """Unless they repeat while the rate changes."""
    assert deviations(rows(off)[0], 4.5)[0].stage == stage


def test_a_feature_is_listed_once() -> None:
    """Where it is worse."""
    one, other = (Deviation("sensor", "rate", "moving", "", z) for z in (6.0, -9.0))
    assert [(found.z, found.share) for found in worst_first([one, other])] == [(-9.0, 1.0)]
    assert worst_first([]) == ()


def test_explained_is_the_share_of_squares_that_is_gone() -> None:
    """Of what deviates alone; below 0 where a cause adds to it."""
    deviates = np.array([True, True, False])
    assert explained_share(deviates, np.array([6.0, 8.0, 1.0]), np.array([0.0, 5.0, 9.0])) == pytest.approx(
        1.0 - 24.0 / 98.0
    )
    assert explained_share(deviates, np.array([6.0, 8.0, 1.0]), np.array([10.0, 10.0, 0.0])) == pytest.approx(
        1.0 - 198.0 / 98.0
    )


def test_what_a_session_leaves_is_judged_by_the_sizes_of_the_others() -> None:
    """One that differs from three others is left with its difference, and takes nothing from them."""
    rate = response("scale_factor", {"rate": 2.0})
    difference = rows({"rate": 6.0})
    difference[3, NUMBER["rate"]] = 16.0
    surrogate = Surrogate(evidence(difference, rate))
    z = held_out_z(surrogate, CauseSet((Cause(rate, 2),), np.zeros(4)))[:, NUMBER["rate"]]
    assert z[:3] == pytest.approx([0.0, 0.0, 0.0])
    assert z[3] == pytest.approx(10.0 / np.sqrt(1.0 + 0.6**2 + (0.04 * 6.0) ** 2))


def test_without_causes_all_is_left() -> None:
    """As it was."""
    one = evidence({"rate": 6.0})
    assert np.array_equal(held_out_z(Surrogate(one), CauseSet((), np.zeros(4))), one.z)


def test_what_a_cause_moves_is_told_beside_the_others() -> None:
    """3 in each of four sessions are 6; what another moves is not its own."""
    rate, drift = response("scale_factor", {"rate": 1.0}), response("clock_drift", {"clock_ratio": 1.0})
    causes = (Cause(rate, 2), Cause(drift, 6))
    surrogate = Surrogate(evidence({"rate": 3.0, "clock_ratio": 7.0}, rate, drift))
    found = CauseSet(causes, surrogate.scores(causes))
    assert [moved_by(surrogate, found, one) for one in causes] == pytest.approx([6.0, 14.0])
