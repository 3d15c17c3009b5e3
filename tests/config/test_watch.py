"""The watched config: whichever way an editor saves it."""

import os
from pathlib import Path

import pytest
from config_support import ReadHere

from gyrodrift.config.model import Config
from gyrodrift.config.watch import ConfigWatch
from gyrodrift.filters.hdr import HdrParams
from gyrodrift.values.errors import ConfigError

BLOCK = "hdr: {{i_c_dps: 0.001, tau_s: {tau_s}, theta_w_dps: 1, c1: 0, c2: 1}}\n"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "c.yaml"
    path.write_text(BLOCK.format(tau_s=1))
    return path


def _tau_s(config: Config) -> float:
    assert isinstance(config.params, HdrParams)
    return config.params.tau_s


def test_nothing_new_while_nothing_changes(path: Path) -> None:
    """The first config is there at once."""
    watch = ConfigWatch(path, ReadHere)
    assert _tau_s(watch.config) == 1.0
    assert watch.poll() is None


def test_a_file_written_in_place_is_seen_once(path: Path) -> None:
    watch = ConfigWatch(path, ReadHere)
    path.write_text(BLOCK.format(tau_s=2.25))
    new = watch.poll()
    assert new is not None
    assert _tau_s(new) == 2.25
    assert watch.poll() is None


def test_a_file_renamed_over_it_is_seen(path: Path) -> None:
    watch = ConfigWatch(path, ReadHere)
    fresh = path.with_name("fresh")
    fresh.write_text(BLOCK.format(tau_s=3))
    fresh.replace(path)
    assert watch.poll() is watch.config
    assert _tau_s(watch.config) == 3.0


def test_a_file_of_the_same_size_and_time_is_another_one(path: Path) -> None:
    watch = ConfigWatch(path, ReadHere)
    before, fresh = path.stat(), path.with_name("fresh")
    fresh.write_text(path.read_text().replace("1", "2", 1))
    os.utime(fresh, ns=(before.st_atime_ns, before.st_mtime_ns))
    fresh.replace(path)
    assert (path.stat().st_size, path.stat().st_mtime_ns) == (before.st_size, before.st_mtime_ns)
    assert watch.poll() is not None


def test_a_file_that_is_away_for_a_moment_changes_nothing(path: Path) -> None:
    watch = ConfigWatch(path, ReadHere)
    path.unlink()
    assert watch.poll() is None
    assert not watch.is_gone
    path.write_text(BLOCK.format(tau_s=4))
    assert watch.poll() is not None


def test_a_file_that_stays_away_is_gone_until_it_is_back(path: Path) -> None:
    watch = ConfigWatch(path, ReadHere)
    path.rename(path.with_name("away"))
    assert [(watch.poll(), watch.is_gone) for _ in range(3)] == [(None, False), (None, True), (None, True)]
    assert _tau_s(watch.config) == 1.0
    path.with_name("away").rename(path)
    assert (watch.poll(), watch.is_gone) == (None, False)


@pytest.mark.promise("Configs and commands")
def test_a_file_with_mistakes_is_told_once_and_the_old_config_stays(path: Path) -> None:
    """A config with mistakes changes nothing, and is reported once."""
    watch = ConfigWatch(path, ReadHere)
    path.write_text("hdr: {tau_s: no}\n")
    with pytest.raises(ConfigError):
        watch.poll()
    assert watch.poll() is None
    assert _tau_s(watch.config) == 1.0


@pytest.mark.promise("Samples")
def test_nothing_is_waited_for_while_a_file_is_read(path: Path) -> None:
    """The service never waits while a config is read."""
    watch = ConfigWatch(path, lambda path: ReadHere(path, looks=2))
    path.write_text(BLOCK.format(tau_s=2.25))
    assert (watch.poll(), watch.poll()) == (None, None)
    path.write_text(BLOCK.format(tau_s=3.125))
    first = watch.poll()
    assert first is not None
    assert [watch.poll() for _ in range(2)] == [None, None]
    last = watch.poll()
    assert last is not None
    assert _tau_s(last) == 3.125
    assert watch.poll() is None


def test_a_file_that_is_asked_for_is_read_once_more_behind_the_reading_under_way(path: Path) -> None:
    watch = ConfigWatch(path, lambda path: ReadHere(path, looks=1))
    path.write_text(BLOCK.format(tau_s=2.25))
    assert watch.poll() is None
    due = watch.ask()
    assert watch.poll() is not None
    assert watch.ended == due - 1
    assert watch.poll() is None
    assert watch.poll() is not None
    assert watch.ended == due


def test_the_next_reading_begins_when_the_process_of_the_one_before_is_gone(path: Path) -> None:
    readings: list[ReadHere] = []

    def begun(path: Path) -> ReadHere:
        readings.append(ReadHere(path))
        return readings[-1]

    watch = ConfigWatch(path, begun)
    path.write_text("hdr: 5\n")
    with pytest.raises(ConfigError):
        watch.poll()
    readings[0].is_gone = False
    path.write_text(BLOCK.format(tau_s=3.125))
    assert (watch.poll(), len(readings)) == (None, 1)
    readings[0].is_gone = True
    assert watch.poll() is None
    assert watch.poll() is not None
    watch.close()
    assert readings[1].is_closed is False
