"""The journal of an interrupted tuning."""

from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gyrodrift.evaluation.space import axes_of
from gyrodrift.filters.hdr_filter import HDR
from gyrodrift.tune.search.journal import Journal
from gyrodrift.tune.search.objective import Objective
from gyrodrift.values.errors import DataError

AXES = axes_of(HDR)


def request(count: int) -> Objective:
    objective = Objective(lambda params: params[:, 0], AXES, count)
    objective(np.random.default_rng(count).random((count, 5)))
    return objective


def test_what_was_saved_is_known_again(tmp_path: Path) -> None:
    """Search by search, to the bit; names may hold anything a session's name may."""
    path = tmp_path / "c.progress.npz"
    journal = Journal(path, "these sessions", is_resumed=False)
    names = ["seed 0", "without folder/a.b", "two parameters"]
    for number, name in enumerate(names, 3):
        journal.note(name, request(number))
    journal.save()
    again = Journal(path, "these sessions", is_resumed=True)
    for number, name in enumerate(names, 3):
        expected = again.cached(name)
        assert expected is not None
        assert np.array_equal(expected[0], request(number).cube)
        assert np.array_equal(expected[1], request(number).costs)
    assert again.cached("seed 1") is None
    again.discard()
    assert not path.exists()


def test_without_resume_nothing_is_known(tmp_path: Path) -> None:
    path = tmp_path / "c.progress.npz"
    journal = Journal(path, "a", is_resumed=False)
    journal.note("seed 0", request(3))
    journal.save()
    assert Journal(path, "a", is_resumed=False).cached("seed 0") is None


def test_a_journal_of_other_sessions_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "c.progress.npz"
    Journal(path, "a", is_resumed=False).save()
    with pytest.raises(DataError, match="belongs to other sessions, ranges or another method"):
        Journal(path, "b", is_resumed=True)


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 torn", b"not a zip"])
def test_a_damaged_journal_is_told(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "c.progress.npz"
    path.write_bytes(content)
    with pytest.raises(DataError, match=r"cannot be resumed from: .*; remove it to start over"):
        Journal(path, "a", is_resumed=True)


def test_it_is_saved_every_few_seconds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "c.progress.npz"
    journal = Journal(path, "a", is_resumed=False)
    journal.note("seed 0", request(3))
    assert not path.exists()
    monkeypatch.setattr("gyrodrift.tune.search.journal.SAVE_S", 0.0)
    journal.note("seed 0", request(3))
    assert path.exists()


def test_a_file_that_is_no_journal_is_told(tmp_path: Path) -> None:
    path = tmp_path / "c.progress.npz"
    good: dict[str, Any] = {"identity": np.array("a"), "x/cube": np.zeros((3, 5)), "x/costs": np.zeros(3)}
    for name, value in {"x/cube": np.zeros(3), "x/costs": np.zeros(4), "y/cube": np.zeros((1, 5))}.items():
        np.savez(path, **good | {name: value})
        with pytest.raises(DataError, match=r"cannot be resumed from: it was damaged; remove it"):
            Journal(path, "a", is_resumed=True)
    np.savez_compressed(path, **good | {"x/cube": np.zeros((1 << 23, 5))})
    with pytest.raises(DataError, match="cannot be resumed from: it claims to hold"):
        Journal(path, "a", is_resumed=True)
    np.savez(path, **good)
    whole = path.read_bytes()
    for index in range(0, len(whole), 7):
        path.write_bytes(whole[:index] + bytes((whole[index] ^ 0xFF,)) + whole[index + 1 :])
        with suppress(DataError):  # some bytes mean nothing
            Journal(path, "a", is_resumed=True)
