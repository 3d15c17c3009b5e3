"""Client of the control socket, for `ctl` and `top`."""

import json
import socket
from pathlib import Path
from typing import Any, Self

from gyrodrift.values.errors import UsageError


class ControlClient:
    """A connection to a service.

    Raises
    ------
    UsageError
        From the constructor and from `ask`, if there is no service, this user may not control it, or it does not
        answer. From `ask`, if a command has a line break.
    """

    def __init__(self, path: Path, patience_s: float) -> None:
        self._path = path
        self._pending = b""
        self._connection = socket.socket(socket.AF_UNIX)
        self._connection.settimeout(patience_s)
        try:
            self._connection.connect(str(path))
        except OSError as error:
            self._connection.close()
            raise UsageError(f"{path}: {_why(error)}") from error

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the connection."""
        self._connection.close()

    def ask(self, command: str) -> dict[str, Any]:
        """Send a command and wait for its answer."""
        if "\n" in command:
            raise UsageError(f"{command!r} has a line break; it would be two commands")
        try:
            self._connection.sendall(command.encode(errors="backslashreplace") + b"\n")
            while b"\n" not in self._pending:
                chunk = self._connection.recv(1 << 16)
                if not chunk:
                    raise UsageError(f"{self._path}: the service has closed the connection")
                self._pending += chunk
        except OSError as error:
            raise UsageError(f"{self._path}: {_why(error)}") from error
        line, _, self._pending = self._pending.partition(b"\n")
        return dict(json.loads(line))


def _why(error: OSError) -> str:
    match error:
        case FileNotFoundError():
            return "there is no such socket; is serve running with --control?"
        case ConnectionRefusedError():
            return "the service has ended"
        case PermissionError():
            return "this user may not control the service; it belongs to another"
        case TimeoutError():
            return "the service does not answer"
        case _:
            return str(error.strerror or error)
