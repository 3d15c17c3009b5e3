"""Memory of the chain over ten million samples: clock and counter wrap, lines go out, nothing piles up."""

import gc
import os
from pathlib import Path

import pytest
from bench_support import ROUND_PERIOD_US, ROUND_SAMPLES, Chain, hello, in_chunks, native_frames, nowhere, show

pytestmark = pytest.mark.bench

EARLY_SAMPLES, LATE_SAMPLES = 1_000_000, 10_000_000
MOST_GROWTH_BYTES = 5 << 20


def test_memory_does_not_grow_from_one_to_ten_million_samples() -> None:
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
