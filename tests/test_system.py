"""Substitutes for functions that other systems lack do the same as the functions of Linux."""

import os
import select
import socket
from collections.abc import Callable
from pathlib import Path

import pytest

from gyrodrift.io import system
from gyrodrift.io.parallel import usable_jobs
from gyrodrift.io.waiting import POLLIN, POLLOUT, Poller, SelectPoller, new_poller


@pytest.mark.parametrize("has_pread", [True, False])
def test_a_file_is_read_at_a_place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, has_pread: bool) -> None:
    (tmp_path / "file").write_bytes(b"0123456789")
    if not has_pread:
        monkeypatch.delattr(os, "pread")
    with (tmp_path / "file").open("rb", buffering=0) as file:
        file.seek(2)
        assert system.read_at(file.fileno(), 3, 5) == b"567"
        assert system.read_at(file.fileno(), 3, 9) == b"9"
        assert file.read(2) == b"23"


@pytest.mark.parametrize("has_pipes", [True, False])
def test_a_byte_wakes_the_other_end(monkeypatch: pytest.MonkeyPatch, *, has_pipes: bool) -> None:
    """A pipe or a pair of sockets; neither end waits."""
    if not has_pipes:
        monkeypatch.delattr(os, "pipe2")
    wake = system.WakePipe()
    with pytest.raises(BlockingIOError):
        os.read(wake.fd, 1)
    os.write(wake.write_fd, b"x")
    assert os.read(wake.fd, 1) == b"x"
    wake.close()
    with pytest.raises(OSError, match="Bad file descriptor"):
        os.fstat(wake.fd)


@pytest.mark.parametrize("kind", [select.poll, SelectPoller])
def test_pollers_agree(kind: Callable[[], Poller]) -> None:
    """A socket can be written to, and read from once the other end has sent."""
    poller = kind()
    here, there = socket.socketpair()
    with here, there:
        poller.register(here.fileno(), POLLIN | POLLOUT)
        assert poller.poll(0) == [(here.fileno(), POLLOUT)]
        there.send(b"x")
        assert poller.poll(0) == [(here.fileno(), POLLIN | POLLOUT)]


def test_waiting_for_nothing_only_takes_the_time() -> None:
    assert SelectPoller().poll(1) == []


def test_without_poll_select_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(select, "poll")
    assert isinstance(new_poller(), SelectPoller)


def test_without_fork_the_work_is_done_in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("gyrodrift.io.parallel.CAN_FORK", False)
    assert usable_jobs(8) == 1


def test_the_machine_has_processors_and_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    assert 1 <= system.processor_count() <= (os.cpu_count() or 1)
    assert system.memory_bytes_of_machine() > 1 << 28
    monkeypatch.delattr(os, "sched_getaffinity")
    monkeypatch.delattr(os, "sysconf")
    assert system.processor_count() == os.cpu_count()
    assert system.memory_bytes_of_machine() == system.UNKNOWN_MEMORY_BYTES
