"""A Dask cluster on this machine, all of it in processes of its own, for the tests and benchmarks of tuning on one."""

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gyrodrift.session.files import write_session
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats

PATIENCE_S = 240.0

Process = subprocess.Popen[bytes]


@dataclass(frozen=True, slots=True)
class Cluster:
    """Its scheduler and workers; each worker is a nanny that starts a process, and another one when that dies."""

    address: str
    scheduler: Process
    workers: Process


@contextmanager
def cluster(folder: Path, workers: int, *options: str) -> Iterator[Cluster]:
    """So many workers of one thread each, ready."""
    log = folder / "cluster.log"
    started = [_started(log, "scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard")]
    kind = ("--nworkers", str(workers), "--nthreads", "1", "--no-dashboard", "--local-directory", str(folder))
    try:
        address = _awaited(log, r"Scheduler at:\s+(tcp://\S+)")[0]
        started.append(_started(log, "worker", address, *kind, *options))
        _awaited(log, "Starting established connection", 2 * workers)  # the scheduler says so too
        yield Cluster(address, *started)
    finally:
        for process in reversed(started):
            end(process)


def end(process: Process) -> None:
    """Kill it with all that it started."""
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def _started(log: Path, *command: str) -> Process:
    """Leader of a group of its own."""
    with log.open("ab") as stderr:
        return subprocess.Popen(
            [sys.executable, "-m", "dask", *command],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=stderr,
            start_new_session=True,
        )


def _awaited(log: Path, pattern: str, count: int = 1) -> list[str]:
    """All matches of a pattern in a log, as soon as there are so many."""
    until_s = time.monotonic() + PATIENCE_S
    while len(matches := re.findall(pattern, log.read_text())) < count:
        assert time.monotonic() < until_s, log.read_text()
        time.sleep(0.05)
    return matches


def recorded(path: Path, samples: int, seed: int, rate_hz: float = 100.0) -> Path:
    """A session of rests and slow turns with a bias and noise."""
    dice = np.random.default_rng(seed)
    t_s: Floats = np.arange(samples) / rate_hz + dice.uniform(0.0, 2e-5, samples)
    true_dps = np.where(t_s % 40.0 > 25.0, 30.0 * np.sin(2.0 * np.pi * t_s / 15.0), 0.0)
    encoder_deg = np.cumsum(true_dps) / rate_hz
    rate_dps = true_dps + 0.2 + dice.normal(0.0, 0.1, samples)
    write_session(path, [Session(path.stem, t_s, rate_dps, t_s + 1.7e9, np.arange(samples), encoder_deg)])
    return path


def candidates(count: int) -> Floats:
    """Over the ranges that tuning searches."""
    dice = np.random.default_rng(count)
    searched = ((1e-6, 0.1), (1e-3, 30.0), (0.02, 20.0))
    factors = [10.0 ** dice.uniform(np.log10(low), np.log10(high), count) for low, high in searched]
    return np.column_stack([*factors, *dice.uniform(0.0, 3.0, (2, count))])
