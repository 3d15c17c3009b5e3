"""JSON lines of several sources: whole, in order, and no source pushes the lines of another one out."""

import json
import os
import threading
from collections.abc import Iterator

import pytest

from gyrodrift.service.source_lines import SharedLines, SourceLines
from gyrodrift.service.stdout import LONGEST_QUEUE_BYTES
from gyrodrift.values.sample import Corrected, Sample

Pipe = tuple[int, int]


@pytest.fixture
def pipe() -> Iterator[Pipe]:
    reading, writing = os.pipe()
    yield reading, writing
    os.close(reading)
    os.close(writing)


def samples(count: int) -> list[Corrected]:
    return [Corrected(Sample(seq, 0.0, 1.7e9, 0.5), 0.25, 3.0, 0.25) for seq in range(count)]


def received_until(pipe: Pipe, source: SourceLines, lines: SharedLines) -> list[dict[str, object]]:
    """Lines that a reader gets who takes everything; the pipe is closed by a line of zeros."""
    received = b""
    while source.wakes():
        received += os.read(pipe[0], 1 << 16)
        source.take([])
    lines.close()
    os.write(pipe[1], b"\0")
    while not received.endswith(b"\0"):
        received += os.read(pipe[0], 1 << 16)
    return [json.loads(line) for line in received[:-1].splitlines()]


def numbers_of(received: list[dict[str, object]], name: str) -> list[object]:
    return [line["seq"] for line in received if line["source"] == name]


def test_the_end_of_one_source_leaves_the_lines_of_the_others(pipe: Pipe) -> None:
    lines = SharedLines(pipe[1])
    first, second = SourceLines(lines, "left"), SourceLines(lines, "right")
    first.take(samples(2000))
    second.take(samples(2000))
    assert first.wakes() == second.wakes() != {}
    first.close()
    received = received_until(pipe, second, lines)
    assert numbers_of(received, "left") == numbers_of(received, "right") == list(range(2000))
    assert first.stats() == second.stats() == {"lines": 2000, "lines_dropped": 0}


def test_a_source_that_floods_drops_its_own_lines_alone(pipe: Pipe) -> None:
    """The oldest ones; the lines of the other source come next, and are not behind the flood."""
    lines = SharedLines(pipe[1])
    flood, calm = SourceLines(lines, "flood"), SourceLines(lines, "calm")
    batch = samples(10_000)
    for _ in range(LONGEST_QUEUE_BYTES // 500_000):
        flood.take(batch)
    calm.take(samples(10))
    flood.take(batch)
    assert flood.stats()["lines_dropped"] > 10_000
    assert calm.stats() == {"lines": 10, "lines_dropped": 0}
    received = received_until(pipe, calm, lines)
    assert numbers_of(received, "calm") == list(range(10))
    assert [line["source"] for line in received].index("calm") < 2000
    assert len(received) == flood.lines + 10 - flood.dropped


def test_a_reader_that_comes_late_gets_the_queued_lines_at_the_end(pipe: Pipe) -> None:
    lines = SharedLines(pipe[1])
    first, second = SourceLines(lines, "left"), SourceLines(lines, "right")
    first.take(samples(2000))
    second.take(samples(2000))
    received = bytearray()

    def drain() -> None:
        while not received.endswith(b"\0"):
            received.extend(os.read(pipe[0], 1 << 16))

    reader = threading.Thread(target=drain)
    reader.start()
    lines.close()
    os.write(pipe[1], b"\0")
    reader.join()
    assert received.count(b"\n") == 4000


def test_each_source_has_its_share_of_8_mib(pipe: Pipe) -> None:
    lines = SharedLines(pipe[1])
    sources = [SourceLines(lines, name) for name in ("a", "b", "c", "d")]
    assert lines.longest_queue_bytes == 2_097_152
    batch = samples(10_000)  # of about 90 bytes
    for _ in range(4):
        sources[0].take(batch)
    for source in sources[1:]:
        source.take(batch)
    assert sources[0].stats()["lines_dropped"] > 10_000
    assert [source.stats()["lines_dropped"] for source in sources[1:]] == [0, 0, 0]
