"""Helpers for tests of outputs: a service with outputs, their loop without a service, samples."""

import asyncio
import json
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict
from math import atan2, cos, radians, sin
from pathlib import Path
from typing import Any
from unittest.mock import patch

import structlog
from support import PATIENCE_S, Command, never, speaking_on

from gyrodrift.config.outputs import output_of
from gyrodrift.outputs import wire
from gyrodrift.outputs.hub import Hub
from gyrodrift.outputs.options import OutputSpec, revealed
from gyrodrift.outputs.status import OutputStatus, ServiceStatus, output_status
from gyrodrift.values.sample import Attitude, Corrected, DeviceYaw, Inertial, Sample


def corrected(seq: int, **values: Any) -> Corrected:
    """A sample of a device at 100 Hz with everything known; `values` are fields of `Corrected`."""
    t_s = seq / 100.0
    sample = Sample(seq, t_s, 1.7e9 + t_s, 1.5, 10.0, 25.0)
    expected = Corrected(sample, 1.25, 0.0125 * seq, 0.25, 0.5, 0.9, 0.01, 0.8, 0.015 * seq, 90.0, 10.0)
    changes = {"correction_deg": 0.25, "corrections": 2.0, "smooth_yaw_deg": 0.0125 * seq - 1.0}
    return expected._replace(**(changes | values))


Quaternion = tuple[float, float, float, float]


def product(p: Quaternion, q: Quaternion) -> Quaternion:
    """Rotation by q, then by p."""
    w, x, y, z = p
    a, b, c, d = q
    return (
        w * a - x * b - y * c - z * d,
        w * b + x * a + y * d - z * c,
        w * c - x * d + y * a + z * b,
        w * d + x * c - y * b + z * a,
    )


def attitude_q(heading_deg: float, pitch_deg: float, roll_deg: float) -> Quaternion:
    pitch, roll = radians(pitch_deg) / 2.0, radians(roll_deg) / 2.0
    level = product((cos(pitch), 0.0, sin(pitch), 0.0), (cos(roll), sin(roll), 0.0, 0.0))
    turn = radians(heading_deg) / 2.0 - atan2(level[3], level[0])
    return product((cos(turn), 0.0, 0.0, sin(turn)), level)


AXES = Inertial(2.0, -3.0, 1.5, 3.0, 1.5, 9.2)
"""Measurement of a sensor of three axes that turns and is tilted."""


def tilted(
    seq: int, yaw_deg: float = 30.0, pitch_deg: float = -20.0, roll_deg: float = 10.0, **values: Any
) -> Corrected:
    """A sample of a device with three axes, nose up and right side down; its biases are 0.1, 0.2 and 0.25 deg/s."""
    q = attitude_q(yaw_deg, pitch_deg, roll_deg)
    attitude = Attitude(*q, 22.2687, roll_deg, pitch_deg, 0.4, 0.1, 0.2, 0.25)
    level = corrected(seq, yaw_deg=yaw_deg)
    return level._replace(sample=level.sample._replace(inertial=AXES), attitude=attitude)._replace(**values)


OWN_YAW = DeviceYaw(2.5, 0.125, -0.5)
"""Result of the filter in a device."""


def with_own_yaw(plain: Corrected, own: DeviceYaw = OWN_YAW) -> Corrected:
    """The sample of a device that runs a filter itself; the two yaws differ by −0.25 deg."""
    return plain._replace(sample=plain.sample._replace(device_yaw=own), device_difference_deg=-0.25)


WITHOUT_BIAS = "hdr: {i_c_dps: 0, tau_s: 0, theta_w_dps: 1, c1: 0, c2: 1}\n"
"""Config of a filter that takes no constant rate for a bias, however long the rate lasts."""


def csv_at_100_hz(count: int, rate_dps: float = 10.0, first: int = 0) -> bytes:
    return b"".join(b"%d,%.3f,1.5,25.0\n" % (i * 10_000, rate_dps) for i in range(first, first + count))


@contextmanager
def serving(port: Path, *options: str | Path, is_fresh: bool = False) -> Iterator[tuple[Command, Any]]:
    """`gyrodrift serve` on a pty, as a process; what the device says is for the test to send."""
    words = ("serve", "--port", port, "--timeout", "0", "--log-format", "json", *options)
    with speaking_on(port) as device, Command(*words, is_fresh=is_fresh) as serve:
        device.wait_for_reader(never)
        yield serve, device


def events(serve: Command, name: str, output: str | None = None) -> list[dict[str, Any]]:
    """Lines of the log so far that are this event, of this output where one is named."""
    result = [json.loads(line) for line in serve.log.split("\n")[:-1] if f'"{name}"' in line]
    return [item for item in result if item["event"] == name and (output is None or item.get("output") == output)]


def address_of(serve: Command, output: str) -> tuple[str, int]:
    """Host and port that an output listens on, once it does; ask for port 0 in tests."""
    host, _, port = path_of(serve, output).rpartition(":")
    return host, int(port)


def path_of(serve: Command, output: str) -> str:
    serve.until(lambda it: bool(events(it, "output_open", output)), f"open {output}")
    return str(events(serve, "output_open", output)[-1]["address"])


class Reader:
    """A client of lines that reads without waiting for ever."""

    def __init__(self, connection: socket.socket) -> None:
        self.connection = connection
        self._pending = b""
        connection.settimeout(PATIENCE_S)

    def line(self) -> bytes:
        """The next one, without its end; empty at the end of the connection."""
        while b"\n" not in self._pending:
            chunk = self.connection.recv(1 << 16)
            if not chunk:
                return b""
            self._pending += chunk
        line, _, self._pending = self._pending.partition(b"\n")
        return line

    def json(self) -> dict[str, Any]:
        """The next one as an object."""
        return dict(json.loads(self.line()))

    def until(self, kind: str) -> dict[str, Any]:
        """The next object of a class."""
        while True:
            result = self.json()
            if result["class"] == kind:
                return result


@contextmanager
def connected(address: tuple[str, int]) -> Iterator[Reader]:
    """A client over TCP."""
    with socket.create_connection(address, PATIENCE_S) as connection:
        yield Reader(connection)


class HubThread:
    """Outputs on a loop of their own in this process, fed by the test in place of a service."""

    def __init__(self, service: socket.socket) -> None:
        self.address = ""
        self._service = service
        service.settimeout(PATIENCE_S)

    def want(self, *specs: OutputSpec | str) -> None:
        """These outputs from now on."""
        expected = [output_of(spec) if isinstance(spec, str) else spec for spec in specs]
        named = [{"name": item.name, "options": revealed(item.options)} for item in expected]
        self._service.send(wire.pack_json(wire.OUTPUTS, named))

    def endpoint(self) -> tuple[str, int]:
        """Host and port of the only output, once it is open."""
        host, _, port = self.opened()[0].address.rpartition(":")
        return host, int(port)

    def access(self, path: str, token: str) -> None:
        """Name the control socket and the token of pages; before the outputs are wanted."""
        self._service.send(wire.pack_json(wire.ACCESS, {"path": path, "token": token}))

    def samples(self, samples: Sequence[Corrected]) -> None:
        """Hand samples over."""
        for batch in wire.batches(samples):
            self._service.send(wire.pack_samples(batch))

    def event(self, event: str, **fields: Any) -> None:
        """Hand an event over."""
        self._service.send(wire.pack_json(wire.EVENT, {"event": event, "fields": fields}))

    def status(self, status: ServiceStatus) -> None:
        """Hand the service's state over."""
        self._service.send(wire.pack_json(wire.STATUS, asdict(status)))

    def statuses(self) -> list[OutputStatus]:
        """The next that is heard of the outputs; what was said before is old."""
        self._service.setblocking(False)
        with suppress(BlockingIOError):
            while self._service.recv(wire.LONGEST_BYTES):
                pass
        self._service.settimeout(PATIENCE_S)
        return [output_status(load) for load in json.loads(self._service.recv(wire.LONGEST_BYTES))]

    def opened(self, count: int = 1) -> list[OutputStatus]:
        """Once so many outputs are open."""
        until_s = time.monotonic() + PATIENCE_S
        while True:
            statuses = self.statuses()
            if sum(bool(statuse.address) for statuse in statuses) == count == len(statuses):
                return statuses
            assert time.monotonic() < until_s, statuses


QUICK_REPORT_S, QUICK_RETRY_S = 0.02, 0.1
"""Between reports of a hub and before its first retry, so that tests wait for neither."""


@contextmanager
def hub(*specs: OutputSpec | str) -> Iterator[HubThread]:
    """Until the end of the block; these outputs are open at its begin."""
    quick_report = patch("gyrodrift.outputs.hub.REPORT_S", QUICK_REPORT_S)
    quick_retry = patch("gyrodrift.outputs.running.RETRY_FIRST_S", QUICK_RETRY_S)
    with quick_report, quick_retry, _hub(*specs) as outputs:
        yield outputs


@contextmanager
def _hub(*specs: OutputSpec | str) -> Iterator[HubThread]:
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    loop = threading.Thread(target=lambda: asyncio.run(Hub(theirs, structlog.get_logger()).run()))
    loop.start()
    try:
        outputs = HubThread(ours)
        if specs:
            outputs.want(*specs)
            outputs.address = outputs.opened(len(specs))[0].address
        yield outputs
    finally:
        ours.close()
        loop.join()
        theirs.close()


@contextmanager
def hub_process() -> Iterator[HubThread]:
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    command = [sys.executable, "-m", "gyrodrift.outputs", str(theirs.fileno()), "info", "json"]
    with ours, subprocess.Popen(command, pass_fds=[theirs.fileno()], stderr=subprocess.DEVNULL) as process:
        theirs.close()
        try:
            yield HubThread(ours)
            ours.close()
            process.wait(PATIENCE_S)
        finally:
            process.kill()


def await_problem(outputs: HubThread, text: str) -> str:
    """The problem of the first output, once it contains the text."""
    until_s = time.monotonic() + PATIENCE_S
    while True:
        problem = next((statuse.problem for statuse in outputs.statuses()), "")
        if text in problem:
            return problem
        assert time.monotonic() < until_s, problem
        time.sleep(0.01)
