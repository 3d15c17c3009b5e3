"""Tuning on a real cluster of two worker processes, from the command line."""

import os
import signal
from pathlib import Path

import pytest
from cluster_support import Cluster
from support import PATIENCE_S, Command
from turntable_sessions import write_turntables

from gyrodrift.cli import main

distributed = pytest.importorskip(
    "distributed", reason="tuning on a cluster is an extra: pip install 'gyrodrift[cluster]'"
)

pytestmark = pytest.mark.xdist_group("cluster")


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


def test_a_cluster_that_is_not_there_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    sessions = tmp_path / "sessions"
    write_turntables(sessions, 2)
    request = ["tune", str(sessions), "--out", str(tmp_path / "c.yaml"), "--cluster", "tcp://127.0.0.1:9"]
    assert main(request) == 2
    assert "tcp://127.0.0.1:9: no Dask scheduler answers there" in capsys.readouterr().err
    assert not (tmp_path / "c.yaml").exists()
