"""JSON lines: whole, exact, thinned by device time, and never waiting for the reader."""

import json
import os
import threading
from collections.abc import Iterator
from math import nan
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.outputs.json_line import json_line
from gyrodrift.service import stdout
from gyrodrift.service.listener import ReaderGoneError
from gyrodrift.service.stdout import JsonLines
from gyrodrift.values.sample import Corrected, Sample


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


numbers = st.floats(-1e6, 1e6)
DIGITS = {"t_s": 6, "rate_dps": 5, "corrected_dps": 5, "yaw_deg": 4, "bias_dps": 5, "yaw_sigma_deg": 4}
DIGITS |= {"confidence": 4, "encoder_deg": 4, "temp_c": 2}


@given(st.integers(0, 1 << 40), st.lists(numbers, min_size=9, max_size=9), st.sets(st.sampled_from(range(5, 9))))
def test_a_line_is_json_rounded_to_what_it_means_and_without_what_is_absent(
    seq: int, values: list[float], absent: set[int]
) -> None:
    """Reading it back gives each number to half a unit of its last digit."""
    if absent & {5, 6}:
        absent = absent | {5, 6}  # a filter says both or none
    given = [nan if index in absent else value for index, value in enumerate(values)]
    t_s, rate, fixed, yaw, bias, sigma, confidence, angle, temp = given
    line = json_line(Corrected(Sample(seq, t_s, 0.0, rate, angle, temp), fixed, yaw, bias, sigma, confidence))
    read = json.loads(line)
    assert line.endswith("}\n")
    assert (read.pop("seq"), read.pop("correction_deg"), read.pop("corrections")) == (seq, 0.0, 0)
    assert list(read) == [name for index, name in enumerate(DIGITS) if index not in absent]
    for index, (name, digits) in enumerate(DIGITS.items()):
        if index not in absent:
            assert read[name] == pytest.approx(values[index], rel=1e-15, abs=0.51 * 10.0**-digits)


def test_a_line_of_a_long_run_is_short() -> None:
    """A day of a turntable with everything that a device can send."""
    sample = Sample(8_640_000, 86_400.123456789, 1.7e9, -149.28371937 / 3, 1234.5678901, 25.129999999)
    line = json_line(Corrected(sample, -49.76123912801, 1234.5612345, 0.34812391231, 12.3123123, 0.99912345))
    assert len(line) < 250


def test_a_number_of_any_size_is_still_json() -> None:
    """Text protocols carry what they like."""
    sample = Sample(0, 0.0, 0.0, -1.7e308, 5e-324, 1e300)
    read = json.loads(json_line(Corrected(sample, 1.7e308, -1e-300, 0.0)))
    assert (read["rate_dps"], read["yaw_deg"], read["encoder_deg"]) == (-1.7e308, 0.0, 0.0)


@pytest.mark.parametrize(
    ("rate_hz", "expected"), [(None, 1001), (100.0, 1001), (50.0, 501), (10.0, 101), (30.0, 301), (0.5, 6), (1e6, 1001)]
)
def test_thinning_keeps_to_the_rate_in_device_time(pipe: Pipe, rate_hz: float | None, expected: int) -> None:
    """Ten seconds at 100 Hz, both ends included."""
    output = JsonLines(pipe[1], rate_hz)
    output.take([corrected(i, i / 100) for i in range(1001)])
    assert output.stats()["lines"] == pytest.approx(expected, abs=1)


def test_thinning_goes_on_after_a_hole(pipe: Pipe) -> None:
    output = JsonLines(pipe[1], 10.0)
    for t_s in (0.0, 0.1, 60.0, 60.01, 60.05, 60.1):
        output.take([corrected(0, t_s)])
    lines = os.read(pipe[0], 1 << 16).splitlines()
    assert [json.loads(line)["t_s"] for line in lines] == [0.0, 0.1, 60.0, 60.1]


@pytest.mark.promise("Samples")
@pytest.mark.parametrize("batch", [1, 50])
def test_a_reader_who_sleeps_loses_the_oldest_whole_lines_and_is_told_how_many(
    batch: int, pipe: Pipe, monkeypatch: pytest.MonkeyPatch
) -> None:
    """8 MiB of lines wait for a slow reader of stdout; then the oldest whole lines are dropped and counted."""
    monkeypatch.setattr(stdout, "LONGEST_QUEUE_BYTES", 50_000)
    output = JsonLines(pipe[1])
    for first in range(0, 10_000, batch):
        output.take([corrected(i) for i in range(first, first + batch)])
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
    output = JsonLines(pipe[1])
    os.close(pipe[0])
    with pytest.raises(ReaderGoneError):
        output.take([corrected(0)])


def test_a_file_takes_everything(tmp_path: Path) -> None:
    with (tmp_path / "out.jsonl").open("wb") as file:
        output = JsonLines(file.fileno())
        output.take([corrected(i) for i in range(20_000)])
        output.close()
    lines = (tmp_path / "out.jsonl").read_text().splitlines()
    assert [json.loads(line)["seq"] for line in lines] == list(range(20_000))


@pytest.mark.promise("Memory and the end")
def test_the_end_waits_a_second_for_a_reader_and_counts_what_is_left(
    pipe: Pipe, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At the end a reader of stdout has 1 s; remaining lines are counted in `lines_dropped`."""
    monkeypatch.setattr(stdout, "LAST_S", 0.3)
    output = JsonLines(pipe[1])
    output.take([corrected(i) for i in range(10_000)])
    reader = threading.Timer(0.05, os.read, (pipe[0], 4096))
    reader.start()
    output.close()  # it would never end, if it waited for the reader
    reader.join()
    os.close(pipe[1])
    with os.fdopen(os.dup(pipe[0]), "rb") as remaining:
        read = remaining.read().count(b"\n")
    assert output.dropped > 0
    assert 10_000 - output.dropped - read == pytest.approx(4096 / len(json_line(corrected(9000))), abs=30)


def test_a_reader_who_leaves_at_the_end_is_no_failure_of_what_came_before(pipe: Pipe) -> None:
    output = JsonLines(pipe[1])
    output.take([corrected(i) for i in range(10_000)])
    waiting = output.dropped
    os.close(pipe[0])
    output.close()
    assert output.dropped > waiting
    assert not output.wakes()


@pytest.mark.promise("Samples")
def test_a_terminal_that_nobody_reads_takes_what_it_has_room_for_and_no_more() -> None:
    """A stopped or unread terminal as stdout costs no sample."""
    controller, terminal = os.openpty()
    try:
        output = JsonLines(terminal)
        for i in range(2000):
            output.take([corrected(i)])
        assert output.wakes()
        read = os.read(controller, 1 << 16)
        while output.wakes() or b'"seq":1999' not in read or not read.endswith(b"\n"):
            output.take([])
            read += os.read(controller, 1 << 16)
        assert [json.loads(line)["seq"] for line in read.splitlines()] == list(range(2000))
    finally:
        os.close(controller)
        os.close(terminal)


def test_a_terminal_that_took_half_a_line_gets_the_other_half(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stdout, "LONGEST_QUEUE_BYTES", 2000)
    controller, terminal = os.openpty()
    try:
        output = JsonLines(terminal)
        for i in range(2000):
            output.take([corrected(i)])
        read = b""
        while output.wakes() or b'"seq":1999' not in read or not read.endswith(b"\n"):
            output.take([])
            read += os.read(controller, 1 << 16)
        seqs = [json.loads(line)["seq"] for line in read.splitlines()]
    finally:
        os.close(controller)
        os.close(terminal)
    assert output.dropped > 0
    assert len(seqs) == 2000 - output.dropped


def test_a_reader_who_goes_on_at_the_end_gets_every_line(pipe: Pipe) -> None:
    output, read = JsonLines(pipe[1]), bytearray()

    def drain() -> None:
        while not read.endswith(b"\0"):
            read.extend(os.read(pipe[0], 1 << 16))

    output.take([corrected(i) for i in range(3000)])
    assert output.wakes()
    reader = threading.Thread(target=drain)
    reader.start()
    output.close()
    os.write(pipe[1], b"\0")
    reader.join()
    assert output.dropped == 0
    assert read.count(b"\n") == 3000
