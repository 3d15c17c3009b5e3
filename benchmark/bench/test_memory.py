"""Memory over ten million samples: clock and counter wrap, lines go out, clients come and go, nothing piles up."""

import gc
import os
import selectors
import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest
from outputs_support import corrected

from bench.harness import (
    PATIENCE_S,
    ROUND_PERIOD_US,
    ROUND_SAMPLES,
    Chain,
    hello,
    in_chunks,
    native_frames,
    nowhere,
    show,
)
from gyrodrift.config.outputs import output_of
from gyrodrift.io.log import open_log
from gyrodrift.service.output_feed import OutputFeed, memory_bytes

EARLY_SAMPLES, LATE_SAMPLES = 1_000_000, 10_000_000
MOST_GROWTH_BYTES = 5 << 20


@pytest.mark.promise("Memory and the end")
def test_memory_does_not_grow_from_one_to_ten_million_samples() -> None:
    """Memory does not grow from one to ten million samples."""
    chunks = in_chunks(b"".join([hello(), *native_frames(ROUND_SAMPLES, ROUND_PERIOD_US)]))
    with nowhere() as fd:
        chain = Chain(fd)
        _push_rounds(chain, chunks, EARLY_SAMPLES)
        early_bytes = _resident_bytes()
        _push_rounds(chain, chunks, LATE_SAMPLES)
        late_bytes = _resident_bytes()
    assert chain.state.samples == chain.output.lines >= LATE_SAMPLES
    assert chain.state.t_s == pytest.approx((chain.state.samples - 1) * ROUND_PERIOD_US * 1e-6, rel=1e-12)
    show(
        "Resident memory of the chain",
        [
            (f"after {EARLY_SAMPLES:,} samples", f"{early_bytes / 1e6:.1f} MB"),
            (f"after {LATE_SAMPLES:,} samples", f"{late_bytes / 1e6:.1f} MB"),
            ("growth", f"{(late_bytes - early_bytes) / 1e3:.0f} kB"),
        ],
    )
    assert late_bytes - early_bytes < MOST_GROWTH_BYTES


DAY_SAMPLES = 24 * 3600 * 100
"""24 h of device time at 100 Hz."""

BATCH_SAMPLES = 250
CHANGE_EVERY = 400
"""Batches between two changes of clients."""


def test_memory_of_the_outputs_does_not_grow_over_a_day_of_samples() -> None:
    """With clients that read, clients that do not, and clients that come and go all the time."""
    with _fed() as (feed, port), ExitStack() as stack:
        readers = [stack.enter_context(socket.create_connection(("127.0.0.1", port))) for _ in range(2)]
        for _ in range(3):
            stack.enter_context(socket.create_connection(("127.0.0.1", port)))
        _pour(feed, port, readers, 0, DAY_SAMPLES // 10)
        early_bytes = memory_bytes(feed.pid)
        _pour(feed, port, readers, DAY_SAMPLES // 10, DAY_SAMPLES)
        late_bytes, dropped = memory_bytes(feed.pid), feed.dropped
    show(
        "Resident memory of the outputs' process",
        [
            (f"after {DAY_SAMPLES // 10:,} samples", f"{early_bytes / 1e6:.1f} MB"),
            (f"after {DAY_SAMPLES:,} samples", f"{late_bytes / 1e6:.1f} MB"),
            ("growth", f"{(late_bytes - early_bytes) / 1e3:.0f} kB"),
            ("samples dropped before it", f"{dropped:,}"),
        ],
    )
    assert late_bytes - early_bytes < MOST_GROWTH_BYTES


@contextmanager
def _fed() -> Iterator[tuple[OutputFeed, int]]:
    """The outputs' process with a TCP port."""
    feed = OutputFeed(open_log("error", "json"), "error", "json")
    feed.want([output_of("tcp:port=0")])
    try:
        until_s = time.monotonic() + PATIENCE_S
        while not feed.statuses()[0].address:
            assert time.monotonic() < until_s
            time.sleep(0.1)
            feed.tick(time.monotonic())
        yield feed, int(feed.statuses()[0].address.rpartition(":")[2])
    finally:
        feed.close()


def _pour(feed: OutputFeed, port: int, readers: list[socket.socket], first: int, last: int) -> None:
    """Hand samples over as fast as they are taken; what comes out is read away."""
    with selectors.DefaultSelector() as selector:
        for reader in readers:
            reader.setblocking(False)
            selector.register(reader, selectors.EVENT_READ)
        for number, at in enumerate(range(first, last, BATCH_SAMPLES)):
            feed.take([corrected(seq) for seq in range(at, min(last, at + BATCH_SAMPLES))])
            while feed.wakes():
                _read_away(selector)
                feed.take([])
            _read_away(selector)
            if number % CHANGE_EVERY == 0:
                feed.tick(time.monotonic())
                with socket.create_connection(("127.0.0.1", port)) as guest:
                    guest.sendall(b"half a line")


def _read_away(selector: selectors.BaseSelector) -> None:
    for key, _ in selector.select(0.0):
        assert isinstance(key.fileobj, socket.socket)
        key.fileobj.recv(1 << 20)


def _push_rounds(chain: Chain, chunks: list[bytes], until_samples: int) -> None:
    """Whole rounds until there are so many samples, each read arriving when its last sample was taken."""
    while chain.state.samples < until_samples:
        round_s = chain.state.samples * ROUND_PERIOD_US * 1e-6
        chunk_s = ROUND_SAMPLES * ROUND_PERIOD_US * 1e-6 / len(chunks)
        for number, chunk in enumerate(chunks, 1):
            chain.push(chunk, round_s + number * chunk_s)


def _resident_bytes() -> int:
    gc.collect()
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")
