"""What the benchmarks share: frames that repeat for ever, `serve` and a device as processes, and a table to print."""

import json
import os
import select
import subprocess
import sys
import time
from array import array
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
from hand_motion import hand_motion

from firmware_sim.rig import Base
from firmware_sim.wire.csv import csv_line
from firmware_sim.wire.native import (
    ACCEL_VALID,
    ENCODER_VALID,
    TEMPERATURE_VALID,
    axes_hello_frame,
    axes_sample_frame,
    hello_frame,
    sample_frame,
)
from gyrodrift.filters.hdr import HdrParams, HdrState, coefficients, step
from gyrodrift.link.clocks.device import DeviceClock
from gyrodrift.link.protocols.native import NativeDecoder
from gyrodrift.service.stdout import JsonLines
from gyrodrift.values.sample import Corrected

Process = subprocess.Popen[bytes]

BENCH = Path(__file__).resolve().parent
MODULES = f"{BENCH.parent}:{BENCH.parents[1]}:{BENCH.parents[1] / 'tests'}"
"""PYTHONPATH of a program of this folder."""

PATIENCE_S = 60.0

ROUND_SAMPLES = 1 << 16
ROUND_PERIOD_US = 1 << 16
"""At this period clock and counter wrap together after a round: the same bytes, sent again, go on from themselves."""

CHUNK_BYTES = 4096
NOISE_COUNTS = 12.0
BIAS_COUNTS = 20.0
GYRO_DPS, ACCEL_MPS2 = 0.0152588, 0.0023942
"""Counts of an MPU-6050 at ±500 deg/s and ±8 g (PS-MPU-6000A)."""


def native_frames(count: int, period_us: int) -> list[bytes]:
    """SAMPLE frames of a noisy gyro at rest, from seq 0 and 0 µs."""
    noise = Random(1)
    flags = ENCODER_VALID | TEMPERATURE_VALID
    return [
        sample_frame(flags, i, i * period_us, round(noise.gauss(BIAS_COUNTS, NOISE_COUNTS)), 2500 + i % 7, i)
        for i in range(count)
    ]


def axes_frames(count: int, period_us: int) -> list[bytes]:
    """SAMPLE3 frames of a board in a hand, as `hand_motion` has it, still for 5 s."""
    motion = hand_motion(count * period_us * 1e-6, rate_hz=1e6 / period_us)
    rates, forces = np.rint(motion.gyro_dps / GYRO_DPS), np.rint(motion.accel_mps2 / ACCEL_MPS2)
    columns = zip(rates.astype(int).tolist(), forces.astype(int).tolist(), strict=True)
    flags = ENCODER_VALID | TEMPERATURE_VALID | ACCEL_VALID
    return [
        axes_sample_frame(flags, i, i * period_us, rate, force, 2500 + i % 7, i)
        for i, (rate, force) in enumerate(columns)
    ][:count]


def csv_lines(count: int, period_us: int) -> list[bytes]:
    """The same as text."""
    noise = Random(1)
    scale = Base().dps_per_lsb
    return [
        csv_line(i * period_us, round(noise.gauss(BIAS_COUNTS, NOISE_COUNTS) * scale, 5), i / 100.0, 25.0 + i % 7)
        for i in range(count)
    ]


def hello(rate_hz: float = 100.0) -> bytes:
    """HELLO of the device that sends these frames."""
    return hello_frame(Base(sample_rate_hz=rate_hz))


def axes_hello(rate_hz: float) -> bytes:
    """HELLO of the device that sends `axes_frames`."""
    return axes_hello_frame(Base(sample_rate_hz=rate_hz, dps_per_lsb=GYRO_DPS), ACCEL_MPS2)


def in_chunks(content: bytes) -> list[bytes]:
    """Cut as a full port hands it over."""
    return [content[at : at + CHUNK_BYTES] for at in range(0, len(content), CHUNK_BYTES)]


class Chain:
    """What `serve` does to bytes, without port, waiting and log; `write_fd` takes the lines."""

    def __init__(self, write_fd: int) -> None:
        self.decoder = NativeDecoder()
        self.clock = DeviceClock(0.0)
        self.state = HdrState()
        self.output = JsonLines(write_fd)
        self._coefficients = coefficients(HdrParams())

    def push(self, chunk: bytes, arrival_s: float) -> None:
        """Take one read."""
        coefficients_now, state = self._coefficients, self.state
        corrected: list[Corrected] = []
        for sample in self.clock.stamp(self.decoder.push(chunk), arrival_s):
            if step(coefficients_now, state, sample.t_device_s, sample.rate_dps):
                rate_dps, bias_dps = sample.rate_dps + state.i_dps, 0.0 - state.i_dps
                corrected.append(Corrected(sample, rate_dps, state.yaw_deg, bias_dps))
        self.output.take(corrected)


@contextmanager
def nowhere() -> Iterator[int]:
    """A descriptor that takes everything."""
    fd = os.open(os.devnull, os.O_WRONLY)
    try:
        yield fd
    finally:
        os.close(fd)


@contextmanager
def running(*command: str | Path, stdout: int = subprocess.DEVNULL, log: Path, **env: str) -> Iterator[Process]:
    """Python as a process of its own, killed at the end; its stderr goes to the file `log`."""
    with log.open("wb") as stderr:
        process = subprocess.Popen(
            [sys.executable, *map(str, command)],
            stdin=subprocess.DEVNULL,
            stdout=stdout,
            stderr=stderr,
            env=os.environ | env,
        )
    try:
        yield process
    finally:
        process.kill()
        process.wait()
        if process.stdout is not None:
            process.stdout.close()


@contextmanager
def serving(port: Path, *options: str | Path, log: Path, stdout: int = subprocess.DEVNULL) -> Iterator[Process]:
    """`gyrodrift serve` on a port, with a log that is easy to read back."""
    command = ("-m", "gyrodrift", "serve", "--port", port, "--log-format", "json", *options)
    with running(*command, stdout=stdout, log=log) as serve:
        yield serve


@contextmanager
def metronome(port: Path, count: int, rate_hz: float = 0.0, protocol: str = "native") -> Iterator[Process]:
    """The device in a process of its own, ready for a reader; `rate_hz` 0 is as fast as it is read."""
    log = port.with_suffix(".log")
    command = (BENCH / "metronome.py", port, port.with_suffix(".json"), str(count), str(rate_hz), protocol)
    with running(*command, log=log, PYTHONPATH=MODULES) as process:
        until_s = time.monotonic() + PATIENCE_S
        while not port.is_symlink():
            assert process.poll() is None, log.read_text()
            assert time.monotonic() < until_s, "the device was never ready"
            time.sleep(0.01)
        yield process


def logged(log: Path, event: str) -> dict[str, Any]:
    """The last event of that name in a log of `serve`."""
    found = [json.loads(line) for line in log.read_text().splitlines() if f'"{event}"' in line]
    assert found, f"no {event} in the log:\n{log.read_text()}"
    return dict(found[-1])


@dataclass(frozen=True)
class Sent:
    """What the metronome did: `times_s` is when each paced frame went out, monotonic."""

    refused: int
    seconds: float
    times_s: Sequence[float]


def metronome_result(port: Path) -> Sent:
    """What it wrote down when it was done."""
    said = json.loads(port.with_suffix(".json").read_text())
    times_s = array("d")
    times_s.frombytes(port.with_suffix(".times").read_bytes())
    return Sent(said["refused"], said["seconds"], times_s)


def cpu_s(pid: int) -> float:
    """Processor time of a process so far, user and system, s."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def is_readable(fd: int, wait_s: float) -> bool:
    """Wait until there is something to read."""
    poller = select.poll()
    poller.register(fd, select.POLLIN)
    return bool(poller.poll(wait_s * 1e3))


def repeat(times: int, measure: Callable[[], float]) -> list[float]:
    """What some runs of a measurement gave, in ascending order."""
    return sorted(measure() for _ in range(times))


def show(title: str, rows: Sequence[tuple[str, str]]) -> None:
    """Print a table of two columns."""
    width = max(len(name) for name, _ in rows)
    body = "\n".join(f"  {name:{width}}  {value:>14}" for name, value in rows)
    sys.stdout.write(f"\n\n{title}\n{body}\n")
