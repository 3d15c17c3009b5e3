"""Ten sources of 1 kHz in one service: what is lost, and what it costs beside a plain reader of the same sockets."""

import json
import subprocess
import time
from contextlib import ExitStack
from pathlib import Path

import pytest
from support import free_port

from bench.harness import BENCH, MODULES, PATIENCE_S, Process, cpu_s, running, show

RATE_HZ, SECONDS = 1000.0, 30.0
COUNT = round(RATE_HZ * SECONDS)


def addresses(folder: Path) -> list[str]:
    """Four that send datagrams come first, so that they are listened to before the servers have their clients."""
    udp = [f"udp://:{free_port()}" for _ in range(4)]
    return [*udp, *(f"tcp://127.0.0.1:{free_port()}" for _ in range(3)), *(f"unix:{folder}/{n}" for n in range(3))]


def gyros(stack: ExitStack, folder: Path, ports: list[str]) -> Process:
    result = folder / "sent"
    words: tuple[str | Path, ...] = (BENCH / "several_gyros.py", result, str(COUNT), str(RATE_HZ), *ports)
    process = stack.enter_context(running(*words, log=folder / "gyros.log", PYTHONPATH=MODULES))
    wait_for(result.with_suffix(".ready"))
    return process


def wait_for(path: Path, patience_s: float = PATIENCE_S) -> None:
    until_s = time.monotonic() + patience_s
    while not path.exists():
        assert time.monotonic() < until_s, f"no {path}"
        time.sleep(0.01)


@pytest.mark.promise("Samples")
def test_ten_sources_of_1_khz_in_one_service(tmp_path: Path) -> None:
    """Ten sources of 1 kHz in one service lose no sample."""
    ports = addresses(tmp_path)
    config = tmp_path / "gyros.yaml"
    config.write_text("sources:\n" + "".join(f"  g{n}: {{port: '{port}'}}\n" for n, port in enumerate(ports)))
    log = tmp_path / "serve.log"
    words = ("-m", "gyrodrift", "serve", "--config", config, "--log-format", "json")
    with ExitStack() as stack:
        sender = gyros(stack, tmp_path, ports)
        drain = stack.enter_context(subprocess.Popen(["cat"], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL))
        assert drain.stdin is not None
        serve = stack.enter_context(running(*words, log=log, stdout=drain.stdin.fileno()))
        drain.stdin.close()
        begun_s = cpu_s(serve.pid)
        wait_for(tmp_path / "sent", SECONDS + PATIENCE_S)
        used_s = cpu_s(serve.pid) - begun_s
        assert sender.poll() is None
        time.sleep(1.0)
        serve.terminate()
        serve.wait(PATIENCE_S)
    ends = [json.loads(line) for line in log.read_text().splitlines() if '"service_end"' in line]
    sent = json.loads((tmp_path / "sent").read_text())
    rows = [
        ("refused by the sockets", f"{sent['refused']}"),
        ("sender late by at most", f"{1e3 * sent['late_s']:.0f} ms"),
        ("lost", f"{sum(end['missing'] for end in ends)}"),
        ("lines dropped", f"{max(end['lines_dropped'] for end in ends)}"),
        ("share of a core, with the start", f"{100.0 * used_s / sent['seconds']:.0f} %"),
    ]
    show(f"ten sources of {RATE_HZ:.0f} Hz in one service, {sent['seconds']:.0f} s", rows)
    assert len(ends) == len(ports)
    assert {end["samples"] + end["before_hello"] for end in ends} == {COUNT}
    assert {(end["missing"], end["damaged"], end["lines_dropped"]) for end in ends} == {(0, 0, 0)}


def test_a_plain_reader_of_the_same_sockets(tmp_path: Path) -> None:
    """The least that can be done: nothing is decoded, timed, filtered or written."""
    ports = addresses(tmp_path)
    counts = tmp_path / "counts"
    with ExitStack() as stack:
        gyros(stack, tmp_path, ports)
        words: tuple[str | Path, ...] = (BENCH / "plain_reader.py", counts, str(SECONDS + 2.0), *ports)
        reader = stack.enter_context(running(*words, log=tmp_path / "reader.log"))
        wait_for(tmp_path / "sent", SECONDS + PATIENCE_S)
        used_s = cpu_s(reader.pid)
        wait_for(counts)
    frames = json.loads(counts.read_text())
    rows = [
        ("frames with HELLO", f"{sum(frames)}"),
        ("share of a core, with the start", f"{100.0 * used_s / SECONDS:.0f} %"),
    ]
    show("a plain reader of the same sockets", rows)
    assert set(frames) == {COUNT + SECONDS}
