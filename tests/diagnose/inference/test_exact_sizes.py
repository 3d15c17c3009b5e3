"""Sizes between those of the grid: found by simulations at these very sizes, and never made worse."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from inference_support import SESSIONS, evidence, exactly, random_response, response, rows

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.inference.evidence import Response
from gyrodrift.diagnose.inference.exact_sizes import ROUNDS, Placed, exact_sizes
from gyrodrift.diagnose.inference.surrogate import Cause, Surrogate
from gyrodrift.diagnose.simulate.grids import PHASES_DEG
from gyrodrift.diagnose.simulate.response_table import SimulatedSet

LATE = response("latency", {"acceleration": 30.0, "rate": 2.0})
WARM = response("temp_bias", {"temperature": 20.0})
AT_3, AT_2 = Cause(LATE, 2), Cause(WARM, 1)


class Simulator:
    """Says of a latency something else than its table, a straight line; keeps the sizes that it was asked for."""

    def __init__(self) -> None:
        self.asked: list[list[float]] = []

    def __call__(self, placed: Sequence[Placed]) -> SimulatedSet:
        self.asked.append([one.size for one in placed])
        done = {one.cause.name: one.size for one in placed}
        return exactly(does(done.get("latency", 0.0), done.get("temp_bias", 0.0)))


def does(late_ms: float, slope_dps_per_c: float = 0.0) -> Floats:
    """(sessions, F) by the simulator."""
    bent = 24.0 * late_ms + 2.0 * late_ms**2
    return rows({"acceleration": bent, "rate": 2.0 * late_ms, "temperature": 20.0 * slope_dps_per_c})


def surrogate_of(difference: Floats, *causes: Cause) -> Surrogate:
    """It was simulated at the sizes of the grid."""
    surrogate = Surrogate(evidence(difference, *(cause.response for cause in causes)))
    return surrogate.refined(causes, Simulator()([Placed(cause, cause.size) for cause in causes]))


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

    def contrary(placed: Sequence[Placed]) -> SimulatedSet:
        return exactly(does(6.0 - placed[0].size))

    assert exact_sizes(surrogate_of(does(3.4), AT_3), (AT_3,), contrary)["latency"].size == 3.0


def test_what_is_linear_needs_no_simulation() -> None:
    """Its table is exact."""
    both_ways = replace(LATE.candidate, grid_points=np.array([-1.0, 1.0]))
    cause = Cause(Response(both_ways, LATE.mean, LATE.spread), 2)
    simulate = Simulator()
    found = exact_sizes(surrogate_of(does(3.0) + rows({"acceleration": 6.0}), cause), (cause,), simulate)
    assert found["latency"].size == pytest.approx(3.2, abs=0.01)
    assert not simulate.asked


@pytest.mark.parametrize("seed", range(6))
def test_a_phase_between_two_of_twelve_is_found_with_its_size(seed: int) -> None:
    """Of a tilt beside an absolute encoder, whose table knows sine and cosine, wherever it is."""
    rng = np.random.default_rng(seed)
    size, phase_deg = float(rng.uniform(2.0, 7.0)), float(rng.uniform(0.0, 360.0))

    def tilt(amplitude: float, at_deg: float) -> Floats:
        sine, cosine = np.sin(np.deg2rad(at_deg)), np.cos(np.deg2rad(at_deg))
        return rows({"turn_sine": 30.0 * amplitude * cosine, "turn_cosine": 30.0 * amplitude * sine})

    def simulate(placed: Sequence[Placed]) -> SimulatedSet:
        return exactly(tilt(placed[0].size, placed[0].phase_deg or 0.0))

    def turned(at_deg: float) -> Response:
        table = response("g_sensitivity", {})
        mean = np.array([tilt(each, at_deg) for each in table.candidate.sizes])
        return Response(replace(table.candidate, phase_deg=at_deg), mean, table.spread)

    twelve = [turned(at_deg) for at_deg in PHASES_DEG]
    nearest = min(twelve, key=lambda one: abs((at_of(one) - phase_deg + 180.0) % 360.0 - 180.0))
    cause = Cause(nearest, int(np.abs(nearest.candidate.sizes - size).argmin()))
    found = exact_sizes(Surrogate(evidence(tilt(size, phase_deg), *twelve)), (cause,), simulate)["g_sensitivity"]
    assert found.phase_deg is not None
    assert abs((found.phase_deg - phase_deg + 180.0) % 360.0 - 180.0) < 1.0
    assert found.size == pytest.approx(size, rel=0.01)
    assert 0.0 < found.phase_error_deg < 1.0


def at_of(one: Response) -> float:
    """Its phase, degrees."""
    assert one.candidate.phase_deg is not None
    return one.candidate.phase_deg


def test_what_is_random_or_has_one_size_stays_as_it_is() -> None:
    """There is no slope."""
    walk = Cause(random_response("rate_random_walk", {"time": 3.0}), 0)
    read = Cause(response("clock_drift", {"clock_ratio": 3.0}, np.array([2.0])), 0)
    assert exact_sizes(surrogate_of(does(0.0), walk, read), (walk, read), Simulator()) == {}
