"""Ten TCP clients at full rate, five of them not reading, 1 kHz in: what is lost, how late it comes, what it costs.

Latency is from just before a frame is handed to the pty until its line is whole in the reader's hands. The loop's own
latency is that of stdout, with outputs and without.
"""

import gc
import json
import os
import select
import socket
import subprocess
import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median, quantiles

import pytest
from bench_support import PATIENCE_S, cpu_s, logged, metronome, metronome_result, serving, show
from outputs_support import corrected

from gyrodrift.config.outputs import output_of
from gyrodrift.log import open_log
from gyrodrift.outputs.json_line import json_line
from gyrodrift.service.output_feed import OutputFeed

pytestmark = pytest.mark.bench

RATE_HZ = 1000.0
SECONDS = 20.0
SETTLING_S = 3.0
SILENCE_S = 5.0
READERS = 5
SLEEPERS = 5
ROUNDS = 2


@dataclass
class Stream:
    """What came on one descriptor, each read with its time."""

    reads: list[tuple[float, bytes]] = field(default_factory=list)

    def lines(self) -> list[tuple[float, int]]:
        """Time at which each sample was whole, and its seq."""
        found = []
        pending = b""
        for read_s, chunk in self.reads:
            *whole, pending = (pending + chunk).split(b"\n")
            found += [(read_s, json.loads(line)["seq"]) for line in whole if b'"seq":' in line]
        return found


def listen(fds: Sequence[int], count: int) -> list[Stream]:
    """Read all of them until each has had so many lines, or nothing comes any more."""
    streams, left = {fd: Stream() for fd in fds}, dict.fromkeys(fds, count)
    poller = select.poll()
    for fd in fds:
        poller.register(fd, select.POLLIN)
    while any(more > 0 for more in left.values()):
        ready = poller.poll(1e3 * (SILENCE_S if streams[fds[0]].reads else PATIENCE_S))
        if not ready:
            break
        for fd, _ in ready:
            chunk = os.read(fd, 1 << 16)
            streams[fd].reads.append((time.monotonic(), chunk))
            left[fd] -= chunk.count(b'"seq":')
    return list(streams.values())


def address_in(log: Path) -> tuple[str, int]:
    """Of the output, once it listens."""
    until_s = time.monotonic() + PATIENCE_S
    while '"output_open"' not in log.read_text():
        assert time.monotonic() < until_s, log.read_text()
        time.sleep(0.05)
    host, _, port = logged(log, "output_open")["address"].rpartition(":")
    return host, int(port)


def run(folder: Path, *, has_clients: bool) -> tuple[list[list[float]], float, dict[str, object]]:
    """Latencies of stdout and of each reader in s, share of a core of both processes, and the last line of the log."""
    folder.mkdir()
    port, log, count = folder / "gyro", folder / "serve.log", round(RATE_HZ * SECONDS)
    options = ("--output", "tcp:port=0") if has_clients else ()
    gc.collect()
    gc.disable()
    with ExitStack() as stack:
        device = stack.enter_context(metronome(port, count, RATE_HZ))
        serve = stack.enter_context(serving(port, *options, log=log, stdout=subprocess.PIPE))
        assert serve.stdout is not None
        fds = [serve.stdout.fileno()]
        if has_clients:
            address = address_in(log)
            clients = [stack.enter_context(socket.create_connection(address)) for _ in range(READERS + SLEEPERS)]
            fds += [client.fileno() for client in clients[:READERS]]
        joined_s = time.monotonic()
        streams = listen(fds, count)
        share = cpu_s(serve.pid) / (time.monotonic() - joined_s)
        device.wait(PATIENCE_S)
        serve.terminate()
        serve.wait(PATIENCE_S)
    gc.enable()
    sent = metronome_result(port)
    assert sent.refused == 0
    found = []
    for stream in streams:
        lines = stream.lines()
        seqs = [seq for _, seq in lines]
        assert seqs == list(range(seqs[0], count)), "a reader lost samples"
        settled_s = joined_s + SETTLING_S
        found.append([read_s - sent.times_s[seq] for read_s, seq in lines if sent.times_s[seq] > settled_s])
    return found, share, logged(log, "service_end")


def row(name: str, latencies_s: Sequence[float]) -> tuple[str, str]:
    p99_s = quantiles(latencies_s, n=100)[98]
    return name, f"{median(latencies_s) * 1e3:.2f} / {p99_s * 1e3:.2f} / {max(latencies_s) * 1e3:.2f} ms"


def test_slow_clients_cost_nobody_a_sample(tmp_path: Path) -> None:
    """The sleepers' oldest lines are dropped, and nothing else is."""
    for number in range(ROUNDS):
        (alone, *_), share_alone, _ = run(tmp_path / f"alone{number}", has_clients=False)
        (stdout, *readers), share, end = run(tmp_path / f"clients{number}", has_clients=True)
        assert (end["missing"], end["outputs_dropped"], end["lines_dropped"]) == (0, 0, 0)
        everyone = [latency_s for reader in readers for latency_s in reader]
        show(
            f"1 kHz, {READERS} TCP clients reading and {SLEEPERS} not; latency median / p99 / worst",
            [
                row("stdout without outputs", alone),
                row("stdout with them", stdout),
                row("readers", everyone),
                ("share of a core without outputs", f"{share_alone:.1%}"),
                ("share of a core with them, loop", f"{share:.1%}"),
                ("load of the machine, 1 min", f"{os.getloadavg()[0]:.1f}"),
            ],
        )


def test_handing_over_costs_the_loop_next_to_nothing() -> None:
    """A sample at a time, to a process that serves nobody; beside a JSON line of the same sample."""
    samples = [corrected(seq) for seq in range(20_000)]
    feed = OutputFeed(open_log("error", "json"), "error", "json")
    feed.want([output_of("tcp:port=0")])
    time.sleep(SETTLING_S)
    handed_s, written_s = [], []
    for each in samples:
        start_s = time.perf_counter()
        feed.take([each])
        handed_s.append(time.perf_counter() - start_s)
        start_s = time.perf_counter()
        json_line(each)
        written_s.append(time.perf_counter() - start_s)
        time.sleep(0)
    feed.close()
    show(
        "A sample handed over to the outputs' process",
        [
            ("handed over, median", f"{median(handed_s) * 1e6:.1f} µs"),
            ("JSON line, median", f"{median(written_s) * 1e6:.1f} µs"),
            ("samples dropped", str(feed.dropped)),
        ],
    )
