"""Ten TCP clients at full rate, five of them not reading, 1 kHz in: what is lost, how late it comes, what it costs.

Beside them, in rounds of their own, the page, rosbridge, foxglove and MQTT with a client each. Latency is from just
before a frame is handed to the pty until its line is whole in the reader's hands. The loop's own latency is that of
stdout, with outputs and without.
"""

import gc
import json
import os
import select
import socket
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path
from statistics import median, quantiles

import pytest
from broker_support import broker, need_mosquitto
from outputs_support import corrected
from support import free_port

from bench.harness import BENCH, PATIENCE_S, cpu_s, logged, metronome, metronome_result, serving, show
from gyrodrift.config.outputs import output_of
from gyrodrift.io.log import open_log
from gyrodrift.outputs.json_line import json_line
from gyrodrift.service.output_feed import OutputFeed

need_mosquitto()

RATE_HZ = 1000.0
SECONDS = 20.0
SETTLING_S = 3.0
SILENCE_S = 5.0
READERS = 5
MORE = ("web", "rosbridge", "foxglove")
SLEEPERS = 5
ROUNDS = 2


class Outputs(Enum):
    """What is on, and how a table says it."""

    NONE = ", no outputs"
    TCP = ""
    MANY = ", page, rosbridge, foxglove and MQTT"


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


def address_of(output: str, log: Path) -> str:
    """Of an output, once it is open."""
    until_s = time.monotonic() + PATIENCE_S
    while True:
        lines = [json.loads(line) for line in log.read_text().splitlines() if '"output_open"' in line]
        found = [line["address"] for line in lines if line["output"] == output]
        if found:
            return str(found[0])
        assert time.monotonic() < until_s, log.read_text()
        time.sleep(0.05)


@contextmanager
def many_clients(log: Path, broker_port: int) -> Iterator[None]:
    """The page's stream, rosbridge and foxglove are read by a process, MQTT by mosquitto_sub; each hears something."""
    urls = [f"{kind}=ws://{address_of(kind, log).removeprefix('http://')}" for kind in MORE]
    readers = subprocess.Popen([sys.executable, BENCH / "websocket_readers.py", *urls], stdout=subprocess.PIPE)
    topics = ("mosquitto_sub", "-h", "127.0.0.1", "-p", str(broker_port), "-t", "gyrodrift/#")
    mqtt = subprocess.Popen(topics, stdout=subprocess.PIPE)
    with readers, mqtt:
        try:
            yield
        finally:
            readers.terminate()
            mqtt.terminate()
            heard = json.loads(readers.communicate(timeout=PATIENCE_S)[0])
            assert all(heard.values()), heard
            assert mqtt.communicate(timeout=PATIENCE_S)[0]


def run(folder: Path, outputs: Outputs) -> tuple[list[list[float]], float, dict[str, object]]:
    """Latencies of stdout and of each reader in s, share of a core of the loop, and the last line of the log."""
    folder.mkdir()
    port, log, count, broker_port = folder / "gyro", folder / "serve.log", round(RATE_HZ * SECONDS), free_port()
    tcp = ("--output", "tcp:port=0")
    more = [word for name in MORE for word in ("--output", f"{name}:port=0")]
    options = {
        Outputs.NONE: (),
        Outputs.TCP: tcp,
        Outputs.MANY: (*tcp, *more, "--output", f"mqtt:port={broker_port}"),
    }[outputs]
    gc.collect()
    gc.disable()
    with ExitStack() as stack:
        if outputs is Outputs.MANY:
            stack.enter_context(broker(broker_port, folder))
        device = stack.enter_context(metronome(port, count, RATE_HZ))
        serve = stack.enter_context(serving(port, *options, log=log, stdout=subprocess.PIPE))
        assert serve.stdout is not None
        fds = [serve.stdout.fileno()]
        if outputs is not Outputs.NONE:
            host, _, number = address_of("tcp", log).rpartition(":")
            clients = [
                stack.enter_context(socket.create_connection((host, int(number)))) for _ in range(READERS + SLEEPERS)
            ]
            fds += [client.fileno() for client in clients[:READERS]]
        if outputs is Outputs.MANY:
            stack.enter_context(many_clients(log, broker_port))
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


@pytest.mark.promise("Samples")
@pytest.mark.promise(
    "Latency",
    "a TCP client, with five others that do not read: median 0.46 ms, 99th percentile 1.9 ms",
)
@pytest.mark.promise(
    "Latency",
    "the same with page, rosbridge, foxglove and MQTT (worse of two rounds): median 0.5 ms, 99th percentile 5.4 ms",
)
@pytest.mark.parametrize("outputs", [Outputs.TCP, Outputs.MANY])
def test_slow_clients_cost_nobody_a_sample(tmp_path: Path, outputs: Outputs) -> None:
    """A slow client costs no other client a sample."""
    for number in range(ROUNDS):
        (alone, *_), share_alone, _ = run(tmp_path / f"alone{number}", Outputs.NONE)
        (stdout, *readers), share, end = run(tmp_path / f"clients{number}", outputs)
        assert (end["missing"], end["outputs_dropped"], end["lines_dropped"]) == (0, 0, 0)
        everyone = [latency_s for reader in readers for latency_s in reader]
        show(
            f"1 kHz, {READERS} TCP clients reading and {SLEEPERS} not{outputs.value}; latency median / p99 / worst",
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
