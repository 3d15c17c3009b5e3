"""Control of a running service through a unix socket: one command per line in, one JSON object per line out.

It runs in the loop that reads the port. So the clients get few connections, short lines, one command at a time, and
together a small share of the time of the loop. No client can end the service by accident. Users who can open the
socket file can control the service. The buttons of the live page are clients, too; they need a token.
"""

import json
import select
import socket
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from math import inf, isfinite
from pathlib import Path
from typing import Any

from gyrodrift.io.logger import FilteringBoundLogger
from gyrodrift.outputs.net.unix_socket import bind_unix, file_of, unlink_unix
from gyrodrift.outputs.output import OutputError
from gyrodrift.service.listener import NO_WAKES
from gyrodrift.values.errors import UsageError

MOST_CLIENTS = 8
IDLE_S = 10.0
"""A client that was silent for this long is dropped for a new one when the limit is reached, s."""

LONGEST_COMMAND = 256
READ_BYTES = 4096

PAUSE_S = 0.01
"""Pause between two turns of the socket, s: at most 100 commands and 100 new connections a second."""

SHARE = 0.1
"""Share of the time of the loop for all clients: a turn of 5 ms is followed by a pause of 50 ms."""

LONGEST_PAUSE_S = 0.5
"""Longest pause after a slow command such as `reload`, s."""


POLLED = (["status"], ["calibrate", "state"])
"""Commands that clients repeat; they are not logged."""


class CommandError(Exception):
    """A command cannot be carried out; the text tells the user why."""


Later = Callable[[], Mapping[str, Any] | None]
"""Gives the fields of an answer, or None while they are pending, or raises CommandError; never waits."""


@dataclass(frozen=True, slots=True)
class _Due:
    """A pending answer, and the words of its command."""

    words: list[str]
    run: Callable[[], Mapping[str, Any] | Later | None]


@dataclass(frozen=True, slots=True)
class ControlCommand:
    """A command; `run` takes the words behind its name.

    It gives the fields of the answer, or a function that gives them later.
    """

    usage: str
    run: Callable[[list[str]], Mapping[str, Any] | Later]


@dataclass(slots=True)
class _Client:
    """One connection.

    received
        Bytes that were not carried out yet: less than READ_BYTES and a command.
    answer
        Bytes of one answer that were not sent yet.
    due
        Pending answer.
    heard_s
        Time of its last action on the monotonic clock, s.
    has_ended
        It sends nothing more; its commands are still answered.
    """

    connection: socket.socket
    heard_s: float
    received: bytes = b""
    answer: bytes = b""
    due: _Due | None = None
    has_ended: bool = False

    @property
    def is_due(self) -> bool:
        """Whether a whole command, or a line that is too long, waits, and the answer before was read."""
        return not self.answer and self.due is None and (b"\n" in self.received or len(self.received) > LONGEST_COMMAND)

    @property
    def is_over(self) -> bool:
        """Whether nothing remains to be done for the client."""
        return self.has_ended and not self.answer and self.due is None and not self.is_due

    def events(self) -> int:
        """Events of `poll` that the client waits for; 0 for none."""
        if self.answer:
            return select.POLLOUT
        return 0 if self.is_due or self.due is not None or self.has_ended else select.POLLIN


class Control:
    """Listens at a path. The loop waits for `wakes`, at most `wake_s`, and then calls `serve`.

    Parameters
    ----------
    monotonic
        Clock of the share of time, s.

    Raises
    ------
    UsageError
        From the constructor, if the socket cannot be made.
    """

    def __init__(
        self,
        path: Path,
        commands: Mapping[str, ControlCommand],
        log: FilteringBoundLogger,
        monotonic: Callable[[], float] = time.monotonic,
    ) -> None:
        self._path = path
        self._commands = commands
        self._log = log
        self._monotonic = monotonic
        try:
            self._listening = bind_unix(path)
            self._file = file_of(path)
        except OutputError as error:
            raise UsageError(f"--control {path}: {error}") from error
        self._clients: dict[int, _Client] = {}
        self._resume_s = -inf
        self._is_due = self._is_waited = False
        self._wakes: dict[int, int] = {}
        self._look_ahead()

    def wakes(self) -> Mapping[int, int]:
        """Descriptors to wait for, with the events of `poll`; none during a pause."""
        return NO_WAKES if self._monotonic() < self._resume_s else self._wakes

    def wake_s(self) -> float:
        """Longest wait of the loop, s: until the pause ends, or 0 if a command was read already."""
        pause_s = self._resume_s - self._monotonic()
        if pause_s > 0.0:
            return pause_s
        return 0.0 if self._is_due else inf

    def serve(self, ready: set[int]) -> None:
        """Handle descriptors that are ready, without waiting, and carry out at most one command."""
        begun_s = self._monotonic()
        if begun_s < self._resume_s:
            return
        has_answered = self._answer_those_who_wait() if self._is_waited else False
        if not (has_answered or self._is_due or ready & self._wakes.keys()):
            return
        if self._listening.fileno() in ready:
            self._accept(begun_s)
        for fd in ready & self._clients.keys():
            self._go_on(fd, self._clients[fd], begun_s)
        self._carry_out_one()
        for fd in [fd for fd, client in self._clients.items() if client.is_over]:
            self._forget(fd)
        self._look_ahead()
        ended_s = self._monotonic()
        self._resume_s = ended_s + max(PAUSE_S, min((ended_s - begun_s) / SHARE, LONGEST_PAUSE_S))

    def close(self) -> None:
        """Close the clients and remove the socket."""
        for client in self._clients.values():
            client.connection.close()
        self._clients.clear()
        self._listening.close()
        unlink_unix(self._path, self._file)

    def _look_ahead(self) -> None:
        """Note the work of the next turn."""
        events_by_fd = {fd: client.events() for fd, client in self._clients.items()}
        self._is_due = any(client.is_due for client in self._clients.values())
        self._is_waited = any(client.due is not None for client in self._clients.values())
        self._wakes = {fd: events for fd, events in events_by_fd.items() if events}
        self._wakes[self._listening.fileno()] = select.POLLIN

    def _accept(self, now_s: float) -> None:
        try:
            connection, _ = self._listening.accept()
        except OSError:  # it has closed already, or no descriptor is free
            return
        connection.setblocking(False)
        if len(self._clients) >= MOST_CLIENTS and not self._drop_idle(now_s):
            self._turn_away(connection)
            return
        self._clients[connection.fileno()] = _Client(connection, now_s)

    def _drop_idle(self, now_s: float) -> bool:
        """Drop the client that was silent for longest; False if it was silent for less than IDLE_S."""
        fd, client = min(self._clients.items(), key=lambda item: item[1].heard_s)
        if now_s - client.heard_s < IDLE_S:
            return False
        self._forget(fd)
        return True

    def _turn_away(self, connection: socket.socket) -> None:
        with connection, suppress(OSError):  # it may not wait for the reason
            connection.send(_line({"ok": False, "error": f"there are {MOST_CLIENTS} clients already"}))

    def _go_on(self, fd: int, client: _Client, now_s: float) -> None:
        """Send the rest of an answer, or read."""
        try:
            if client.answer:
                client.answer = client.answer[client.connection.send(client.answer) :]
            elif not client.is_due:
                chunk = client.connection.recv(READ_BYTES)
                client.received += chunk
                client.has_ended = not chunk
            client.heard_s = now_s
        except (BlockingIOError, InterruptedError):
            pass
        except OSError:
            self._forget(fd)

    def _carry_out_one(self) -> None:
        """Carry out one command, of the client that has waited longest."""
        fd = next((fd for fd, client in self._clients.items() if client.is_due), None)
        if fd is None:
            return
        client = self._clients[fd] = self._clients.pop(fd)
        line, _, rest = client.received.partition(b"\n")
        if len(line) > LONGEST_COMMAND:
            answer: dict[str, Any] | _Due = {
                "ok": False,
                "error": f"a command has no more than {LONGEST_COMMAND} bytes",
            }
            client.received, client.has_ended = b"", True
        else:
            client.received, answer = rest, self._answer(line)
        self._give(fd, client, answer)

    def _answer_those_who_wait(self) -> bool:
        """Send pending answers that are complete; whether there was one."""
        has_answered = False
        for fd, client in list(self._clients.items()):
            if client.due is not None:
                answer = self._outcome(client.due.words, client.due.run)
                has_answered |= isinstance(answer, dict)
                self._give(fd, client, answer)
        return has_answered

    def _give(self, fd: int, client: _Client, answer: dict[str, Any] | _Due) -> None:
        """Send an answer, or note that it is pending."""
        if isinstance(answer, _Due):
            client.due = answer
            return
        client.due, client.answer = None, _line(answer)
        self._go_on(fd, client, self._monotonic())

    def _answer(self, line: bytes) -> dict[str, Any] | _Due:
        words = line.decode(errors="replace").split()
        command = self._commands.get(words[0]) if words else None
        if command is None:
            usages = ", ".join(entry.usage for entry in self._commands.values())
            return {"ok": False, "error": f"{' '.join(words)[:80]!r} is no command; the commands are {usages}"}
        return self._outcome(words, partial(command.run, words[1:]))

    def _outcome(self, words: list[str], run: Callable[[], Mapping[str, Any] | Later | None]) -> dict[str, Any] | _Due:
        """Answer of a command, or a pending one."""
        try:
            fields = run()
        except CommandError as error:
            return {"ok": False, "error": str(error)}
        except Exception as error:  # noqa: BLE001 - a mistake in one command must not end the service
            reason = f"{type(error).__name__}: {error}"
            self._log.error("control_failed", command=words[0], reason=reason)
            return {"ok": False, "error": f"{words[0]} failed: {reason}"}
        if fields is None or callable(fields):
            return _Due(words, fields or run)
        if words not in POLLED:
            self._log.info("control", command=" ".join(words))
        return {"ok": True, **fields}

    def _forget(self, fd: int) -> None:
        self._clients.pop(fd).connection.close()


def number(words: list[str], usage: str) -> float:
    """Parse the only word as a number.

    Raises
    ------
    CommandError
        If it is no number.
    """
    try:
        (word,) = words
        value = float(word)
    except ValueError:
        value = float("nan")
    if not isfinite(value):
        raise CommandError(f"expected {usage}")
    return value


def _line(value: Mapping[str, Any]) -> bytes:
    return json.dumps(value, allow_nan=False).encode() + b"\n"
