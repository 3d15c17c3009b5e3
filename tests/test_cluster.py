"""The workers of a cluster: what they give, what is said where they fail, and an end to waiting where they are lost."""

import operator
import os
import signal
import socket
import sys
import time
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest
from cluster_support import Cluster, cluster, end, free_port

from gyrodrift import cluster as room
from gyrodrift.cluster import ClusterWorkers
from gyrodrift.errors import DataError, GyrodriftError, UsageError
from gyrodrift.session.files import load_session

pytest.importorskip("distributed", reason="a cluster is an extra: pip install 'gyrodrift[cluster]'")

pytestmark = pytest.mark.xdist_group("cluster")

LONG_S = 60.0
"""What a task takes that is not to be done before its cluster is lost."""


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    """Two workers, for tests that leave the scheduler alive."""
    with cluster(tmp_path_factory.mktemp("cluster"), 2) as running:
        yield running


def test_results_come_in_the_order_of_their_tasks(shared: Cluster) -> None:
    """Whichever is done first; a task may take what an earlier one gives."""
    with closing(ClusterWorkers(shared.address, "a test")) as workers:
        assert workers.threads == 2
        slow = workers.submit(time.sleep, [0.5])
        powers = workers.submit(operator.pow, range(20), [2] * 20)
        sums = workers.submit(operator.add, powers, powers)
        assert workers.results([*slow, *sums]) == [None, *(2 * value**2 for value in range(20))]
        assert workers.results([]) == []


def test_an_error_of_ours_comes_as_it_was_raised(shared: Cluster, tmp_path: Path) -> None:
    """By the first task that failed."""
    with closing(ClusterWorkers(shared.address, "a test")) as workers:
        tasks = workers.submit(load_session, [tmp_path / "a.csv", tmp_path / "b.csv"])
        with pytest.raises(DataError, match=r"/a\.csv: there is no such session"):
            workers.results(tasks)


def test_any_other_error_says_where_it_comes_from(shared: Cluster) -> None:
    """The scheduler, the kind of error, and its words."""
    with (
        closing(ClusterWorkers(shared.address, "a test")) as workers,
        pytest.raises(GyrodriftError, match=r"^tcp://.*: a task failed: ValueError: could not convert .*'no number'"),
    ):
        workers.results(workers.submit(float, ["no number"]))


def silent() -> socket.socket:
    """A port that takes connections and says nothing."""
    return socket.create_server(("127.0.0.1", 0))


@pytest.mark.parametrize("address", ["nobody", "somebody else", "nonsense:port", "no.such.host.invalid:8786"])
def test_no_scheduler_is_said_soon(address: str, capfd: pytest.CaptureFixture[str]) -> None:
    """One line, and nothing of Dask's own."""
    begun_s = time.monotonic()
    with silent() as other:
        places = {"nobody": f"tcp://127.0.0.1:{free_port()}", "somebody else": f"127.0.0.1:{other.getsockname()[1]}"}
        with pytest.raises(UsageError, match=r"no Dask scheduler answers there") as said:
            ClusterWorkers(places.get(address, address), "a test")
    assert time.monotonic() - begun_s < 2 * room.CONNECT_S
    assert "\n" not in str(said.value)
    assert capfd.readouterr().err == ""


def test_a_worker_is_no_scheduler(shared: Cluster) -> None:
    """Its address is easily taken for the scheduler's."""
    with closing(ClusterWorkers(shared.address, "a test")) as workers:
        address = next(iter(workers._client.run(os.getpid)))
    with pytest.raises(UsageError, match=r"no Dask scheduler answers there \(it is a Worker\)"):
        ClusterWorkers(address, "a test")


def test_a_missing_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """With what it is needed for, and what to install."""
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(
        UsageError, match=r"^tuning on a cluster needs the package distributed: .*install .*\[cluster\]"
    ):
        ClusterWorkers("tcp://127.0.0.1:8786", "tuning")


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP], ids=["killed", "frozen"])
def test_a_scheduler_that_is_lost_ends_the_wait(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], number: signal.Signals
) -> None:
    """Killed or frozen while a task runs; and so it stays."""
    monkeypatch.setattr(room, "ANSWER_S", 1.0)
    monkeypatch.setattr(room, "CONNECT_S", 2.0)
    with cluster(tmp_path, 1) as alone:
        with closing(ClusterWorkers(alone.address, "a test")) as workers:
            tasks = workers.submit(time.sleep, [LONG_S])
            os.kill(alone.scheduler.pid, number)
            with pytest.raises(GyrodriftError, match=r"^tcp://.*: the Dask scheduler is gone"):
                workers.results(tasks)
            with pytest.raises(GyrodriftError, match=r"^tcp://.*: the Dask scheduler is gone"):
                workers.results(workers.submit(operator.neg, tasks))
        assert capfd.readouterr().err == ""


def test_workers_that_are_gone_for_good_end_the_wait(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nannies included; whoever comes later finds a scheduler without workers."""
    monkeypatch.setattr(room, "NO_WORKER_S", 2.0)
    monkeypatch.setattr(room, "FIRST_WORKER_S", 0.5)
    with cluster(tmp_path, 1) as alone:
        with closing(ClusterWorkers(alone.address, "a test")) as workers:
            tasks = workers.submit(time.sleep, [LONG_S])
            end(alone.workers)
            with pytest.raises(GyrodriftError, match="no worker for"):
                workers.results(tasks)
        with pytest.raises(UsageError, match="this scheduler has no workers; start some with `dask worker tcp:"):
            ClusterWorkers(alone.address, "a test")
