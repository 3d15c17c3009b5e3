"""Control of a running service: a unix socket, a command a line in, a JSON object a line out.

It is part of the loop that reads the port, since it changes what that loop does; so a client gets little: few
connections, short lines, one command at a time, and all of them together a small share of the loop's time. Nothing
that a client does or leaves undone ends the service. Who may open the socket file may control the service, nobody
else: outputs run in another process and have no way here.
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

from gyrodrift.errors import UsageError
from gyrodrift.logger import FilteringBoundLogger
from gyrodrift.outputs.net.unix_socket import bind_unix, file_of, unlink_unix
from gyrodrift.outputs.output import OutputError

MOST_CLIENTS = 8
IDLE_S = 10.0
"""Who has been silent for so long gives its place to a newcomer where all places are taken."""

LONGEST_COMMAND = 256
READ_BYTES = 4096

PAUSE_S = 0.01
"""Between two turns of the socket: at most 100 commands and 100 new connections a second."""

SHARE = 0.1
"""Of the loop's time, for all clients together: after a turn of 5 ms the next one begins 50 ms later."""

LONGEST_PAUSE_S = 0.5
"""After a command that is slow by nature, as `reload` of a large config: a client is not kept waiting for longer."""


NOTHING: Mapping[int, int] = {}


class CommandError(Exception):
    """A command cannot be carried out; the text is for the person who gave it."""


Later = Callable[[], Mapping[str, Any] | None]
"""Gives the fields of an answer, None as long as they are not there, or raises CommandError; waits for nothing."""


@dataclass(frozen=True, slots=True)
class _Due:
    """An answer that is not there yet, and the words of the command."""

    words: list[str]
    run: Callable[[], Mapping[str, Any] | Later | None]


@dataclass(frozen=True, slots=True)
class ControlCommand:
    """One of those that there are; `run` takes the words behind its name.

    It gives the fields of the answer, or what is asked for them until they are there.
    """

    usage: str
    run: Callable[[list[str]], Mapping[str, Any] | Later]


@dataclass(slots=True)
class _Client:
    """One connection.

    asked
        What it has sent and nobody has carried out yet: less than READ_BYTES and a command.
    answer
        What it has not read yet: to one command.
    due
        The answer that it waits for.
    heard_s
        When it last sent or read something, on the monotonic clock.
    has_ended
        It sends nothing more; what it has asked is still answered.
    """

    connection: socket.socket
    heard_s: float
    asked: bytes = b""
    answer: bytes = b""
    due: _Due | None = None
    has_ended: bool = False

    @property
    def is_due(self) -> bool:
        """A command is there whole, or too long to be one, and the answer to the one before has been read."""
        return not self.answer and self.due is None and (b"\n" in self.asked or len(self.asked) > LONGEST_COMMAND)

    @property
    def is_over(self) -> bool:
        """Nothing is left to be done for it."""
        return self.has_ended and not self.answer and self.due is None and not self.is_due

    def wanted(self) -> int:
        """Events of `poll` that let it go on; 0 where none is waited for."""
        if self.answer:
            return select.POLLOUT
        return 0 if self.is_due or self.due is not None or self.has_ended else select.POLLIN


class Control:
    """Listens at a path; `serve` is called by the loop, which waits for `wakes` and no longer than `wake_s`.

    Parameters
    ----------
    monotonic
        The clock that the share of the loop's time is measured on, s.

    Raises
    ------
    UsageError
        From the constructor, where the path cannot be had.
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
        """Descriptors that it waits for, with the events of `poll`; none during a pause."""
        return NOTHING if self._monotonic() < self._resume_s else self._wakes

    def wake_s(self) -> float:
        """How long the loop may wait for anything else, s: a pause ends, and commands may have been read already."""
        pause_s = self._resume_s - self._monotonic()
        if pause_s > 0.0:
            return pause_s
        return 0.0 if self._is_due else inf

    def serve(self, ready: set[int]) -> None:
        """Do what can be done on these descriptors without waiting, and no more than one command."""
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
        """Take the socket away."""
        for client in self._clients.values():
            client.connection.close()
        self._clients.clear()
        self._listening.close()
        unlink_unix(self._path, self._file)

    def _look_ahead(self) -> None:
        """What the next turn is for."""
        wanted = {fd: client.wanted() for fd, client in self._clients.items()}
        self._is_due = any(client.is_due for client in self._clients.values())
        self._is_waited = any(client.due is not None for client in self._clients.values())
        self._wakes = {fd: events for fd, events in wanted.items() if events}
        self._wakes[self._listening.fileno()] = select.POLLIN

    def _accept(self, now_s: float) -> None:
        try:
            connection, _ = self._listening.accept()
        except OSError:  # it has left already, or no descriptor is free
            return
        connection.setblocking(False)
        if len(self._clients) >= MOST_CLIENTS and not self._made_room(now_s):
            self._turn_away(connection)
            return
        self._clients[connection.fileno()] = _Client(connection, now_s)

    def _made_room(self, now_s: float) -> bool:
        """Let the client go that has been silent for longest; False where none has for IDLE_S."""
        fd, client = min(self._clients.items(), key=lambda each: each[1].heard_s)
        if now_s - client.heard_s < IDLE_S:
            return False
        self._forget(fd)
        return True

    def _turn_away(self, connection: socket.socket) -> None:
        with connection, suppress(OSError):  # it need not wait for the reason
            connection.send(_line({"ok": False, "error": f"there are {MOST_CLIENTS} clients already"}))

    def _go_on(self, fd: int, client: _Client, now_s: float) -> None:
        """Send on, or read on."""
        try:
            if client.answer:
                client.answer = client.answer[client.connection.send(client.answer) :]
            elif not client.is_due:
                chunk = client.connection.recv(READ_BYTES)
                client.asked += chunk
                client.has_ended = not chunk
            client.heard_s = now_s
        except (BlockingIOError, InterruptedError):
            pass
        except OSError:
            self._forget(fd)

    def _carry_out_one(self) -> None:
        """One command, of the client that has waited longest."""
        fd = next((fd for fd, client in self._clients.items() if client.is_due), None)
        if fd is None:
            return
        client = self._clients[fd] = self._clients.pop(fd)
        line, _, rest = client.asked.partition(b"\n")
        if len(line) > LONGEST_COMMAND:
            answer: dict[str, Any] | _Due = {
                "ok": False,
                "error": f"a command has no more than {LONGEST_COMMAND} bytes",
            }
            client.asked, client.has_ended = b"", True
        else:
            client.asked, answer = rest, self._answer(line)
        self._give(fd, client, answer)

    def _answer_those_who_wait(self) -> bool:
        """Where it is there; whether it was for anybody."""
        has_answered = False
        for fd, client in list(self._clients.items()):
            if client.due is not None:
                answer = self._outcome(client.due.words, client.due.run)
                has_answered |= isinstance(answer, dict)
                self._give(fd, client, answer)
        return has_answered

    def _give(self, fd: int, client: _Client, answer: dict[str, Any] | _Due) -> None:
        """Send an answer, or keep that it is due."""
        if isinstance(answer, _Due):
            client.due = answer
            return
        client.due, client.answer = None, _line(answer)
        self._go_on(fd, client, self._monotonic())

    def _answer(self, line: bytes) -> dict[str, Any] | _Due:
        words = line.decode(errors="replace").split()
        command = self._commands.get(words[0]) if words else None
        if command is None:
            known = ", ".join(each.usage for each in self._commands.values())
            return {"ok": False, "error": f"{' '.join(words)[:80]!r} is no command; commands are {known}"}
        return self._outcome(words, partial(command.run, words[1:]))

    def _outcome(self, words: list[str], run: Callable[[], Mapping[str, Any] | Later | None]) -> dict[str, Any] | _Due:
        """What a command gave, or what it is asked again."""
        try:
            fields = run()
        except CommandError as error:
            return {"ok": False, "error": str(error)}
        except Exception as error:  # noqa: BLE001 - whatever is wrong with one command is not for the service
            reason = f"{type(error).__name__}: {error}"
            self._log.error("control_failed", command=words[0], reason=reason)
            return {"ok": False, "error": f"{words[0]} failed: {reason}"}
        if fields is None or callable(fields):
            return _Due(words, fields or run)
        if words[0] != "status":
            self._log.info("control", command=" ".join(words))
        return {"ok": True, **fields}

    def _forget(self, fd: int) -> None:
        self._clients.pop(fd).connection.close()


def number(words: list[str], usage: str) -> float:
    """The only word, as a number.

    Raises
    ------
    CommandError
        Where there is none.
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
