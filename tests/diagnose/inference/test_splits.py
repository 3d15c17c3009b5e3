"""Two that do nearly the same, on a toy whose tables do not add: a delay and a low-pass."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from inference_support import SESSIONS, candidate, evidence, exactly, random_response, response, rows

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.vector import FEATURES
from gyrodrift.diagnose.inference.evidence import Response
from gyrodrift.diagnose.inference.fit import CauseSet
from gyrodrift.diagnose.inference.search import search
from gyrodrift.diagnose.inference.splits import with_its_kin
from gyrodrift.diagnose.inference.surrogate import Cause, Surrogate
from gyrodrift.diagnose.simulate.response_table import SimulatedSet

SIZES = np.geomspace(1.0, 10.0, 25)


def does(late: float, smoothed: float) -> Floats:
    """(sessions, F): both come late, the bend goes with the square of all that does, and a low-pass leaves a trace."""
    whole = late + smoothed
    return rows({"lag": 20.0 * whole, "lag_bend": 0.8 * whole**2, "lag_twist": 3.0 * smoothed})


def simulate(causes: Sequence[Cause]) -> SimulatedSet:
    """By this device."""
    sizes = {cause.name: cause.size for cause in causes}
    return exactly(does(sizes.get("latency", 0.0), sizes.get("bandwidth", 0.0)))


def tables() -> tuple[Response, ...]:
    """Of each by itself."""
    none = np.zeros((len(SIZES), len(FEATURES)))
    alone = {"latency": [does(size, 0.0) for size in SIZES], "bandwidth": [does(0.0, size) for size in SIZES]}
    return tuple(Response(candidate(name, SIZES), np.array(means), none) for name, means in alone.items())


@pytest.mark.parametrize("seed", range(6))
def test_how_much_is_the_delay_and_how_much_the_low_pass(seed: int) -> None:
    """Whatever their sizes."""
    late, smoothed = np.exp(np.random.default_rng(seed).uniform(np.log(2.0), np.log(9.0), 2)).tolist()
    found = search(evidence(does(late, smoothed), *tables()), simulate).found
    sizes = {cause.name: cause.size for cause in found.causes}
    assert sizes == {"latency": pytest.approx(late, rel=0.2), "bandwidth": pytest.approx(smoothed, rel=0.2)}


def test_a_pair_is_made_with_what_is_of_the_same_group_and_does_not_add() -> None:
    """No walk, which chance makes, no gain, which is of another kind; and the tables of two straight lines do add."""
    gain, walk = (
        response("scale_factor", {"rate": 1.0}, SIZES),
        random_response("rate_random_walk", {"time": 1.0}, SIZES),
    )
    late, smoothed = tables()
    surrogate = Surrogate(evidence(does(3.0, 4.0), late, smoothed, gain, walk))
    single = CauseSet((Cause(smoothed, 20),), surrogate.scores(()))
    (pair,), known = with_its_kin(surrogate, single, simulate)
    assert pair.names == ("bandwidth", "latency")
    assert sum(cause.size for cause in pair.causes) == pytest.approx(7.0, rel=0.1)
    assert known.knows(pair.causes)
    assert with_its_kin(surrogate, CauseSet((Cause(gain, 0),), surrogate.scores(())), simulate)[0] == []
    lines = [replace(one, candidate=replace(one.candidate, grid_points=np.array([-1.0, 1.0]))) for one in tables()]
    straight = Surrogate(evidence(does(3.0, 4.0), *lines))
    assert with_its_kin(straight, CauseSet((Cause(lines[1], 20),), straight.scores(())), simulate)[0] == []


@pytest.mark.parametrize("name", ["latency", "bandwidth"])
def test_one_alone_stays_alone(name: str) -> None:
    """The other has no part in it."""
    is_late = name == "latency"
    true = does(SIZES[12], 0.0) if is_late else does(0.0, SIZES[12])
    found = search(evidence(true, *tables()), simulate).found
    assert found.names == (name,)
    assert len(found.scores) == SESSIONS
