"""Sessions: how fast and in what memory ours are loaded beside the public reader, and what recording costs."""

import json
import subprocess
import sys
import time
from pathlib import Path
from statistics import median

import numpy as np
import pytest
from mcap.reader import make_reader

from bench.harness import PATIENCE_S, cpu_s, logged, metronome, metronome_result, running, show
from gyrodrift.session.files import write_session
from gyrodrift.session.mcap.read import read_mcap
from gyrodrift.session.session import Session

SAMPLES = 10_000_000
PUBLIC_SAMPLES = 200_000
ARRAY_BYTES = 6 * 8

LOADING = """
import json, sys
from pathlib import Path
from gyrodrift.session.mcap.read import read_mcap

def peak_bytes():
    (line,) = (line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM"))
    return int(line.split()[1]) * 1024

before = peak_bytes()
count = len(read_mcap(Path(sys.argv[1])).rate_dps)
print(json.dumps([count, peak_bytes() - before]))
"""


def session_of(count: int, path: Path) -> Path:
    t_s = np.arange(count) / 1000.0
    noise = np.random.default_rng(1).normal(0.0, 0.1, count)
    chunk = Session("s", t_s, noise, t_s + 1.7e9, np.arange(count), 0.1 * t_s, 25.0 + 0.001 * t_s)
    write_session(path, [chunk])
    return path


def timed_s(path: Path) -> float:
    begun_s = time.perf_counter()
    read_mcap(path)
    return time.perf_counter() - begun_s


def public_s(path: Path) -> float:
    """The public reader, without decoding what it reads."""
    begun_s = time.perf_counter()
    with path.open("rb") as file:
        count = sum(1 for _ in make_reader(file).iter_messages())
    assert count == PUBLIC_SAMPLES
    return time.perf_counter() - begun_s


def test_ten_million_samples_load_in_a_second_or_two(tmp_path: Path) -> None:
    path, small = session_of(SAMPLES, tmp_path / "ten.mcap"), session_of(PUBLIC_SAMPLES, tmp_path / "small.mcap")
    ours_ns = [timed_s(path) / SAMPLES * 1e9 for _ in range(5)]
    public_ns = [public_s(small) / PUBLIC_SAMPLES * 1e9 for _ in range(3)]
    loaded = subprocess.run([sys.executable, "-c", LOADING, path], capture_output=True, check=True, text=True)
    count, grown_bytes = json.loads(loaded.stdout)
    assert count == SAMPLES
    show(
        "Loading ten million samples",
        [
            ("rate, first run", f"{1e3 / ours_ns[0]:.1f} M/s"),
            ("rate, median", f"{1e3 / median(ours_ns):.1f} M/s"),
            ("public reader", f"{1e3 / median(public_ns):.3f} M/s"),
            ("ratio to the public reader", f"{median(public_ns) / median(ours_ns):.0f}"),
            ("peak memory, in sizes of the arrays", f"{grown_bytes / SAMPLES / ARRAY_BYTES:.2f}"),
        ],
    )
    assert grown_bytes < 2 * SAMPLES * ARRAY_BYTES


@pytest.mark.parametrize("rate_hz", [1000.0, 10000.0])
@pytest.mark.parametrize("keeps", ["samples", "samples and raw bytes"])
def test_recording_takes_a_small_share_of_a_core(tmp_path: Path, rate_hz: float, keeps: str) -> None:
    port, log, out = tmp_path / "gyro", tmp_path / "record.log", tmp_path / "out"
    count = round(rate_hz * 6.0)
    command = ["-m", "gyrodrift", "record", "--port", port, "--out", out, "--log-format", "json"]
    command += ["--raw"] if keeps != "samples" else []
    with metronome(port, count, rate_hz) as device, running(*map(str, command), log=log) as record:
        time.sleep(1.5)  # until it has started
        begun_s, begun_cpu_s = time.monotonic(), cpu_s(record.pid)
        time.sleep(4.0)  # what is measured
        share = (cpu_s(record.pid) - begun_cpu_s) / (time.monotonic() - begun_s)
        device.wait(PATIENCE_S)
        record.terminate()
        record.wait(PATIENCE_S)
    (path,) = out.glob("*.mcap")
    seq = read_mcap(path).seq
    assert seq is not None
    assert metronome_result(port).refused == logged(log, "record_end")["missing"] == 0
    assert seq.tolist() == list(range(count))
    show(f"Recording {keeps} at {rate_hz:g} Hz", [("samples lost", "0"), ("share of a core", f"{share:.2%}")])
