"""A config that is read by a process of its own: in bounded time, and whatever becomes of that process is told."""

import os
import pickle
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from support import PATIENCE_S

from gyrodrift import __version__
from gyrodrift.config import reading
from gyrodrift.config.model import Config, load_config
from gyrodrift.config.reading import ConfigReading, load_in_time
from gyrodrift.values.errors import ConfigError

HDR = "hdr: {i_c_dps: 0.001, tau_s: 1, theta_w_dps: 1, c1: 0, c2: 1}\n"
WITH_ALL = f"""{HDR}columns: [t_ms, rate]
outputs: [{{name: mqtt, password: hidden}}, {{name: tcp, port: 0}}]
calibration: {{scale_cw: 1.01, scale_ccw: 1.01, device_id: abc, date: 2026-11-20}}
"""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "c.yaml"
    path.write_text(HDR)
    return path


@pytest.fixture
def begun() -> Iterator[list[ConfigReading]]:
    """Readings that are ended behind the test."""
    readings: list[ConfigReading] = []
    yield readings
    for item in readings:
        item.close()


def outcome(of: ConfigReading) -> Config:
    """The one of a reading that comes to an end."""
    until_s = time.monotonic() + PATIENCE_S
    while (result := of.outcome()) is None:
        assert time.monotonic() < until_s
        time.sleep(0.01)
    return result


def busy(_path: Path) -> Config:
    """A reading that never ends."""
    while True:
        pass


def test_what_a_process_read_is_what_would_have_been_read_here(path: Path, begun: list[ConfigReading]) -> None:
    path.write_text(WITH_ALL)
    path.chmod(0o600)
    begun.append(ConfigReading(path))
    result, here = outcome(begun[0]), load_config(path)
    assert result == here
    assert (result.text, result.mode) == (here.text, here.mode)
    assert result.outputs[0].options.password.reveal() == "hidden"


def test_mistakes_are_told_as_they_would_have_been_here(path: Path, begun: list[ConfigReading]) -> None:
    path.write_text("hdr: 5\nfilter: hdrr\n")
    begun.append(ConfigReading(path))
    with pytest.raises(ConfigError) as report:
        outcome(begun[0])
    with pytest.raises(ConfigError) as here:
        load_config(path)
    assert report.value.problems == here.value.problems


@pytest.mark.promise("Configs and commands")
def test_a_config_that_takes_more_than_a_second_of_processor_time_is_refused(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A config that takes more than 1 s of processor time to read is refused."""
    before = signal.getsignal(signal.SIGPROF)
    monkeypatch.setattr(reading, "load_config", busy)
    monkeypatch.setattr(reading, "MOST_CPU_S", 0.05)
    with pytest.raises(ConfigError, match=r"c\.yaml: takes too long to read: more than 0\.05 s of processor time"):
        load_in_time(path)
    assert signal.getsignal(signal.SIGPROF) is before
    assert signal.getitimer(signal.ITIMER_PROF) == (0.0, 0.0)


@pytest.mark.promise("Configs and commands")
def test_a_process_that_takes_too_long_is_killed_and_told(path: Path, begun: list[ConfigReading]) -> None:
    """A config that takes more than 20 s to read is refused."""
    now_s = 100.0
    begun.append(ConfigReading(path, lambda: now_s))
    os.kill(begun[0]._process.pid, signal.SIGSTOP)
    assert begun[0].outcome() is None
    now_s += reading.LONGEST_S
    with pytest.raises(ConfigError, match=r"c\.yaml: takes too long to read: more than 20 s; save it again"):
        begun[0].outcome()
    assert begun[0]._process.wait(PATIENCE_S) == -signal.SIGKILL
    assert begun[0].is_gone


def test_a_process_that_dies_is_told(path: Path, begun: list[ConfigReading]) -> None:
    begun.append(ConfigReading(path))
    os.kill(begun[0]._process.pid, signal.SIGKILL)
    with pytest.raises(ConfigError, match=r"c\.yaml: the process that reads it ended by signal 9; save it again"):
        outcome(begun[0])


def test_a_process_that_cannot_be_started_is_told(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise OSError(11, "Resource temporarily unavailable")

    monkeypatch.setattr(subprocess, "Popen", refuse)
    with pytest.raises(ConfigError, match="no process can be started that reads it: Resource temporarily unavail"):
        ConfigReading(path)


OTHER_FILES = {
    "was read by gyrodrift 9.9, this is": pickle.dumps(("9.9", None, ())),
    "was read by gyrodrift UnpicklingError, this is": b"no pickle",
    "was read by gyrodrift ModuleNotFoundError, this is": b"cnowhere\nConfig\n.",
}


@pytest.mark.parametrize("message_part", OTHER_FILES)
def test_what_another_version_read_is_not_taken(
    path: Path, message_part: str, begun: list[ConfigReading], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The program may be replaced while the service runs."""
    assert __version__ != "9.9"
    popen: Any = subprocess.Popen
    words = [sys.executable, "-c", f"import sys; sys.stdout.buffer.write({OTHER_FILES[message_part]!r})"]
    monkeypatch.setattr(subprocess, "Popen", lambda _, **options: popen(words, **options))
    begun.append(ConfigReading(path))
    with pytest.raises(ConfigError, match=message_part):
        outcome(begun[0])
