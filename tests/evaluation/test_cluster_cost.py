"""Cost on a cluster: the same bits as in this process, also after workers die."""

import os
import signal
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cluster_support import PATIENCE_S, Cluster, candidates, recorded

from gyrodrift.evaluation import cluster_cost
from gyrodrift.evaluation.cluster_cost import ClusterCost, load_batch
from gyrodrift.evaluation.cost import BLOCK, Cost, Scores
from gyrodrift.evaluation.dataset import Source, load_with_reference
from gyrodrift.session.files import load_session, write_session
from gyrodrift.values.errors import DataError, GyrodriftError, UsageError

pytest.importorskip("distributed", reason="tuning on a cluster is an extra: pip install 'gyrodrift[cluster]'")

pytestmark = pytest.mark.xdist_group("cluster")

Sessions = list[tuple[Path, bool]]


@pytest.fixture(scope="module")
def sessions(tmp_path_factory: pytest.TempPathFactory) -> Sessions:
    """Sessions of many lengths, with a text file and a still."""
    folder = tmp_path_factory.mktemp("sessions")
    paths = [(recorded(folder / f"turn-{seed}.mcap", 4500 + 371 * seed, seed), False) for seed in range(8)]
    text = folder / "text.csv"
    write_session(text, [load_session(paths[0][0])])
    return [*paths[:3], (text, False), *paths[3:], (recorded(folder / "still.mcap", 3000, 99), True)]


@pytest.fixture
def local(sessions: Sessions) -> Iterator[Cost]:
    """Cost of these sessions in this process."""
    with Cost(load_with_reference(Source(path, is_still)).reference for path, is_still in sessions) as cost:
        yield cost


def assert_same(ours: Scores, expected: Scores) -> None:
    for name in ("mean_squares", "mean_absolutes", "worst", "pi"):
        np.testing.assert_array_equal(getattr(ours, name), getattr(expected, name))


def pids(cost: ClusterCost) -> dict[str, int]:
    """Process ids of the workers, by address."""
    return dict(cost._workers._client.run(os.getpid))


def await_both(cost: ClusterCost) -> None:
    """Wait until a nanny has replaced a killed worker."""
    cost._workers._client.wait_for_workers(2, timeout=PATIENCE_S)


def before_results(cost: ClusterCost, action: Callable[[], None]) -> None:
    """Call `action` once, after the next tasks are sent and before their results are fetched."""
    results = cost._workers.results

    def patched(tasks: Sequence[Any]) -> list[Any]:
        cost._workers.results = results  # type: ignore[method-assign]  # a test may
        action()
        return results(tasks)

    cost._workers.results = patched  # type: ignore[method-assign]  # likewise


@pytest.mark.parametrize("count", [11, BLOCK + 37])
def test_scores_equal_scores_of_this_process(shared: Cluster, sessions: Sessions, local: Cost, count: int) -> None:
    """Bit for bit and in the order of the sessions, for all sessions and for some."""
    params = candidates(count)
    with ClusterCost(shared.address, sessions) as cost:
        assert cost.threads == 2
        assert_same(cost.cost(params), local.cost(params))
        assert_same(cost.cost(params, [9, 0, 4]), local.cost(params, [9, 0, 4]))
        np.testing.assert_array_equal(cost.pi(params, range(1, 6)), local.pi(params, range(1, 6)))
        assert cost.evaluations == 3 * count


def test_no_candidates_and_no_sessions_cost_nothing(shared: Cluster, sessions: Sessions) -> None:
    """The shapes of the results are right."""
    with ClusterCost(shared.address, sessions[:2]) as cost:
        assert cost.cost(np.empty((0, 5))).worst.shape == (2, 0)
        assert cost.cost(candidates(3), []).worst.shape == (0, 3)


def test_descriptions_equal_descriptions_of_this_process(shared: Cluster, sessions: Sessions) -> None:
    """Name, digest, duration, sample rate and warnings."""
    with ClusterCost(shared.address, sessions) as cost:
        assert cost.descriptions == tuple(
            load_with_reference(Source(path, is_still)).description for path, is_still in sessions
        )


def test_batches_are_of_about_the_same_size(sessions: Sessions) -> None:
    paths = [path for path, _ in sessions]
    edges = cluster_cost._edges(paths, 2)
    sizes = [sum(path.stat().st_size for path in paths[first:last]) for first, last in pairwise(edges)]
    assert len(sizes) == 2 * cluster_cost.BATCHES_PER_THREAD
    assert max(sizes) < 2 * min(sizes)
    assert cluster_cost._edges(paths, 100) == list(range(len(paths) + 1))
    assert cluster_cost._edges([Path("/elsewhere/a.mcap")] * 1000, 1) == [0, 249, 499, 749, 1000]


def test_a_worker_that_is_killed_changes_nothing(shared: Cluster, sessions: Sessions, local: Cost) -> None:
    params = candidates(BLOCK)
    with ClusterCost(shared.address, sessions) as cost:
        keys_by_address = cost._workers._client.has_what()
        address, pid = next((address, pid) for address, pid in pids(cost).items() if keys_by_address[address])
        before_results(cost, lambda: os.kill(pid, signal.SIGKILL))
        assert_same(cost.cost(params), local.cost(params))
        await_both(cost)
        assert pids(cost).get(address) != pid


@pytest.mark.evaluation
def test_a_worker_that_is_killed_while_results_are_brought_changes_nothing(
    shared: Cluster, sessions: Sessions, local: Cost
) -> None:
    params = candidates(64)
    with ClusterCost(shared.address, sessions) as cost:
        results = cost._workers.results

        def kill_and_bring(tasks: Sequence[Any]) -> list[Any]:
            cost._workers.results = results  # type: ignore[method-assign]  # a test may
            with cost._workers._client.as_current():
                cost._workers._dask.wait(tasks)
            os.kill(next(iter(pids(cost).values())), signal.SIGKILL)
            return results(tasks)

        cost._workers.results = kill_and_bring  # type: ignore[method-assign]  # likewise
        assert_same(cost.cost(params), local.cost(params))
        await_both(cost)


@pytest.mark.parametrize("damage", ["missing", "no session"])
def test_a_session_that_cannot_be_read_raises_the_same_error(
    shared: Cluster, sessions: Sessions, tmp_path: Path, damage: str
) -> None:
    """The error names the first such session."""
    path = tmp_path / "bad.mcap"
    if damage == "no session":
        path.write_bytes(b"no session\n")
    with pytest.raises(DataError) as here:
        load_with_reference(Source(path))
    bad = [*sessions[:4], (path, False), *sessions[4:], (tmp_path / "never.mcap", False)]
    with pytest.raises(DataError) as there:
        ClusterCost(shared.address, bad)
    assert str(there.value) == str(here.value)
    assert str(path) in str(there.value)


def test_another_version_on_a_worker_is_refused() -> None:
    with pytest.raises(UsageError, match=r"has gyrodrift .*, this machine 0\.0\.0; install the same"):
        load_batch([], "0.0.0")


def test_another_error_of_a_task_names_the_scheduler(shared: Cluster, sessions: Sessions) -> None:
    with (
        ClusterCost(shared.address, sessions[:1]) as cost,
        pytest.raises(GyrodriftError, match=r"^tcp://.*: a task failed: ValueError: .* five columns"),
    ):
        cost.cost(np.zeros((2, 4)))
