"""Connection from the loop that reads the port to the process of the outputs: a socket pair with a bounded queue.

Only `close` waits. Messages that the process does not take are queued up to a limit. Then the oldest are dropped, and
the outputs get the number of dropped samples. There is one process at a time. Each tick compares the wanted outputs
with the process, and starts the next process when the old one has ended.
"""

import errno
import os
import select
import signal
import socket
import subprocess
import sys
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict
from math import inf
from typing import Any

from gyrodrift.io.logger import FilteringBoundLogger
from gyrodrift.outputs import wire
from gyrodrift.outputs.options import OutputSpec, revealed
from gyrodrift.outputs.output import ControlAccess
from gyrodrift.outputs.status import OutputStatus, ServiceStatus, output_status
from gyrodrift.service.listener import NO_WAKES
from gyrodrift.values.sample import Corrected

LONGEST_QUEUE_BYTES = 4 << 20
KERNEL_BYTES = 1 << 20
"""Requested size of the kernel buffer; it may be smaller."""

STATUS_S = 1.0
RESTART_FIRST_S = 0.5
RESTART_LONGEST_S = 30.0
STABLE_S = 60.0
END_S = 4.0
"""Time for a process to close its clients while the service continues, s; then it is killed."""

LAST_S = 1.5
"""Time for a process to close its clients when the service ends, s."""

KILLED_S = 0.2
"""Time for a killed process to end, s; a process that hangs in the kernel may take longer."""

KEPT_KINDS = (wire.OUTPUTS, wire.ACCESS)
"""Messages that are never dropped."""

State = Callable[[], ServiceStatus]
"""Gives the present state of the service."""


class OutputFeed:
    """Sends samples, events and the state of the service to the process of the outputs, while there are outputs.

    Parameters
    ----------
    level, style
        Level and format of the log of that process.
    source
        Name of the source of the samples; empty if there is one gyro.
    """

    def __init__(
        self,
        log: FilteringBoundLogger,
        level: str = "info",
        style: str = "auto",
        monotonic: Callable[[], float] = time.monotonic,
        source: str = "",
    ) -> None:
        self.state: State | None = None
        self.access: ControlAccess | None = None
        self.dropped = 0
        self.specs: tuple[OutputSpec, ...] = ()
        self._log = log
        self._words = (level, style, *filter(None, [source]))
        self._monotonic = monotonic
        self._process: subprocess.Popen[bytes] | None = None
        self._socket: socket.socket | None = None
        self._sent_specs: tuple[OutputSpec, ...] = ()
        self._has_died = False
        self._kill_s = inf
        self._start_s = self._started_s = -inf
        self._restart_s = RESTART_FIRST_S
        self._queue: deque[bytes] = deque()
        self._queue_bytes = 0
        self._untold = 0
        self._statuses: tuple[OutputStatus, ...] = ()
        self._status_s = -inf
        self._wakes: Mapping[int, int] = NO_WAKES

    @property
    def is_wanted(self) -> bool:
        """Whether there are outputs."""
        return bool(self.specs)

    @property
    def pid(self) -> int | None:
        """Process of the outputs; None without one."""
        return self._process.pid if self._process else None

    def want(self, specs: Sequence[OutputSpec]) -> None:
        """Set the outputs; outputs that stay are not interrupted."""
        self.specs = tuple(dict.fromkeys(specs))
        self._reconcile(self._monotonic())

    def take(self, samples: list[Corrected]) -> None:
        """Send samples, or queue them."""
        if self._socket is None:
            return
        if self._queue:
            self._flush()
        if samples:
            for batch in wire.batches(samples):
                self._send(wire.pack_samples(batch))

    def hear(self, event: str, fields: Mapping[str, Any]) -> None:
        """Send an event, or queue it."""
        if self._socket is not None:
            self._send(wire.pack_json(wire.EVENT, {"event": event, "fields": fields}))

    def tick(self, now_s: float) -> None:
        """Read the state of the outputs, send the state of the service, and start or end the process."""
        self._reconcile(now_s)
        if self._socket is not None:
            self._listen(self._socket)
            self._flush()
        if self._queue or self._socket is None:  # behind queued samples the state would be old
            return
        if self.state is not None and now_s - self._status_s >= STATUS_S:
            self._status_s = now_s
            self._send(wire.pack_json(wire.STATUS, asdict(self.state())))

    def statuses(self) -> tuple[OutputStatus, ...]:
        """State of the outputs as of the last second."""
        statuses = {status.output: status for status in self._statuses}
        return tuple(statuses.get(str(spec), OutputStatus(str(spec), problem="is being opened")) for spec in self.specs)

    def stats(self) -> dict[str, Any]:
        """Number of clients, and of samples that the process was too slow for."""
        if not self.specs:
            return {}
        return {"clients": sum(status.client_count for status in self._statuses), "outputs_dropped": self.dropped}

    def wakes(self) -> Mapping[int, int]:
        """The socket while messages are queued."""
        return self._wakes if self._queue else NO_WAKES

    def finish(self) -> None:
        """Let the outputs close their clients."""
        self._let_go(self._monotonic() + LAST_S)

    def close(self) -> None:
        """Wait for the process, at most LAST_S after `finish`."""
        if self._process is None:
            return
        try:
            self._process.wait(max(self._kill_s - self._monotonic(), 0.0))
        except subprocess.TimeoutExpired:
            self._process.kill()
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(KILLED_S)
        self._process = None

    def _reconcile(self, now_s: float) -> None:
        """One step towards the wanted outputs, without waiting for the process."""
        if self._process is not None and self._socket is None:
            self._reap(self._process, now_s)
        if self._process is None:
            if self.specs and now_s >= self._start_s:
                self._start(now_s)
        elif not self.specs:
            self._let_go(now_s + END_S)
        elif self._socket is not None and self.specs != self._sent_specs:
            self._send_specs()

    def _start(self, now_s: float) -> None:
        try:
            ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        except AttributeError:  # a config that is reloaded; `serve` refuses the other ways in
            self._not_started(OSError(errno.EAFNOSUPPORT, "this system has no unix sockets"), now_s)
            return
        except OSError as error:
            self._not_started(error, now_s)
            return
        command = [sys.executable, "-m", "gyrodrift.outputs", str(theirs.fileno()), *self._words]
        with theirs:
            try:
                self._process = subprocess.Popen(  # noqa: S603 - this program
                    command, pass_fds=[theirs.fileno()], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL
                )
            except OSError as error:
                ours.close()
                self._not_started(error, now_s)
                return
        ours.setblocking(False)
        ours.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, KERNEL_BYTES)
        self._socket, self._started_s, self._kill_s, self._statuses = ours, now_s, inf, ()
        self._wakes = {ours.fileno(): select.POLLOUT}
        if self.access is not None:
            self._send(wire.pack_json(wire.ACCESS, {"path": self.access.path, "token": self.access.token}))
        self._send_specs()

    def _not_started(self, error: OSError, now_s: float) -> None:
        """Try again later: memory or descriptors may become free."""
        self._put_off(now_s)
        self._log.error("outputs_not_started", reason=error.strerror, retry_s=self._restart_s)

    def _send_specs(self) -> None:
        """Send the wanted outputs; an older list in the queue is replaced."""
        self._queue = deque(message for message in self._queue if message[:1] != wire.OUTPUTS)
        self._queue_bytes = sum(map(len, self._queue))
        self._sent_specs = self.specs
        self._send(
            wire.pack_json(
                wire.OUTPUTS, [{"name": spec.name, "options": revealed(spec.options)} for spec in self.specs]
            )
        )

    def _let_go(self, kill_s: float) -> None:
        """Close the socket, which ends the process."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None
        self._queue.clear()
        self._queue_bytes = 0
        self._kill_s = min(self._kill_s, kill_s)

    def _reap(self, process: subprocess.Popen[bytes], now_s: float) -> None:
        """Notice the end of a process, or kill it after its time."""
        status = process.poll()
        if status is None:
            if now_s >= self._kill_s:
                process.kill()
            return
        self._process = None
        if self._has_died:
            self._has_died = False
            self._log.error("outputs_died", **_exit_of(status))

    def _died(self) -> None:
        """Handle a closed socket; a process that has only closed the socket is killed."""
        now_s = self._monotonic()
        self._has_died, self._statuses = True, ()
        self._let_go(now_s)
        if now_s - self._started_s > STABLE_S:
            self._restart_s = RESTART_FIRST_S
        self._put_off(now_s)

    def _put_off(self, now_s: float) -> None:
        """Delay the next start, with growing pauses."""
        self._start_s = now_s + self._restart_s
        self._restart_s = min(2.0 * self._restart_s, RESTART_LONGEST_S)

    def _send(self, message: bytes) -> None:
        if not self._queue and self._hand_over(message):
            return
        if self._socket is None:
            return
        self._queue.append(message)
        self._queue_bytes += len(message)
        if self._queue_bytes > LONGEST_QUEUE_BYTES:
            self._drop()

    def _flush(self) -> None:
        while self._queue and self._hand_over(self._queue[0]):
            self._queue_bytes -= len(self._queue.popleft())
        if self._untold and not self._queue and self._hand_over(wire.pack_json(wire.DROPPED, self._untold)):
            self._untold = 0

    def _hand_over(self, message: bytes) -> bool:
        """Send a message now; False if the process does not take it."""
        if self._socket is None:
            return False
        try:
            self._socket.send(message)
        except (BlockingIOError, InterruptedError):
            return False
        except OSError as error:
            if error.errno == errno.EMSGSIZE:  # an event that is too long is dropped
                return True
            self._died()
            return False
        return True

    def _drop(self) -> None:
        """Drop the older half of the queue, except for KEPT_KINDS."""
        target, kept, dropped = LONGEST_QUEUE_BYTES // 2, deque[bytes](), 0
        for message in self._queue:
            if self._queue_bytes > target and message[:1] not in KEPT_KINDS:
                self._queue_bytes -= len(message)
                dropped += wire.count_samples(message)
            else:
                kept.append(message)
        self._queue = kept
        self.dropped += dropped
        self._untold += dropped

    def _listen(self, end: socket.socket) -> None:
        """Read the newest state that the process has sent."""
        newest = b""
        try:
            while message := end.recv(wire.LONGEST_BYTES):
                newest = message
        except (BlockingIOError, InterruptedError):
            if newest:
                self._statuses = tuple(output_status(status) for status in wire.unpack_json(b" " + newest))
        except OSError:
            self._died()
        else:
            self._died()


def _exit_of(status: int) -> dict[str, Any]:
    """Signal or exit status of a process."""
    return {"signal": signal.Signals(-status).name} if status < 0 else {"status": status}


def memory_bytes(pid: int | None) -> int:
    """Resident memory of a process, bytes; 0 without one."""
    try:
        with open(f"/proc/{pid}/statm") as file:  # noqa: PTH123 - a path object would cost more than the read
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, IndexError):
        return 0
