"""Commands of the buttons of the page: access, accepted commands, and their way to the control socket.

A command needs the token, a page that was opened through loopback, and a connection from this machine. So neither the
network nor another page in the same browser can give one. The command goes to the control socket, as with
`gyrodrift ctl`.
"""

import asyncio
import hmac
import json
import re
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from gyrodrift.outputs.net.addresses import is_loopback
from gyrodrift.outputs.net.json_input import parse_json
from gyrodrift.outputs.output import ControlAccess

if TYPE_CHECKING:
    from websockets.asyncio.server import ServerConnection

COMMANDS = re.compile(
    r"zero|heading -?[0-9]{1,4}(\.[0-9]{1,6})?|record (start|stop)"
    r"|calibrate (start|positions|axis-turns|mark|undo|finish|cancel|state)"
)
"""Commands that a page may give; the service carries out more."""

PATIENCE_S = 20.0
"""The service answers within 3 s; a busy machine takes longer, s."""

LONGEST_ANSWER = 1 << 20
"""A recording with rotation may have thousands of files, bytes."""

MOST_PENDING = 4


def is_local(connection: "ServerConnection") -> bool:
    """Whether a browser on this machine has opened its own page through loopback."""
    request = connection.request
    if request is None or not is_loopback(str(connection.remote_address[0])):
        return False
    hosts, origins = request.headers.get_all("Host"), request.headers.get_all("Origin")
    if len(hosts) != 1 or origins not in ([f"http://{hosts[0]}"], [f"https://{hosts[0]}"]):
        return False
    return is_loopback(urlsplit(f"//{hosts[0]}").hostname or "")


class Buttons:
    """The buttons of one page.

    Parameters
    ----------
    access
        Socket of the service and the token.
    """

    def __init__(self, access: ControlAccess) -> None:
        self._access = access
        self._pending: set[asyncio.Task[None]] = set()

    def press(self, content: str | bytes, send: Any) -> None:
        """Carry out `{"token", "command"}` and send the answer of the service.

        Raises
        ------
        ValueError
            If the message or the token is wrong, or there is no such command.
        """
        message = parse_json(content)
        if not isinstance(message, dict) or not isinstance(message.get("command"), str):
            raise ValueError("expected a token and a command")  # noqa: TRY004 - refuses the client, as all here
        token, command = str(message.get("token")), message["command"]
        if not hmac.compare_digest(token.encode(), self._access.token.encode()):
            raise ValueError("the token is wrong")
        if not COMMANDS.fullmatch(command):
            raise ValueError("there is no such button")
        if len(self._pending) >= MOST_PENDING:
            send(_answer(command, {"ok": False, "error": "the service is busy; try again"}))
            return
        task = asyncio.create_task(self._carry_out(command, send))
        self._pending.add(task)
        task.add_done_callback(self._pending.discard)

    def close(self) -> None:
        """Wait for no answer any more."""
        for task in self._pending:
            task.cancel()

    async def _carry_out(self, command: str, send: Any) -> None:
        try:
            async with asyncio.timeout(PATIENCE_S):
                answer = await ask_service(self._access.path, command)
        except (OSError, ValueError, TimeoutError) as error:
            reason = f": {error}" if str(error) else ""
            answer = {"ok": False, "error": f"the service does not answer{reason}"}
        send(_answer(command, answer))


def _answer(command: str, answer: dict[str, Any]) -> str:
    return json.dumps({"kind": "answer", "command": command, "answer": answer}, separators=(",", ":"))


async def ask_service(path: str, command: str) -> dict[str, Any]:
    """Answer of the control socket at a path."""
    reader, writer = await asyncio.open_unix_connection(path, limit=LONGEST_ANSWER)
    try:
        writer.write(command.encode() + b"\n")
        return dict(json.loads(await reader.readline()))
    finally:
        writer.close()
