"""Fixtures for all tests, first of all the one that fails a test that leaves something behind."""

import gc
import os
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
import structlog
from built_once import built_once
from hypothesis import settings
from process_defaults import set_process_defaults
from recordings_support import Recordings
from warm_process import forks
from worker_groups import GroupScheduling

if TYPE_CHECKING:
    from cluster_support import Cluster

settings.register_profile("untimed", deadline=None, max_examples=25)  # the machine's business; make fuzz tries more
settings.load_profile("untimed")

ENDS_WITHIN_S = 60.0
"""Longest time in which a thread or a child ends on request on a busy machine."""


def _children() -> set[str]:
    with open(f"/proc/self/task/{os.getpid()}/children") as file:  # noqa: PTH123 - twice as quick, in every test
        return set(file.read().split())


def _descriptors() -> set[tuple[str, str]]:
    """Number and target of each that a test may not leave open."""
    result = set()
    for number in os.listdir("/proc/self/fd"):  # noqa: PTH208 - four times as quick as pathlib, in every test
        try:
            target = os.readlink(f"/proc/self/fd/{number}")  # noqa: PTH115 - likewise
        except OSError:
            continue  # the descriptor of the listing itself
        if not _may_stay(target):
            result.add((number, target))
    return result


def _remaining(now: Callable[[], Iterable[Any]], before: set[Any]) -> set[Any]:
    until_s = time.monotonic() + ENDS_WITHIN_S
    while (remaining := set(now()) - before) and time.monotonic() < until_s:
        time.sleep(0.01)
    return remaining


def _may_stay(target: str) -> bool:
    """Matplotlib opens its fonts once in a process."""
    return target.startswith("anon") or target.endswith(".ttf")


def pytest_sessionstart(session: pytest.Session) -> None:
    """Start alike, whoever started the suite; an empty home folder, the same one for all processes."""
    if hasattr(session.config, "workerinput"):
        set_process_defaults(Path.home())
        return
    home = tempfile.TemporaryDirectory(prefix="gyrodrift-home-", ignore_cleanup_errors=True)
    session.config.add_cleanup(home.cleanup)
    set_process_defaults(Path(home.name))


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with what takes long, and with groups, which one process runs alone: nothing waits for them at the end."""
    items.sort(key=lambda item: not any(map(item.get_closest_marker, ("long", "xdist_group"))))


def pytest_collection_finish() -> None:
    """Spare the garbage collector the walk over all tests, which stay until the end."""
    gc.collect()
    gc.freeze()


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> GroupScheduling | None:
    """Keep a group together, with any pytest."""
    return GroupScheduling(config, log) if config.getoption("dist") == "loadgroup" else None


@pytest.fixture(scope="session", autouse=True)
def warm_processes() -> None:
    """Load what commands need before a test starts one."""
    if "support" in sys.modules:
        forks()


@pytest.fixture(autouse=True)
def nothing_left_behind() -> Iterator[None]:
    """Fail a test that leaves a thread, a descriptor, a child or a pty behind."""
    threads, children, descriptors = set(threading.enumerate()), _children(), _descriptors()
    yield
    assert not _remaining(threading.enumerate, threads), "threads left behind"
    assert not _remaining(_children, children), "child processes left behind"
    remaining = _remaining(_descriptors, descriptors)
    assert not remaining, f"descriptors left behind: {remaining}"


@pytest.fixture(autouse=True)
def log_as_it_is_at_first() -> None:
    structlog.reset_defaults()


@pytest.fixture
def logged() -> Iterator[list[Any]]:
    """Events of the log, as they come."""
    with structlog.testing.capture_logs() as events:
        yield events


@pytest.fixture
def port(tmp_path: Path) -> Path:
    """A name for the port of a device."""
    return tmp_path / "gyro"


@pytest.fixture(scope="session")
def diagnosis_kernels(request: pytest.FixtureRequest) -> None:
    """Compile what a diagnosis needs in one of several test processes; it takes 15 s, and the others load it."""
    if hasattr(request.config, "workerinput"):
        built_once("diagnosis_kernels", import_module("short_diagnosis").diagnose_in)


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator["Cluster"]:
    """A cluster of two workers, for tests of the group "cluster" that leave its scheduler alive."""
    with import_module("cluster_support").cluster(tmp_path_factory.mktemp("cluster"), 2) as running:
        yield running


@pytest.fixture(scope="session")
def recordings(tmp_path_factory: pytest.TempPathFactory) -> Recordings:
    """Recordings of real sensors, unpacked when they are asked for."""
    return Recordings(tmp_path_factory.mktemp("recordings"))
