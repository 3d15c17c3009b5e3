"""Sizes between those of the grid: found by simulations at these very sizes, and never made worse."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from inference_support import SESSIONS, evidence, exactly, random_response, response, rows

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.inference.evidence import Response
from gyrodrift.diagnose.inference.exact_sizes import ROUNDS, exact_sizes
from gyrodrift.diagnose.inference.surrogate import Cause, Surrogate
from gyrodrift.diagnose.simulate.response_table import SimulatedSet

LATE = response("latency", {"acceleration": 30.0, "rate": 2.0})
WARM = response("temp_bias", {"temperature": 20.0})
AT_3, AT_2 = Cause(LATE, 2), Cause(WARM, 1)


class Simulator:
    """Says of a latency something else than its table, a straight line; keeps the sizes that it was asked for."""

    def __init__(self) -> None:
        self.asked: list[list[float]] = []

    def __call__(self, causes: Sequence[Cause], sizes: Sequence[float]) -> SimulatedSet:
        self.asked.append(list(sizes))
        done = {cause.name: size for cause, size in zip(causes, sizes, strict=True)}
        return exactly(does(done.get("latency", 0.0), done.get("temp_bias", 0.0)))


def does(late_ms: float, slope_dps_per_c: float = 0.0) -> Floats:
    """(sessions, F) by the simulator."""
    bent = 24.0 * late_ms + 2.0 * late_ms**2
    return rows({"acceleration": bent, "rate": 2.0 * late_ms, "temperature": 20.0 * slope_dps_per_c})


def surrogate_of(difference: Floats, *causes: Cause) -> Surrogate:
    """It was simulated at the sizes of the grid."""
    surrogate = Surrogate(evidence(difference, *(cause.response for cause in causes)))
    return surrogate.refined(causes, Simulator()(causes, [cause.size for cause in causes]))


@pytest.mark.parametrize("true", [2.6, 2.95, 3.0, 3.4])
def test_a_size_between_those_of_the_grid_is_found_where_the_table_is_not_straight(true: float) -> None:
    """To less than a standard error, in few simulations."""
    simulate = Simulator()
    found = exact_sizes(surrogate_of(does(true), AT_3), (AT_3,), simulate)["latency"]
    assert abs(found.size - true) < found.error
    assert found.error == pytest.approx(1.0 / (30.0**2 + 2.0**2) ** 0.5 / SESSIONS**0.5, rel=0.5)
    assert len(simulate.asked) <= ROUNDS


def test_two_are_found_together() -> None:
    """Each its own."""
    causes = (AT_3, AT_2)
    found = exact_sizes(surrogate_of(does(3.3, 2.2), *causes), causes, Simulator())
    assert found["latency"].size == pytest.approx(3.3, abs=0.02)
    assert found["temp_bias"].size == pytest.approx(2.2, abs=0.02)


def test_no_size_goes_beyond_its_neighbours() -> None:
    """What is further away is nothing that this cause explains."""
    assert exact_sizes(surrogate_of(does(6.0), AT_3), (AT_3,), Simulator())["latency"].size == 4.0


def test_a_step_that_explains_less_is_not_taken() -> None:
    """The simulator says the opposite of its table."""

    def contrary(causes: Sequence[Cause], sizes: Sequence[float]) -> SimulatedSet:
        return exactly(does(6.0 - sizes[0]))

    assert exact_sizes(surrogate_of(does(3.4), AT_3), (AT_3,), contrary)["latency"].size == 3.0


def test_what_is_linear_needs_no_simulation() -> None:
    """Its table is exact."""
    both_ways = replace(LATE.candidate, grid_points=np.array([-1.0, 1.0]))
    cause = Cause(Response(both_ways, LATE.mean, LATE.spread), 2)
    simulate = Simulator()
    found = exact_sizes(surrogate_of(does(3.0) + rows({"acceleration": 6.0}), cause), (cause,), simulate)
    assert found["latency"].size == pytest.approx(3.2, abs=0.01)
    assert not simulate.asked


def test_what_is_random_or_has_one_size_stays_as_it_is() -> None:
    """There is no slope."""
    walk = Cause(random_response("rate_random_walk", {"time": 3.0}), 0)
    read = Cause(response("clock_drift", {"clock_ratio": 3.0}, np.array([2.0])), 0)
    assert exact_sizes(surrogate_of(does(0.0), walk, read), (walk, read), Simulator()) == {}
