"""What tuning on a cluster costs beside tuning here: loading, evaluating, and what the messages add."""

import asyncio
import os
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from cluster_support import Cluster, candidates, cluster, recorded

from bench.harness import cpu_s, show
from gyrodrift import __version__
from gyrodrift.evaluation.cluster_cost import ClusterCost, descriptions_of, load_batch, score_batch
from gyrodrift.evaluation.cost import Cost
from gyrodrift.evaluation.dataset import Source, load_with_reference

distributed = pytest.importorskip(
    "distributed", reason="tuning on a cluster is an extra: pip install 'gyrodrift[cluster]'"
)

SHORT = 1000
LONG = 180_000
"""Samples of a session: ten seconds, and half an hour, at 100 Hz."""

SESSIONS = (10, 100, 1000)
CANDIDATES = (8, 64, 512)
LONG_SESSIONS = 12
ROUNDS = 3

Sessions = list[tuple[Path, bool]]


def seconds(work: Callable[[], object], clock: Callable[[], float] = time.perf_counter) -> float:
    """The least of a few calls: what else the machine does only adds."""
    found = []
    for _ in range(ROUNDS):
        begun_s = clock()
        work()
        found.append(clock() - begun_s)
    return min(found)


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> Sessions:
    folder = tmp_path_factory.mktemp("short")
    return [(recorded(folder / f"s{seed}.mcap", SHORT, seed), False) for seed in range(max(SESSIONS))]


@pytest.fixture(scope="module")
def long(tmp_path_factory: pytest.TempPathFactory) -> Sessions:
    folder = tmp_path_factory.mktemp("long")
    return [(recorded(folder / f"s{seed}.mcap", LONG, seed), False) for seed in range(LONG_SESSIONS)]


@pytest.fixture(scope="module", params=[1, 2])
def workers(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    """So many, of one thread; the thread that Dask keeps for long messages begins here, and stays."""
    asyncio.run(distributed.utils.offload(int))
    with cluster(tmp_path_factory.mktemp("cluster"), request.param) as running:
        yield running


def here(sessions: Sessions, threads: int) -> Cost:
    return Cost((load_with_reference(Source(path, is_still)).reference for path, is_still in sessions), threads)


def test_many_short_sessions(workers: Cluster, short: Sessions) -> None:
    """Messages more than work: what an evaluation costs at the least."""
    rows = []
    for count in SESSIONS:
        begun_s = time.perf_counter()
        with ClusterCost(workers.address, short[:count]) as there:
            rows.append((f"{count} sessions: joined and loaded", f"{time.perf_counter() - begun_s:.2f} s"))
            with here(short[:count], there.threads) as local:
                for many in CANDIDATES:
                    params = candidates(many)
                    np.testing.assert_array_equal(there.pi(params), local.pi(params))
                    ours_s, local_s = seconds(lambda: there.pi(params)), seconds(lambda: local.pi(params))  # noqa: B023 - called at once
                    name = f"{count} sessions, {many} candidates"
                    rows.append((name, f"{ours_s * 1e3:.1f} ms, here {local_s * 1e3:.1f} ms"))
    show(f"Sessions of {SHORT} samples, {there.threads} workers of one thread", [*rows, load()])


def test_half_hours(workers: Cluster, long: Sessions) -> None:
    """Work more than messages."""
    rows = []
    begun_s = time.perf_counter()
    with ClusterCost(workers.address, long) as there, here(long, there.threads) as local:
        rows.append(("joined and loaded, both", f"{time.perf_counter() - begun_s:.2f} s"))
        for many in CANDIDATES[:2]:
            params = candidates(many)
            np.testing.assert_array_equal(there.pi(params), local.pi(params))
            ours_s, local_s = seconds(lambda: there.pi(params)), seconds(lambda: local.pi(params))  # noqa: B023 - called at once
            ns = 1e9 * there.threads / (LONG * LONG_SESSIONS * many)
            rows.append((f"{many} candidates", f"{ours_s:.3f} s, here {local_s:.3f} s"))
            rows.append(("  per sample and candidate and thread", f"{ours_s * ns:.2f} ns, here {local_s * ns:.2f} ns"))
    show(f"{LONG_SESSIONS} sessions of {LONG} samples, {there.threads} workers of one thread", [*rows, load()])


def test_one_task(long: Sessions) -> None:
    """What a worker does, without the messages, in processor time."""
    sources = [Source(path) for path, _ in long[:4]]
    batch = load_batch(sources, __version__)
    params, places = candidates(64), np.arange(len(sources))
    score_batch(batch, places, params, "hdr")
    load_s = seconds(lambda: load_batch(sources, __version__), time.thread_time) / len(sources)
    score_s = seconds(lambda: score_batch(batch, places, params, "hdr"), time.thread_time)
    show(
        f"One thread, sessions of {LONG} samples",
        [
            ("file", f"{sources[0].path.stat().st_size / LONG:.1f} B/sample"),
            ("in memory", f"{batch.__sizeof__() / len(sources) / LONG:.1f} B/sample"),
            ("load, content hash included", f"{load_s * 1e3:.1f} ms/session"),
            ("kernel", f"{score_s / (LONG * len(sources) * len(params)) * 1e9:.2f} ns/sample/candidate"),
            load(),
        ],
    )


def test_a_task_more(workers: Cluster, short: Sessions) -> None:
    """What each further batch adds, where there is nothing to work out, and who pays for it."""
    params, rows, fixed_s = candidates(8), [], 0.0
    for batches in (1, 100, 1000):
        with ClusterCost(workers.address, short[:1] * batches) as there:
            there._edges = list(range(batches + 1))
            there._batches = there._workers.submit(load_batch, *_singly(short, batches))
            there._workers.results(there._workers.submit(descriptions_of, there._batches))
            before = cpu_s(workers.scheduler.pid), time.process_time()
            spent_s = seconds(lambda: there.pi(params))
            after = cpu_s(workers.scheduler.pid), time.process_time()
        rows.append((f"{batches} batches", f"{spent_s * 1e3:.1f} ms"))
        if batches == 1:
            fixed_s = spent_s
            continue
        each_ms = [(last - first) / ROUNDS / batches * 1e3 for first, last in zip(before, after, strict=True)]
        rows.append(("  each further", f"{(spent_s - fixed_s) / (batches - 1) * 1e3:.2f} ms"))
        rows.append(("  processor time of scheduler, of client", f"{each_ms[0]:.2f} ms, {each_ms[1]:.2f} ms"))
    show(f"8 candidates over batches of one short session, {there.threads} workers", [*rows, load()])


def _singly(short: Sessions, batches: int) -> tuple[list[list[Source]], list[str]]:
    return [[Source(short[0][0])] for _ in range(batches)], [__version__] * batches


def load() -> tuple[str, str]:
    return "load of the machine", f"{os.getloadavg()[0]:.1f}"
