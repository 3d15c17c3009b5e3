"""A turn of a link has a budget of time and samples: what is more waits, in order, and no other source waits for it."""

from collections.abc import Iterator
from io import BytesIO
from itertools import count

import pytest
from foreign_support import as_json, in_json
from mcap.writer import CompressionType, Writer
from sources_support import Events

from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.sources.mcap import McapDecoder
from gyrodrift.link.sources.source import SourcePort
from gyrodrift.values.errors import LinkError


class Said(SourcePort):
    """A source with these contents, one a read; an error among them is raised."""

    def __init__(self, *contents: bytes | Exception) -> None:
        super().__init__("tcp://127.0.0.1:5", None)
        self.contents = list(contents)

    def read(self) -> bytes:
        content = self.contents.pop(0) if self.contents else b""
        if isinstance(content, Exception):
            raise content
        return content


def text_lines(number: int) -> bytes:
    return b"".join(b"%d,0.5\n" % (i * 1000) for i in range(number))


def link_to(port: Said, monotonic: Iterator[float]) -> Link:
    options = LinkOptions(port.path, columns="t_us,rate:dps", timeout_s=0.0)
    return Link(options, Events(), lambda: next(monotonic), port)


@pytest.mark.promise("Samples")
def test_a_flood_of_one_source_is_read_in_turns() -> None:
    """A source that floods gets 1024 samples and 20 ms of decoding a turn, shared by all sources; none is lost."""
    link = link_to(Said(text_lines(3000)), count(100.0, 1e-6))
    turns = [len(link.read()) for _ in range(4)]
    assert turns == [1024, 1024, 952, 0]
    assert link.counters.samples == 3000
    shared = link_to(Said(text_lines(3000)), count(100.0, 1e-6))
    shared.share_turn(4)
    assert [len(shared.read()) for _ in range(3)] == [256, 256, 256]
    assert shared.wake_s() == 0.0


def test_a_turn_ends_after_20_ms_of_decoding() -> None:
    """Each look at the clock is 4 ms later; a piece has 1024 bytes, and the samples of a read stay together."""
    port = Said(text_lines(800), b"800000,0.5\n")
    link = link_to(port, count(100.0, 0.004))
    turns = [link.read()]
    while not turns[-1]:
        assert len(port.contents) == 1, "the next read waits"
        assert link.wake_s() == 0.0
        turns.append(link.read())
    assert len(turns) == 3
    assert len(turns[-1]) == 800
    assert len({sample.t_host_s for sample in turns[-1]}) == 1
    shared = link_to(Said(text_lines(800)), count(100.0, 0.004))
    shared.share_turn(4)
    turns = [shared.read()]
    while not turns[-1]:
        turns.append(shared.read())
    assert len(turns) > 4


@pytest.mark.promise("Samples")
def test_a_chunk_that_opens_to_many_samples_is_read_in_turns() -> None:
    """A followed `.mcap` whose small chunks open to millions of samples is read a part at a time."""
    content = BytesIO()
    writer = Writer(content, compression=CompressionType.ZSTD, chunk_size=1 << 22)
    writer.start()
    schema = writer.register_schema("rate", "jsonschema", b"{}")
    channel = writer.register_channel("/imu", "json", schema)
    for number in range(5000):
        writer.add_message(channel, 0, as_json({"t_device_s": 0.01 * number, "rate_dps": 0.5}), 0)
    writer.finish()  # type: ignore[no-untyped-call]
    decoder = McapDecoder()
    counts = [len(decoder.push(content.getvalue()))]
    while decoder.is_behind:
        counts.append(len(decoder.push(b"")))
    assert sum(counts) == 5000
    assert max(counts) <= 1024


def test_a_short_file_is_read_in_one_push() -> None:
    decoder = McapDecoder()
    rows = [as_json({"t_device_s": 0.01 * number, "rate_dps": 0.5}) for number in range(300)]
    assert len(decoder.push(in_json(rows))) == 300
    assert not decoder.is_behind


@pytest.mark.promise("Unplugged and silent devices")
def test_an_error_of_a_source_has_its_name() -> None:
    """An error of a source is an error of the link, with the name of the source."""
    link = link_to(Said(IsADirectoryError(21, "Is a directory")), count(100.0, 1e-6))
    with pytest.raises(LinkError, match=r"^tcp://127.0.0.1:5: cannot be read: Is a directory$"):
        link.read()
