"""JSON lines: whole, exact, thinned by device time, and never waiting for the reader."""

import json
import os
from collections.abc import Iterator
from math import nan
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.outputs.json_line import json_line
from gyrodrift.sample import Corrected, Sample
from gyrodrift.service import stdout
from gyrodrift.service.sink import ReaderGoneError
from gyrodrift.service.stdout import JsonLines


def corrected(seq: int, t_s: float = 0.0) -> Corrected:
    return Corrected(Sample(seq, t_s, 1.7e9, 0.5), 0.25, 3.0, 0.25)


Pipe = tuple[int, int]


@pytest.fixture
def pipe() -> Iterator[Pipe]:
    read_fd, write_fd = os.pipe()
    yield read_fd, write_fd
    for fd in (read_fd, write_fd):
        try:
            os.close(fd)
        except OSError:
            continue  # the test closed it itself


numbers = st.floats(allow_nan=False, allow_infinity=False)


@given(st.integers(0, 1 << 40), numbers, numbers, numbers, numbers, numbers, st.none() | numbers, st.none() | numbers)
def test_a_line_is_json_with_every_digit_and_without_what_is_absent(
    seq: int, t_s: float, rate: float, fixed: float, yaw: float, bias: float, angle: float | None, temp: float | None
) -> None:
    """Reading it back gives the same bits."""
    sample = Sample(seq, t_s, 0.0, rate, nan if angle is None else angle, nan if temp is None else temp)
    line = json_line(Corrected(sample, fixed, yaw, bias))
    expected = {"seq": seq, "t_s": t_s, "rate_dps": rate, "corrected_dps": fixed, "yaw_deg": yaw, "bias_dps": bias}
    expected |= {} if angle is None else {"encoder_deg": angle}
    expected |= {} if temp is None else {"temp_c": temp}
    assert line.endswith("}\n")
    assert json.loads(line) == expected


@pytest.mark.parametrize(
    ("rate_hz", "expected"), [(None, 1001), (100.0, 1001), (50.0, 501), (10.0, 101), (30.0, 301), (0.5, 6), (1e6, 1001)]
)
def test_thinning_keeps_to_the_rate_in_device_time(pipe: Pipe, rate_hz: float | None, expected: int) -> None:
    """Ten seconds at 100 Hz, both ends included."""
    output = JsonLines(pipe[1], rate_hz)
    output.take([corrected(i, i / 100) for i in range(1001)])
    assert output.stats()["lines"] == pytest.approx(expected, abs=1)


def test_thinning_goes_on_after_a_hole(pipe: Pipe) -> None:
    """It does not make up for lines that were not due."""
    output = JsonLines(pipe[1], 10.0)
    for t_s in (0.0, 0.1, 60.0, 60.01, 60.05, 60.1):
        output.take([corrected(0, t_s)])
    lines = os.read(pipe[0], 1 << 16).splitlines()
    assert [json.loads(line)["t_s"] for line in lines] == [0.0, 0.1, 60.0, 60.1]


def test_a_reader_who_sleeps_loses_the_oldest_whole_lines_and_is_told_how_many(
    pipe: Pipe, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The output never waits, and what arrives is whole."""
    monkeypatch.setattr(stdout, "LONGEST_QUEUE_BYTES", 50_000)
    output = JsonLines(pipe[1])
    for i in range(10_000):
        output.take([corrected(i)])
    read = b""
    while output.wakes():
        read += os.read(pipe[0], 1 << 16)
        output.take([])
    read += os.read(pipe[0], 1 << 16)
    seqs = [json.loads(line)["seq"] for line in read.splitlines()]
    assert output.dropped > 0
    assert len(seqs) == 10_000 - output.dropped
    assert seqs == sorted(seqs)
    assert seqs[-1] == 9_999


def test_a_reader_who_left_is_noticed(pipe: Pipe) -> None:
    """As `head` does when it has enough."""
    output = JsonLines(pipe[1])
    os.close(pipe[0])
    with pytest.raises(ReaderGoneError):
        output.take([corrected(0)])


def test_a_file_takes_everything(tmp_path: Path) -> None:
    """Files are always ready."""
    with (tmp_path / "out.jsonl").open("wb") as file:
        output = JsonLines(file.fileno())
        output.take([corrected(i) for i in range(20_000)])
        output.close()
    lines = (tmp_path / "out.jsonl").read_text().splitlines()
    assert [json.loads(line)["seq"] for line in lines] == list(range(20_000))
