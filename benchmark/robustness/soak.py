"""A soak: hours of device time at 1 kHz, as fast as they go or at a pace, with reloads, pulled cables and clients.

Memory, descriptors and threads of the service have to stay flat, every sample has to be taken, and yaw has to be that
of the filter over the same samples.
"""

import random
import select
import signal
import socket
import subprocess
import sys
import time
from collections import deque
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from math import inf, isinf
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from firmware_sim.pty import PtyDevice
from firmware_sim.rig import Base
from firmware_sim.wire.native import hello_frame, sample_frame
from gyrodrift.filters.registry import FILTERS
from gyrodrift.service.control_client import ControlClient
from gyrodrift.service.output_feed import memory_bytes
from gyrodrift.values.errors import UsageError

RATE_HZ = 1000
BASE = Base(sample_rate_hz=RATE_HZ, encoder_cpr=0)
FILTER = FILTERS["restlevel"]
TURN_EVERY_S, TURN_S, TURN_LSB = 20, 6, 4000
BIAS_LSB, NOISE_LSB = 46, 6

RELOAD_EVERY_S, UNPLUG_EVERY_S, CLIENT_EVERY_S, LOOK_EVERY_S = 97, 311, 7, 30
"""Of device time, with no common divisor."""

MOST_CLIENTS = 4
PASSING_THREADS = 1
"""One that writes the memory file may be at it in the very moment; a leak is one with each reload."""

WARM_S = 120
"""Of device time, before which memory may still grow."""

CONFIGS = ("filter: restlevel\nsample_rate_hz: 1000\n", "filter: restlevel\nsample_rate_hz: 1000.5\n")
PIECES = 100
"""Into which a second is cut at a pace: a device speaks as it measures."""

LATEST_S = 0.1
"""What a device that was held up makes up for; after a pulled cable it goes on from now."""

PATIENCE_S = 60.0
SLACK_BYTES = 8 << 20


@dataclass(frozen=True, slots=True)
class Footprint:
    """What service and outputs together hold."""

    resident_bytes: int
    descriptors: int
    threads: int


@dataclass(slots=True)
class SoakResult:
    """What it came to; footprints are those of each look, in order of time."""

    device_s: int = 0
    elapsed_s: float = 0.0
    reloads: int = 0
    reconnects: int = 0
    clients: int = 0
    unsent: int = 0
    yaw_deg: float = 0.0
    footprints: list[Footprint] = field(default_factory=list)
    status: dict[str, Any] = field(default_factory=dict)

    def broken_promises(self) -> Iterator[str]:
        """What must not be, and was."""
        link, served = self.status["link"], self.status["filter"]
        sent = self.device_s * RATE_HZ - self.unsent
        if link["samples"] != sent or link["missing"] != self.unsent or link["device_resets"]:
            yield f"{link['samples']} of {sent} samples, {link['missing']} of {self.unsent} told as missing"
        if abs(served["yaw_deg"] - self.yaw_deg) > 1e-9:
            yield f"yaw is {served['yaw_deg']}, that of the filter alone {self.yaw_deg}"
        if served["rejected"] or self.status["config"]["refused"]:
            yield f"{served['rejected']} samples and {self.status['config']['refused']} configs were refused"
        warm = self.footprints[min(WARM_S // LOOK_EVERY_S, len(self.footprints) - 1)]
        last = self.footprints[-1]
        if last.resident_bytes > warm.resident_bytes + SLACK_BYTES:
            yield f"memory grew from {warm.resident_bytes / 1e6:.1f} to {last.resident_bytes / 1e6:.1f} MB"
        if last.descriptors > warm.descriptors + MOST_CLIENTS or last.threads > warm.threads + PASSING_THREADS:
            yield f"descriptors or threads grew from {warm} to {last}"

    def text(self) -> str:
        """For a person."""
        first, last = self.footprints[0], self.footprints[-1]
        most = max(each.resident_bytes for each in self.footprints)
        return (
            f"{self.device_s / 3600:.2f} h of device time at {RATE_HZ} Hz in {self.elapsed_s / 60:.1f} min: "
            f"{self.status['link']['samples']} samples, {self.status['link']['missing']} missing, "
            f"{self.unsent} that the port had no room for\n"
            f"{self.reloads} reloads, {self.reconnects} reconnects, {self.clients} clients\n"
            f"memory {first.resident_bytes / 1e6:.1f} MB at first, {most / 1e6:.1f} at most, "
            f"{last.resident_bytes / 1e6:.1f} at the end; descriptors {first.descriptors} to {last.descriptors}, "
            f"threads {first.threads} to {last.threads}\n"
            f"yaw {self.status['filter']['yaw_deg']:.6f} deg, of the filter alone {self.yaw_deg:.6f} deg"
        )


class Soak:
    """A service, its device and its clients; `pace` is in seconds of the device for one of ours, inf as fast as can."""

    def __init__(self, folder: Path, pace: float = inf) -> None:
        self.result = SoakResult()
        self._config, self._control, self._port = folder / "c.yaml", folder / "control", folder / "gyro"
        self._unix = folder / "out"
        self._dice = random.Random(1)
        self._count = 0
        self._coefficients, self._state = FILTER.coefficients(FILTER.params()), FILTER.state()
        self._clients: deque[socket.socket] = deque()
        self._folder, self._pace = folder, pace
        self._due_s = 0.0
        self._raw: list[int] = []

    def run(self, seconds: int, most_s: float) -> SoakResult:
        """So many seconds of device time, or as many as `most_s` of real time take."""
        self._config.write_text(CONFIGS[0])
        with ExitStack() as closing:
            device = PtyDevice(self._port, hello_frame(BASE))
            closing.callback(device.close)
            log = closing.enter_context((self._folder / "log").open("wb"))
            service = subprocess.Popen(self._command(), stdout=subprocess.DEVNULL, stderr=log)
            closing.callback(service.wait)
            closing.callback(service.kill)
            device.wait_for_reader(lambda: service.poll() is not None)
            until_s = time.monotonic() + PATIENCE_S
            while not self._unix.exists() and time.monotonic() < until_s:
                time.sleep(0.05)
            begun_s = time.monotonic()
            for second in range(seconds):
                if time.monotonic() - begun_s > most_s:
                    break
                self._speak(device, service)
                self.result.device_s += 1
                self._trouble(second + 1, device, service)
            self.result.status = self._settled()
            self.result.footprints.append(_footprint(service.pid))
            self.result.elapsed_s = time.monotonic() - begun_s
            self.result.yaw_deg = float(self._state.yaw_deg)
            while self._clients:
                self._clients.popleft().close()
            service.send_signal(signal.SIGTERM)
            assert service.wait(PATIENCE_S) == 0
        return self.result

    def _command(self) -> list[str]:
        words = ["serve", "--port", self._port, "--protocol", "native", "--baud", "115200", "--config", self._config]
        words += ["--control", self._control, "--output", f"unix:path={self._unix}", "--rate", "1"]
        return [sys.executable, "-m", "gyrodrift", *map(str, words)]

    def _speak(self, device: PtyDevice, service: "subprocess.Popen[bytes]") -> None:
        """The next second: whole, as the reader takes it; or piece by piece when it is due, what finds no room lost."""
        if isinf(self._pace):
            assert device.send_all(self._spoken(RATE_HZ), lambda: service.poll() is not None), "the service has ended"
            self._filter(RATE_HZ)
            return
        assert service.poll() is None, "the service has ended"
        self._due_s = max(self._due_s, time.monotonic() - LATEST_S)
        for _ in range(PIECES):
            self._due_s += 1 / (PIECES * self._pace)
            time.sleep(max(0.0, self._due_s - time.monotonic()))
            if device.send(self._spoken(RATE_HZ // PIECES)):
                self._filter(RATE_HZ // PIECES)
            else:
                self.result.unsent += RATE_HZ // PIECES
                self._count += RATE_HZ // PIECES

    def _spoken(self, samples: int) -> bytes:
        """The next frames; a HELLO before each second."""
        frames = [hello_frame(BASE)] if self._count % RATE_HZ == 0 else []
        is_turning = self.result.device_s % TURN_EVERY_S >= TURN_EVERY_S - TURN_S
        turn_lsb = TURN_LSB if is_turning else 0
        self._raw = [round(self._dice.gauss(BIAS_LSB, NOISE_LSB)) + turn_lsb for _ in range(samples)]
        for count, raw in enumerate(self._raw, self._count):
            frames.append(sample_frame(0, count, count * 1000, raw, 0, 0))
        return b"".join(frames)

    def _filter(self, samples: int) -> None:
        """Take what was spoken here too."""
        step, coefficients, state, scale = FILTER.step, self._coefficients, self._state, _single(BASE.dps_per_lsb)
        for count, raw in enumerate(self._raw, self._count):
            step(coefficients, state, count * 1000 / 1e6, raw * scale)
        self._count += samples

    def _trouble(self, second: int, device: PtyDevice, service: "subprocess.Popen[bytes]") -> None:
        if second % RELOAD_EVERY_S == 0:
            self.result.reloads += 1
            fresh = self._config.with_suffix(".fresh")  # a file that is seen half written is refused, and rightly
            fresh.write_text(CONFIGS[self.result.reloads % 2])
            fresh.replace(self._config)
        if second % UNPLUG_EVERY_S == 0:
            device.drain()
            device.close()
            device.live_until(0.0)
            device.wait_for_reader(lambda: service.poll() is not None)
            self.result.reconnects += 1
        if second % CLIENT_EVERY_S == 0:
            self._come_and_go()
        if second % LOOK_EVERY_S == 0:
            self.result.footprints.append(_footprint(service.pid))
        self._listen()

    def _come_and_go(self) -> None:
        with suppress(OSError):
            client = socket.socket(socket.AF_UNIX)
            self._clients.append(client)
            client.settimeout(1.0)
            client.connect(str(self._unix))
            self.result.clients += 1
        if len(self._clients) > MOST_CLIENTS:
            self._clients.popleft().close()

    def _listen(self) -> None:
        """All but the newest read what is there; that one is slow."""
        others = list(self._clients)[:-1]
        ready, _, _ = select.select(others, [], [], 0.0)
        for client in ready:
            with suppress(OSError):
                client.recv(1 << 16)

    def _settled(self) -> dict[str, Any]:
        """The status once all that was sent is taken."""
        until_s = time.monotonic() + PATIENCE_S
        status: dict[str, Any] = {}
        while time.monotonic() < until_s:
            with suppress(UsageError), ControlClient(self._control, 10.0) as client:
                status = client.ask("status")
                if status["link"]["samples"] >= self._count - self.result.unsent:
                    break
            time.sleep(0.2)
        return status


def soak(seconds: int, most_s: float, pace: float = inf) -> SoakResult:
    """Run one in a folder of its own."""
    with TemporaryDirectory() as folder:
        return Soak(Path(folder), pace).run(seconds, most_s)


def _single(value: float) -> float:
    """As HELLO carries it: in 32 bits."""
    import struct  # noqa: PLC0415 - here alone

    return float(struct.unpack("<f", struct.pack("<f", value))[0])


def _reads_a_config(pid: int) -> bool:
    """A process that comes with a reload and ends with it."""
    try:
        return b"gyrodrift.config" in Path(f"/proc/{pid}/cmdline").read_bytes()
    except (FileNotFoundError, ProcessLookupError):
        return True


def _footprint(pid: int) -> Footprint:
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    family = [Path("/proc") / each for each in (str(pid), *children) if not _reads_a_config(int(each))]
    return Footprint(
        sum(memory_bytes(int(each.name)) for each in family),
        sum(len(list((each / "fd").iterdir())) for each in family),
        sum(len(list((each / "task").iterdir())) for each in family),
    )
