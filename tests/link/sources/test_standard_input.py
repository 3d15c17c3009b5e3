"""Source `-`: pipes and files into `serve`, `record` and `doctor`."""

import json
import os
import random
import subprocess
import time
from pathlib import Path

import pytest
from sources_support import lines
from support import ours

from gyrodrift.link.port import PortGoneError
from gyrodrift.link.sources.source import SourceEndedError
from gyrodrift.link.sources.stdin import StdinPort
from gyrodrift.session.files import load_session


def piped(content: bytes, *words: str | Path) -> "subprocess.CompletedProcess[bytes]":
    """A command of ours that reads `content` from a pipe."""
    return subprocess.run(ours(*words), input=content, capture_output=True, check=False)


def test_serve_ends_with_its_input_after_all_is_written() -> None:
    """Status 0, and a line for each sample, also of the last line without an end."""
    done = piped(lines(0, 5000)[:-1], "serve", "--port", "-")
    assert done.returncode == 0
    samples = [json.loads(line) for line in done.stdout.splitlines()]
    assert [sample["seq"] for sample in samples] == list(range(5000))
    assert b"event=source_end" in done.stderr


@pytest.mark.promise("Samples")
def test_a_slow_reader_loses_no_line_of_a_file(tmp_path: Path) -> None:
    """A file or pipe on standard input loses no line, however slow the reader is; all is written before the end."""
    path = tmp_path / "table.csv"
    path.write_bytes(lines(0, 60_000))
    with (
        path.open("rb") as file,
        subprocess.Popen(ours("serve", "--port", "-", "--quiet"), stdin=file, stdout=subprocess.PIPE) as process,
    ):
        assert process.stdout is not None
        time.sleep(2.0)
        count = len(process.stdout.read().splitlines())
    assert process.returncode == 0
    assert count == 60_000


def test_record_keeps_all_of_a_pipe(tmp_path: Path) -> None:
    done = piped(lines(0, 5000), "record", "--port", "-", "--out", tmp_path)
    assert done.returncode == 0
    (path,) = tmp_path.glob("*.mcap")
    assert len(load_session(path).t_device_s) == 5000


def test_json_lines_of_any_program_are_read() -> None:
    content = b"".join(b'{"t": %d, "gyro": {"z": 0.01}}\n' % number for number in range(0, 20_000, 10))
    done = piped(content, "serve", "--port", "-", "--columns", "t=t_ms, gyro.z=rate:rads")
    assert done.returncode == 0
    assert len(done.stdout.splitlines()) == 2000


def test_an_input_that_says_nothing_is_an_error() -> None:
    done = piped(b"", "serve", "--port", "-")
    assert done.returncode == 3
    assert b"it ended, and the device sent nothing" in done.stderr


def test_an_input_that_is_not_understood_shows_what_it_is() -> None:
    done = piped(b"hello world, here I am\n" * 20, "serve", "--port", "-")
    assert done.returncode == 3
    assert b"it ended, and the device prints text, but no line is a" in done.stderr
    assert b"hello world" in done.stderr


def test_doctor_reads_a_pipe_to_its_end() -> None:
    noise = random.Random(1)
    content = b"".join(b"%d,%.3f\n" % (10_000 * number, noise.gauss(0.3, 0.05)) for number in range(4000))
    done = piped(content, "doctor", "--port", "-", "--json")
    assert done.returncode == 0, done.stdout + done.stderr
    severities = {finding["id"]: finding["severity"] for finding in json.loads(done.stdout)["findings"]}
    assert severities["port"] == "ok"
    assert severities["gaps"] == "ok"


def test_binary_input_gets_no_line_end() -> None:
    reading, writing = os.pipe()
    port = StdinPort("-", reading)
    assert port.read() == b""
    os.write(writing, b"\x01\x02")
    assert port.read() == b"\x01\x02"
    os.close(writing)
    with pytest.raises(SourceEndedError):
        port.read()
    os.close(reading)
    assert not issubclass(SourceEndedError, PortGoneError)
