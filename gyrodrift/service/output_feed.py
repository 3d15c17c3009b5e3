"""The way from the loop that reads the port to the outputs' process: a socket pair, and a bounded queue before it.

Nothing here waits. What the process does not take at once is kept up to a bound, then the oldest samples go, and
the outputs are told how many. A process that dies is started again.
"""

import os
import select
import signal
import socket
import subprocess
import sys
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from typing import Any

from gyrodrift.logger import FilteringBoundLogger
from gyrodrift.outputs import wire
from gyrodrift.outputs.options import OutputSpec, revealed
from gyrodrift.outputs.status import OutputStatus, ServiceStatus, output_status
from gyrodrift.sample import Corrected

LONGEST_QUEUE_BYTES = 4 << 20
KERNEL_BYTES = 1 << 20
"""What the kernel is asked to keep; it may give less."""

STATUS_S = 1.0
RESTART_FIRST_S = 0.5
RESTART_LONGEST_S = 30.0
STABLE_S = 60.0
END_S = 5.0
"""That the process has to say goodbye to its clients; then it is killed."""

NOTHING: Mapping[int, int] = {}

State = Callable[[], ServiceStatus]
"""Gives the state of the service now."""


class OutputFeed:
    """Hands samples, events and the service's state to the outputs' process, which runs while there are outputs.

    Parameters
    ----------
    level, style
        Of the log of that process.
    """

    def __init__(self, log: FilteringBoundLogger, level: str = "info", style: str = "auto") -> None:
        self.state: State | None = None
        self.dropped = 0
        self.specs: tuple[OutputSpec, ...] = ()
        self._log = log
        self._log_words = (level, style)
        self._process: subprocess.Popen[bytes] | None = None
        self._socket: socket.socket | None = None
        self._queue: deque[bytes] = deque()
        self._queue_bytes = 0
        self._untold = 0
        self._statuses: tuple[OutputStatus, ...] = ()
        self._status_s = float("-inf")
        self._started_s = float("-inf")
        self._restart_s = RESTART_FIRST_S
        self._wakes: Mapping[int, int] = NOTHING

    @property
    def is_wanted(self) -> bool:
        """There are outputs."""
        return bool(self.specs)

    @property
    def pid(self) -> int | None:
        """Of the outputs' process."""
        return self._process.pid if self._process else None

    def want(self, specs: Sequence[OutputSpec]) -> None:
        """These outputs from now on; what stays notices nothing."""
        specs = tuple(dict.fromkeys(specs))
        if specs == self.specs:
            return
        self.specs = specs
        if self._socket is None and specs:
            self._start(self._started_s)
        elif specs:
            self._send(self._wanted())
        else:
            self._end()

    def take(self, samples: list[Corrected]) -> None:
        """Hand samples over, or keep them a while."""
        if self._socket is None:
            return
        if self._queue:
            self._flush()
        if samples:
            for batch in wire.batches(samples):
                self._send(wire.pack_samples(batch))

    def hear(self, event: str, fields: Mapping[str, Any]) -> None:
        """Hand an event over."""
        if self._socket is not None:
            self._send(wire.pack_json(wire.EVENT, {"event": event, "fields": fields}))

    def tick(self, now_s: float) -> None:
        """Hear how the outputs are, say how the service is; start the process again where it has died."""
        if not self.specs:
            return
        if self._socket is None:
            if now_s - self._started_s >= self._restart_s:
                self._start(now_s)
            return
        if self._started_s == float("-inf"):
            self._started_s = now_s
        self._listen(self._socket)
        self._flush()
        if self._socket is not None and self.state is not None and now_s - self._status_s >= STATUS_S:
            self._status_s = now_s
            self._send(wire.pack_json(wire.STATUS, asdict(self.state())))

    def statuses(self) -> tuple[OutputStatus, ...]:
        """How the outputs are, as of the last second."""
        known = {each.output: each for each in self._statuses}
        return tuple(known.get(str(spec), OutputStatus(str(spec), problem="is being opened")) for spec in self.specs)

    def stats(self) -> dict[str, Any]:
        """Clients, and samples that the process was too slow for."""
        if not self.specs:
            return {}
        return {"clients": sum(each.client_count for each in self._statuses), "outputs_dropped": self.dropped}

    def wakes(self) -> Mapping[int, int]:
        """The socket while something waits that the process has not taken."""
        return self._wakes if self._queue else NOTHING

    def close(self) -> None:
        """Let the outputs say goodbye to their clients."""
        statuses = self._statuses
        self._end()
        self._statuses = statuses  # for the last line of the log

    def _wanted(self) -> bytes:
        return wire.pack_json(
            wire.OUTPUTS, [{"name": each.name, "options": revealed(each.options)} for each in self.specs]
        )

    def _start(self, now_s: float) -> None:
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        ours.setblocking(False)
        ours.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, KERNEL_BYTES)
        command = [sys.executable, "-m", "gyrodrift.outputs", str(theirs.fileno()), *self._log_words]
        with theirs:
            self._process = subprocess.Popen(  # noqa: S603 - this very program
                command, pass_fds=[theirs.fileno()], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL
            )
        self._socket, self._started_s = ours, now_s
        self._wakes = {ours.fileno(): select.POLLOUT}
        self._send(self._wanted())

    def _end(self) -> None:
        self._forget()
        if self._process is None:
            return
        try:
            self._process.wait(END_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._process = None

    def _forget(self) -> None:
        """Close the socket, which ends the process."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None
        self._queue.clear()
        self._queue_bytes = 0
        self._statuses = ()

    def _died(self) -> None:
        now_s = self._status_s
        self._forget()
        if self._process is not None:
            self._process.kill()  # where it only closed its socket
            status = self._process.wait()
            self._process = None
            self._log.error("outputs_died", **_how(status))
        self._restart_s = (
            RESTART_FIRST_S if now_s - self._started_s > STABLE_S else min(2.0 * self._restart_s, RESTART_LONGEST_S)
        )

    def _send(self, message: bytes) -> None:
        if not self._queue and self._is_taken(message):
            return
        if self._socket is None:
            return
        self._queue.append(message)
        self._queue_bytes += len(message)
        if self._queue_bytes > LONGEST_QUEUE_BYTES:
            self._drop()

    def _flush(self) -> None:
        while self._queue and self._is_taken(self._queue[0]):
            self._queue_bytes -= len(self._queue.popleft())
        if self._untold and not self._queue and self._is_taken(wire.pack_json(wire.DROPPED, self._untold)):
            self._untold = 0

    def _is_taken(self, message: bytes) -> bool:
        if self._socket is None:
            return False
        try:
            self._socket.send(message)
        except (BlockingIOError, InterruptedError):
            return False
        except OSError:
            self._died()
            return False
        return True

    def _drop(self) -> None:
        """Let half of the samples go, the older ones; what is no sample stays."""
        target, kept, dropped = LONGEST_QUEUE_BYTES // 2, deque[bytes](), 0
        for message in self._queue:
            if self._queue_bytes > target and message[:1] == wire.SAMPLES:
                self._queue_bytes -= len(message)
                dropped += (len(message) - 1) // wire.RECORD.size
            else:
                kept.append(message)
        self._queue = kept
        self.dropped += dropped
        self._untold += dropped

    def _listen(self, end: socket.socket) -> None:
        """Take the last of what the process has said."""
        said = b""
        try:
            while message := end.recv(wire.LONGEST_BYTES):
                said = message
        except (BlockingIOError, InterruptedError):
            if said:
                self._statuses = tuple(output_status(each) for each in wire.unpack_json(b" " + said))
        except OSError:
            self._died()
        else:
            self._died()


def _how(status: int) -> dict[str, Any]:
    """Of a process that ended."""
    return {"signal": signal.Signals(-status).name} if status < 0 else {"status": status}


def memory_bytes(pid: int | None) -> int:
    """Resident memory of a process; 0 where there is none."""
    try:
        with open(f"/proc/{pid}/statm") as file:  # noqa: PTH123 - a path object would cost more than the read
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, IndexError):
        return 0
