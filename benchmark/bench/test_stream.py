"""A steady stream over a pty into a real `serve`: what is lost, how late it comes, how much of a core it takes."""

import gc
import json
import os
import subprocess
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median, quantiles

import pytest

from bench.harness import PATIENCE_S, cpu_s, is_readable, logged, metronome, metronome_result, serving, show

SETTLING_S = 1.0
SILENCE_S = 5.0
FILTERS = {"native": "hdr", "axes": "restlevel"}
"""Filter by protocol: of one axis and of three."""


@dataclass
class Heard:
    """What came out of `serve`: each read with its time, and the share of a core it took from SETTLING_S on."""

    reads: list[tuple[float, bytes]] = field(default_factory=list)
    cpu_share: float = 0.0

    def lines(self) -> list[tuple[float, int]]:
        """Time at which each line was complete in the reader's hands, and its seq."""
        found = []
        pending = b""
        for read_s, chunk in self.reads:
            *whole, pending = (pending + chunk).split(b"\n")
            found += [(read_s, json.loads(line)["seq"]) for line in whole]
        return found


def listen(pid: int, fd: int, count: int) -> Heard:
    """Read until `count` lines have come, or none has for SILENCE_S."""
    heard = Heard()
    lines, settled_s, settled_cpu_s = 0, 0.0, 0.0
    while lines < count and is_readable(fd, SILENCE_S if lines else PATIENCE_S):
        chunk = os.read(fd, 1 << 16)
        now_s = time.monotonic()
        heard.reads.append((now_s, chunk))
        lines += chunk.count(b"\n")
        if not settled_s and now_s - heard.reads[0][0] > SETTLING_S:
            settled_s, settled_cpu_s = now_s, cpu_s(pid)
    heard.cpu_share = (cpu_s(pid) - settled_cpu_s) / (time.monotonic() - settled_s)
    return heard


def stream(tmp_path: Path, rate_hz: float, seconds: float, rounds: int, protocol: str = "native") -> None:
    """Some rounds of streaming at a rate, shown beside each other."""
    for number in range(rounds):
        folder = tmp_path / str(number)
        folder.mkdir()
        _stream_once(folder, rate_hz, round(rate_hz * seconds), protocol)


def _stream_once(folder: Path, rate_hz: float, count: int, protocol: str) -> None:
    port, log = folder / "gyro", folder / "serve.log"
    gc.collect()
    gc.disable()
    with (
        metronome(port, count, rate_hz, protocol) as device,
        serving(port, "--filter", FILTERS[protocol], log=log, stdout=subprocess.PIPE) as serve,
    ):
        assert serve.stdout is not None
        heard = listen(serve.pid, serve.stdout.fileno(), count)
        device.wait(PATIENCE_S)
        serve.terminate()
        serve.wait(PATIENCE_S)
    gc.enable()
    sent, lines = metronome_result(port), heard.lines()
    assert [seq for _, seq in lines] == list(range(count)), log.read_text()
    latencies_s = [read_s - sent.times_s[seq] for read_s, seq in lines if seq > rate_hz * SETTLING_S]
    assert logged(log, "service_end")["missing"] == sent.refused == 0
    _show(rate_hz, count - len(lines), latencies_s, heard.cpu_share)


def _show(rate_hz: float, lost: int, latencies_s: Sequence[float], cpu_share: float) -> None:
    show(
        f"Stream at {rate_hz:g} Hz",
        [
            ("samples lost", str(lost)),
            ("latency, median", f"{median(latencies_s) * 1e6:.0f} µs"),
            ("latency, p99", f"{quantiles(latencies_s, n=100)[98] * 1e6:.0f} µs"),
            ("latency, worst", f"{max(latencies_s) * 1e6:.0f} µs"),
            ("share of a core", f"{cpu_share:.2%}"),
        ],
    )


@pytest.mark.promise("Samples")
@pytest.mark.promise("Latency", "the line on stdout (speed): median 0.14 ms, 99th percentile 0.4 to 1.2 ms")
def test_nothing_is_lost_at_1_khz(tmp_path: Path) -> None:
    """At 1 kHz no sample is lost."""
    stream(tmp_path, 1000.0, seconds=10.0, rounds=3)


def test_nothing_is_lost_at_1_khz_with_six_axes(tmp_path: Path) -> None:
    stream(tmp_path, 1000.0, seconds=20.0, rounds=3, protocol="axes")


@pytest.mark.promise("Samples")
def test_nothing_is_lost_at_10_khz(tmp_path: Path) -> None:
    """At 10 kHz no sample is lost."""
    stream(tmp_path, 10000.0, seconds=5.0, rounds=3)
