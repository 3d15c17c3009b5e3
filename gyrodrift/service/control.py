"""Control of a running service: a unix socket, a command a line in, a JSON object a line out.

It is part of the loop that reads the port, since it changes what that loop does; so a client gets little: few
connections, short lines, one command at a time. Who may open the socket file may control the service, nobody else:
outputs run in another process and have no way here.
"""

import json
import select
import socket
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Any

from gyrodrift.errors import UsageError
from gyrodrift.logger import FilteringBoundLogger
from gyrodrift.outputs.net.unix_socket import bind_unix, file_of, unlink_unix
from gyrodrift.outputs.output import OutputError

MOST_CLIENTS = 8
LONGEST_COMMAND = 256
LONGEST_ANSWER_BYTES = 1 << 20
READ_BYTES = 4096


class CommandError(Exception):
    """A command cannot be carried out; the text is for the person who gave it."""


@dataclass(frozen=True, slots=True)
class ControlCommand:
    """One of those that there are; `run` takes the words behind its name and gives the fields of the answer."""

    usage: str
    run: Callable[[list[str]], Mapping[str, Any]]


@dataclass(slots=True)
class _Client:
    connection: socket.socket
    asked: bytes = b""
    answer: bytes = b""


class Control:
    """Listens at a path; `serve` is called by the loop when one of `wakes` is ready.

    Raises
    ------
    UsageError
        From the constructor, where the path cannot be had.
    """

    def __init__(self, path: Path, commands: Mapping[str, ControlCommand], log: FilteringBoundLogger) -> None:
        self._path = path
        self._commands = commands
        self._log = log
        try:
            self._listening = bind_unix(path)
            self._file = file_of(path)
        except OutputError as error:
            raise UsageError(f"--control {path}: {error}") from error
        self._clients: dict[int, _Client] = {}
        self._wakes: dict[int, int] = {self._listening.fileno(): select.POLLIN}

    def wakes(self) -> Mapping[int, int]:
        """Descriptors that it waits for, with the events of `poll`."""
        return self._wakes

    def serve(self, ready: set[int]) -> None:
        """Do what can be done on these descriptors without waiting."""
        if self._listening.fileno() in ready:
            self._accept()
        for fd in ready & self._clients.keys():
            self._go_on(fd, self._clients[fd])

    def close(self) -> None:
        """Take the socket away."""
        for client in self._clients.values():
            client.connection.close()
        self._clients.clear()
        self._listening.close()
        unlink_unix(self._path, self._file)

    def _accept(self) -> None:
        try:
            connection, _ = self._listening.accept()
        except OSError:
            return
        connection.setblocking(False)
        if len(self._clients) >= MOST_CLIENTS:
            connection.send(_line({"ok": False, "error": f"there are {MOST_CLIENTS} clients already"}))
            connection.close()
            return
        self._clients[connection.fileno()] = _Client(connection)
        self._wakes = {**self._wakes, connection.fileno(): select.POLLIN}

    def _go_on(self, fd: int, client: _Client) -> None:
        try:
            if client.answer:
                client.answer = client.answer[client.connection.send(client.answer) :]
            if not client.answer and not self._listen(client):
                self._forget(fd)
                return
        except (BlockingIOError, InterruptedError):
            pass
        except OSError:
            self._forget(fd)
            return
        self._wakes = {**self._wakes, fd: select.POLLOUT if client.answer else select.POLLIN}

    def _listen(self, client: _Client) -> bool:
        """Read on, and carry out what is complete; False at the end of the connection."""
        chunk = client.connection.recv(READ_BYTES)
        client.asked += chunk
        *lines, client.asked = client.asked.split(b"\n")
        for line in lines:
            client.answer += _line(self._answer(line))
        if len(client.asked) > LONGEST_COMMAND:
            client.answer += _line({"ok": False, "error": f"a command has no more than {LONGEST_COMMAND} bytes"})
            chunk = b""
        if client.answer:
            client.answer = client.answer[client.connection.send(client.answer) :]
        return bool(chunk) and len(client.answer) <= LONGEST_ANSWER_BYTES

    def _answer(self, line: bytes) -> dict[str, Any]:
        words = line.decode(errors="replace").split()
        command = self._commands.get(words[0]) if words else None
        if command is None:
            known = ", ".join(each.usage for each in self._commands.values())
            return {"ok": False, "error": f"{' '.join(words)[:80]!r} is no command; commands are {known}"}
        try:
            fields = command.run(words[1:])
        except CommandError as error:
            return {"ok": False, "error": str(error)}
        if words[0] != "status":
            self._log.info("control", command=" ".join(words))
        return {"ok": True, **fields}

    def _forget(self, fd: int) -> None:
        self._clients.pop(fd).connection.close()
        self._wakes = {other: events for other, events in self._wakes.items() if other != fd}


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
