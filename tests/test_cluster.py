"""The workers of a cluster: what they give, what is said where they fail or are lost, and a tuning on them."""

import operator
import os
import signal
import socket
import sys
import time
from contextlib import closing
from pathlib import Path

import dask
import pytest
from cluster_support import Cluster, cluster, end
from support import PATIENCE_S, Command, free_port, quick
from turntable_sessions import write_turntables

from gyrodrift.cli import main
from gyrodrift.io import parallel as cluster_module
from gyrodrift.io.parallel import ClusterWorkers
from gyrodrift.session.files import load_session
from gyrodrift.values.errors import DataError, GyrodriftError, UsageError

distributed = pytest.importorskip("distributed", reason="a cluster is an extra: pip install 'gyrodrift[cluster]'")

pytestmark = pytest.mark.xdist_group("cluster")

LONG_S = 60.0
"""Duration of a task that must still run when its cluster is lost, s."""


def test_results_come_in_the_order_of_their_tasks(shared: Cluster) -> None:
    """The order of completion does not matter; a task may use the result of an earlier task."""
    with closing(ClusterWorkers(shared.address, "a test")) as workers:
        assert workers.threads == 2
        slow = workers.submit(time.sleep, [0.5])
        powers = workers.submit(operator.pow, range(20), [2] * 20)
        sums = workers.submit(operator.add, powers, powers)
        assert workers.results([*slow, *sums]) == [None, *(2 * value**2 for value in range(20))]
        assert workers.results([]) == []


def test_an_error_of_gyrodrift_is_raised_unchanged(shared: Cluster, tmp_path: Path) -> None:
    """The error of the first failed task is raised."""
    with closing(ClusterWorkers(shared.address, "a test")) as workers:
        tasks = workers.submit(load_session, [tmp_path / "a.csv", tmp_path / "b.csv"])
        with pytest.raises(DataError, match=r"/a\.csv: there is no such session"):
            workers.results(tasks)


def test_another_error_names_the_scheduler(shared: Cluster) -> None:
    """The message has the scheduler, the type of the error and its text."""
    with (
        closing(ClusterWorkers(shared.address, "a test")) as workers,
        pytest.raises(GyrodriftError, match=r"^tcp://.*: a task failed: ValueError: could not convert .*'no number'"),
    ):
        workers.results(workers.submit(float, ["no number"]))


def silent() -> socket.socket:
    """A port that accepts connections and sends nothing."""
    return socket.create_server(("127.0.0.1", 0))


@pytest.mark.parametrize("address", ["closed port", "silent server", "nonsense:port", "no.such.host.invalid:8786"])
def test_a_missing_scheduler_is_reported_within_seconds(
    address: str, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The message is a line, without output of Dask, whose own patience has no part in it."""
    monkeypatch.setattr(cluster_module, "CONNECT_S", 0.3)
    with silent() as server, dask.config.set({"distributed.comm.timeouts.connect": "1 h"}):
        addresses = {
            "closed port": f"tcp://127.0.0.1:{free_port()}",
            "silent server": f"127.0.0.1:{server.getsockname()[1]}",
        }
        with pytest.raises(UsageError, match=r"no Dask scheduler answers there") as raised:
            ClusterWorkers(addresses.get(address, address), "a test")
    assert "\n" not in str(raised.value)
    assert capfd.readouterr().err == ""


def test_the_address_of_a_worker_is_refused(shared: Cluster) -> None:
    with closing(ClusterWorkers(shared.address, "a test")) as workers:
        address = next(iter(workers._client.run(os.getpid)))
    with pytest.raises(UsageError, match=r"no Dask scheduler answers there \(it is a Worker\)"):
        ClusterWorkers(address, "a test")


def test_a_missing_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """The message has its purpose and the command that installs it."""
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(
        UsageError, match=r"^tuning on a cluster needs the package distributed: .*install .*\[cluster\]"
    ):
        ClusterWorkers("tcp://127.0.0.1:8786", "tuning")


@pytest.mark.parametrize("number", quick([signal.SIGKILL, signal.SIGSTOP], signal.SIGSTOP))
def test_the_loss_of_the_scheduler_ends_the_wait(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], number: signal.Signals
) -> None:
    monkeypatch.setattr(cluster_module, "ANSWER_S", 1.0)
    monkeypatch.setattr(cluster_module, "CONNECT_S", 2.0)
    with cluster(tmp_path, 1) as alone:
        with closing(ClusterWorkers(alone.address, "a test")) as workers:
            tasks = workers.submit(time.sleep, [LONG_S])
            os.kill(alone.scheduler.pid, number)
            with pytest.raises(GyrodriftError, match=r"^tcp://.*: the Dask scheduler is gone"):
                workers.results(tasks)
            with pytest.raises(GyrodriftError, match=r"^tcp://.*: the Dask scheduler is gone"):
                workers.results(workers.submit(operator.neg, tasks))
        assert capfd.readouterr().err == ""


def test_the_loss_of_all_workers_ends_the_wait(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster_module, "NO_WORKER_S", 2.0)
    monkeypatch.setattr(cluster_module, "FIRST_WORKER_S", 0.5)
    with cluster(tmp_path, 1) as alone:
        with closing(ClusterWorkers(alone.address, "a test")) as workers:
            tasks = workers.submit(time.sleep, [LONG_S])
            end(alone.workers)
            with pytest.raises(GyrodriftError, match="no worker for"):
                workers.results(tasks)
        with pytest.raises(UsageError, match="this scheduler has no workers; start some with `dask worker tcp:"):
            ClusterWorkers(alone.address, "a test")


def without_command(path: Path) -> list[str]:
    """A config but for the line that says how it was asked for."""
    return [line for line in path.read_text().splitlines() if not line.startswith(("  command:", "    "))]


def test_a_cluster_that_loses_a_worker_half_way_tunes_as_this_machine_does(tmp_path: Path, shared: Cluster) -> None:
    sessions, out = tmp_path / "sessions", tmp_path / "shared.yaml"
    write_turntables(sessions, 4)
    arguments = ["tune", str(sessions), "--filter", "hdr", "--iterations", "200", "--seed", "1"]
    with (
        Command(*arguments, "--out", out, "--cluster", shared.address) as tune,
        distributed.Client(shared.address, set_as_default=False) as client,
    ):
        tune.until(lambda _: any(client.has_what().values()), "session on a worker")
        os.kill(client.run(os.getpid).popitem()[1], signal.SIGKILL)
        assert tune.end() == 0, tune.log
        client.wait_for_workers(2, timeout=PATIENCE_S)
    assert main([*arguments, "--out", str(tmp_path / "here.yaml")]) == 0
    assert without_command(out) == without_command(tmp_path / "here.yaml")


def test_a_cluster_that_is_not_there_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster_module, "CONNECT_S", 0.3)
    sessions = tmp_path / "sessions"
    write_turntables(sessions, 2)
    request = ["tune", str(sessions), "--out", str(tmp_path / "c.yaml"), "--cluster", "tcp://127.0.0.1:9"]
    assert main(request) == 2
    assert "tcp://127.0.0.1:9: no Dask scheduler answers there" in capsys.readouterr().err
    assert not (tmp_path / "c.yaml").exists()
