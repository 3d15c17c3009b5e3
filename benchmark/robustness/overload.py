"""Too much of everything: samples, work for the processors, silence of a reader, and a clock that is set.

In each case what was lost is known from the device's side, and the service has to count exactly that and go on.
"""

import json
import os
import signal
import subprocess
import sys
import time
from binascii import crc_hqx
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from struct import Struct
from tempfile import TemporaryDirectory
from typing import Any

from cobs import cobs

from firmware_sim.pty import PtyDevice
from firmware_sim.rig import Base
from firmware_sim.wire.native import hello_frame
from gyrodrift.session.mcap.read import read_mcap

BASE = Base(sample_rate_hz=1000, encoder_cpr=0)
SAMPLE = Struct("<BBHIhhi")
CHUNK_S = 0.001
CALM_HZ = 1000
PATIENCE_S = 60.0

SEAM = """
import os, sys, time
real, path = time.time, sys.argv.pop(1)
time.time = lambda: real() + float(open(path).read() or 0)
from gyrodrift.cli import main
sys.exit(main(sys.argv[1:]))
"""
"""A command whose calendar stands as far off as a file says: the machine's own clock is left alone."""


@dataclass(slots=True)
class OverloadResult:
    """One case: what the device sent and the link took, and what the service said at its end."""

    name: str
    sent: int = 0
    lost_by_link: int = 0
    stats: dict[str, Any] = field(default_factory=dict)
    told: list[str] = field(default_factory=list)
    facts: dict[str, float] = field(default_factory=dict)
    broken: list[str] = field(default_factory=list)

    def check(self) -> "OverloadResult":
        """Every sample is either taken or counted as missing."""
        taken, missing = int(self.stats["samples"]), int(self.stats["missing"])
        if taken != self.sent - self.lost_by_link:
            self.broken.append(f"{self.sent - self.lost_by_link} samples came and {taken} were taken")
        if missing != self.lost_by_link:
            self.broken.append(f"{self.lost_by_link} samples were lost and {missing} were counted")
        if self.lost_by_link and "gap" not in self.told:
            self.broken.append("nothing was told of what was lost")
        if int(self.stats["device_resets"]) or int(self.stats["rejected"]):
            self.broken.append("a reset was seen, or samples were rejected")
        return self

    def text(self) -> str:
        """A line for a person."""
        facts = "".join(f", {name} {value:.4g}" for name, value in self.facts.items())
        told = f"{self.sent} sent, {self.lost_by_link} lost by the link, {self.stats['missing']} counted as missing"
        return f"{self.name}: {told}{facts}" + "".join(f"\n  broken: {each}" for each in self.broken)


class Bench:
    """A service under load, and the device that knows what it sent."""

    def __init__(self, folder: Path, *words: str, program: tuple[str, ...] = ("-m", "gyrodrift")) -> None:
        self.folder, self.sent, self.lost, self.rest = folder, 0, 0, b""
        self._count, self._t_us = 0, 0.0
        self._device = PtyDevice(folder / "gyro", hello_frame(BASE))
        self._log = (folder / "log").open("wb")
        options = ("--baud", "115200", "--protocol", "native", "--log-format", "json", *words)
        command = [sys.executable, *program, "serve", "--port", str(folder / "gyro"), *options]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=self._log)
        self._device.wait_for_reader(lambda: self.process.poll() is not None)

    def frames(self, samples: int, rate_hz: float) -> bytes:
        """So many at a pace of their own, by the device's clock."""
        found = []
        for count in range(self._count, self._count + samples):
            self._t_us += 1e6 / rate_hz
            payload = SAMPLE.pack(2, 0, count & 0xFFFF, int(self._t_us) & 0xFFFFFFFF, count % 200, 0, 0)
            found.append(cobs.encode(payload + crc_hqx(payload, 0xFFFF).to_bytes(2, "little")) + b"\0")
        self._count += samples
        return b"".join(found)

    def speak(self, seconds: float, rate_hz: float, between: Callable[[], object] = lambda: None) -> None:
        """In real time, whether anybody reads or not; a period is of whole microseconds, as clocks count them."""
        rate_hz = 1e6 / max(1, round(1e6 / rate_hz))
        each = max(1, round(rate_hz * CHUNK_S))
        chunks = [self.frames(each, rate_hz) for _ in range(round(seconds * rate_hz / each))]
        begun_s = time.monotonic()
        for number, chunk in enumerate(chunks):
            while time.monotonic() < begun_s + number * each / rate_hz:
                time.sleep(CHUNK_S / 4)
            self.sent += each
            self.lost += 0 if self._device.send(chunk) else each
            between()

    def pour(self, samples: int, between: Callable[[], object] = lambda: None) -> float:
        """As fast as the service takes them; samples per second."""
        begun_s = time.monotonic()
        for _ in range(samples // CALM_HZ):
            assert self._device.send_all(self.frames(CALM_HZ, CALM_HZ), lambda: self.process.poll() is not None)
            self.sent += CALM_HZ
            between()
        return samples / (time.monotonic() - begun_s)

    def end(self, name: str) -> OverloadResult:
        """Calm again, and over: the last sample of all shows what was lost before it."""
        self.speak(0.5, CALM_HZ)
        self._device.drain()
        time.sleep(0.3)
        self.process.send_signal(signal.SIGTERM)
        with suppress(subprocess.TimeoutExpired):
            self.rest = self.process.communicate(timeout=PATIENCE_S)[0]
        events = [json.loads(line) for line in (self.folder / "log").read_text().splitlines()]
        told = [str(each["event"]) for each in events]
        result = OverloadResult(name, self.sent, self.lost, events[-1], told)
        if self.process.returncode or told[-1] != "service_end":
            result.broken.append(f"the service ended with {self.process.returncode}")
        return result

    def close(self) -> None:
        """Whatever became of it."""
        self.process.kill()
        self.process.wait()
        assert self.process.stdout is not None
        self.process.stdout.close()
        self._device.close()
        self._log.close()


@contextmanager
def bench(*words: str, program: tuple[str, ...] = ("-m", "gyrodrift")) -> Iterator[Bench]:
    """A service of its own in a folder of its own."""
    with TemporaryDirectory() as folder, ExitStack() as closing:
        made = Bench(Path(folder), *words, program=program)
        closing.callback(made.close)
        yield made


def too_many_samples(times: float, seconds: float) -> OverloadResult:
    """So many times what it takes, then calm again."""
    with bench("--rate", "1") as each:
        each.pour(2 * CALM_HZ)  # start-up is over
        able_hz = each.pour(40 * CALM_HZ)
    with bench("--rate", "1") as each:
        each.speak(seconds, times * able_hz)
        result = each.end(f"{times:g} times what it takes, for {seconds:g} s")
    result.facts["taken at most per second"] = able_hz
    return result.check()


def busy_processors(seconds: float) -> OverloadResult:
    """A process that spins on each core."""
    with bench("--rate", "1") as each, ExitStack() as closing:
        for _ in range(os.cpu_count() or 1):
            spinning = subprocess.Popen([sys.executable, "-c", "while True: pass"])
            closing.callback(spinning.wait)
            closing.callback(spinning.kill)
        each.speak(seconds, CALM_HZ)
        return each.end(f"a spinning process on each core, {seconds:g} s at 1 kHz").check()


def stopped(seconds: float) -> OverloadResult:
    """SIGSTOP, and SIGCONT after a while."""
    with bench("--rate", "1") as each:
        each.speak(1.0, CALM_HZ)
        each.process.send_signal(signal.SIGSTOP)
        each.speak(seconds, CALM_HZ)
        each.process.send_signal(signal.SIGCONT)
        each.speak(1.0, CALM_HZ)
        return each.end(f"stopped for {seconds:g} s").check()


def clock_set(by_s: float = 3600.0) -> OverloadResult:
    """The host's clock set forward, and back again, while it records."""
    with TemporaryDirectory() as folder:
        offset, out = Path(folder) / "offset", Path(folder) / "out"
        offset.write_text("0")
        with bench("--rate", "1", "--record", str(out), program=("-c", SEAM, str(offset))) as each:
            for step_s in (0.0, by_s, 0.0):
                fresh = offset.with_name("fresh")
                fresh.write_text(str(step_s))
                fresh.replace(offset)
                each.speak(1.0, CALM_HZ)
            result = each.end(f"the host's clock set by {by_s:g} s and back").check()
        sessions = [read_mcap(path) for path in sorted(out.glob("*.mcap"))]
    longest_s = max(float(each.t_host_s[-1] - each.t_host_s[0]) for each in sessions if each.t_host_s is not None)
    result.facts |= {"files": len(sessions), "longest in a file, s": longest_s}
    if sum(len(each.rate_dps) for each in sessions) != int(result.stats["samples"]):
        result.broken.append("samples are missing in the files")
    if result.told.count("host_clock_set") != 2 or longest_s > PATIENCE_S:
        result.broken.append("two calendars in one file, or a step that nobody told")
    return result


def silent_reader(samples: int) -> OverloadResult:
    """Nobody reads its lines while very many come; then somebody does."""
    with bench() as each:
        each.pour(samples)
        assert each.process.stdout is not None
        result = each.end(f"a reader that takes nothing of {samples} lines").check()
        lines = [json.loads(line) for line in each.rest.split(b"\n")[:-1]]
    dropped = int(result.stats["lines_dropped"])
    result.facts |= {"lines dropped": dropped, "lines read": len(lines)}
    if not dropped or len(lines) + dropped != result.sent:
        result.broken.append(f"{len(lines)} lines came, and {dropped} of {result.sent} were counted as dropped")
    return result


def all_cases() -> Iterator[Callable[[], OverloadResult]]:
    """At full length."""
    yield lambda: too_many_samples(2.0, 5.0)
    yield lambda: too_many_samples(10.0, 3.0)
    yield lambda: busy_processors(10.0)
    yield lambda: stopped(10.0)
    yield clock_set
    yield lambda: silent_reader(80_000)
