"""Workers and the process that forked them."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from gyrodrift.io.parallel import workers

PATIENCE_S = 240.0

PROGRAM = """
import os, sys, time
from gyrodrift.io.parallel import workers

def work(_, number):
    with open(f"{sys.argv[1]}/{os.getpid()}", "w"):
        time.sleep(600)

with workers(2, None) as pool:
    list(pool.map(work, range(2)))
"""


def is_alive(pid: int) -> bool:
    """Whether a process runs; a zombie does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] not in {"Z", "X"}
    except (FileNotFoundError, ProcessLookupError):
        return False


@pytest.mark.promise("Crashes")
def test_workers_end_when_the_process_that_forked_them_is_killed(tmp_path: Path) -> None:
    """Workers of `diagnose`, `tune` and `compare` end when the command is killed."""
    until_s = time.monotonic() + PATIENCE_S
    with subprocess.Popen([sys.executable, "-c", PROGRAM, str(tmp_path)]) as parent:
        while len(os.listdir(tmp_path)) < 2 and time.monotonic() < until_s:  # noqa: PTH208
            time.sleep(0.01)
        pids = [int(name.name) for name in tmp_path.iterdir()]
        parent.kill()
    while any(map(is_alive, pids)) and time.monotonic() < until_s:
        time.sleep(0.01)
    assert len(pids) == 2
    assert not any(map(is_alive, pids))


def doubled(inherited: Callable[[int], int], item: int) -> int:
    return inherited(item)


@pytest.mark.parametrize("jobs", [1, 2])
def test_processes_inherit_what_cannot_be_sent(jobs: int) -> None:
    """A function without a name is not picklable; results come in the order of the items."""
    with workers(jobs, lambda item: 2 * item) as local:
        assert list(local.map(doubled, [1, 2, 3])) == [2, 4, 6]


def ignores_ctrl_c(_: None, signal_number: int) -> bool:
    return signal.getsignal(signal_number) is signal.SIG_IGN


def test_processes_that_inherit_leave_ctrl_c_to_their_parent() -> None:
    """A worker that dies with a lock blocks the others."""
    with workers(2, None) as local:
        assert list(local.map(ignores_ctrl_c, [signal.SIGINT, signal.SIGTERM])) == [True, False]
