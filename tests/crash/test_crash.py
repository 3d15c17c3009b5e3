"""A small part of the crashes, in every run: kills of what writes, and writers that get no room."""

import os
import resource
import subprocess
from collections.abc import Callable
from pathlib import Path
from random import Random

import numpy as np
import pytest
from crash.kills import killed_serve, killed_writer
from disk_support import fill, read_only_disk, small_disk
from support import ours

from gyrodrift.session.files import load_session, write_session
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats

SAMPLES = 4000


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A minute and a half of it."""
    path = tmp_path_factory.mktemp("in") / "s.csv"
    t_s: Floats = np.arange(SAMPLES, dtype=np.float64) * 0.01
    rate_dps = np.random.default_rng(1).normal(0.3, 0.05, SAMPLES)
    write_session(path, [Session("s", t_s, rate_dps, encoder_deg=np.zeros(SAMPLES))])
    return path


def test_a_config_is_old_or_new_whenever_its_writer_is_killed(tmp_path: Path) -> None:
    random = Random(1)
    assert {killed_writer(tmp_path, random.uniform(0.0, 0.1)) for _ in range(10)} <= {0.25, 1.25}


def test_a_service_that_is_killed_leaves_what_it_had_recorded(tmp_path: Path) -> None:
    assert killed_serve(tmp_path, 2.0) > 0


WRITERS: dict[str, tuple[str, ...]] = {
    "filter": ("filter", "{session}", "--out", "{out}/y.csv", "--force"),
    "convert": ("convert", "{session}", "{out}/s.mcap", "--force"),
    "simulate": ("simulate", "--out", "{out}", "--minutes", "0.5", "--format", "csv", "--force", "--quiet"),
    "info": ("info", "{session}", "--out", "{out}"),
}


def run(words: tuple[str, ...], session: Path, out: Path, before: Callable[[], object] | None = None) -> str:
    command = ours(*(word.format(session=session, out=out) for word in words))
    done = subprocess.run(command, capture_output=True, text=True, check=False, preexec_fn=before)
    assert done.returncode == 2, done.stderr
    assert "Traceback" not in done.stderr
    assert done.stderr.count("\n") == 1
    return done.stderr


def limited() -> None:
    """No file of more than 8 kB, as a quota has it; and no bytecode, of which half a file would stay for others."""
    os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
    resource.setrlimit(resource.RLIMIT_FSIZE, (8192, 8192))


@pytest.mark.parametrize("name", WRITERS)
def test_who_may_write_no_more_leaves_what_was_there(tmp_path: Path, session: Path, name: str) -> None:
    old = [tmp_path / item for item in ("y.csv", "s.mcap", "report.html")]
    for path in old:
        path.write_text("old")
    assert "cannot be written: File too large" in run(WRITERS[name], session, tmp_path, limited)
    assert all(path.read_text() == "old" for path in old)
    assert not [path for path in tmp_path.iterdir() if path.name.startswith(".") or path.stat().st_size > 8192]
    assert len(load_session(session).rate_dps) == SAMPLES


@pytest.mark.parametrize("name", WRITERS)
def test_a_full_disk_is_told(tmp_path: Path, session: Path, name: str) -> None:
    with small_disk(tmp_path / "disk", "64k") as out:
        fill(out)
        assert "No space left on device" in run(WRITERS[name], session, out)
        assert [path.name for path in out.iterdir()] == ["fill"]


@pytest.mark.parametrize("name", ["convert", "info"])
def test_a_disk_that_takes_nothing_is_told(tmp_path: Path, session: Path, name: str) -> None:
    with read_only_disk(tmp_path / "disk") as out:
        assert "Read-only file system" in run(WRITERS[name], session, out)
