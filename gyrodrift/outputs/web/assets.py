"""Answers to requests of a browser: the files of the page, and checks of the host and origin.

A content security policy keeps the page from loading anything else. Requests with a foreign host name are refused.
Otherwise a foreign page whose name resolves to this machine could read the stream (DNS rebinding).
"""

import ipaddress
import re
import socket
from http import HTTPStatus
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

if TYPE_CHECKING:
    from websockets.asyncio.server import ServerConnection
    from websockets.datastructures import Headers
    from websockets.http11 import Request, Response

FOLDER = Path(__file__).with_name("page")
STREAM = "/stream"

HOST = re.compile(r"(\[[0-9A-Fa-f:.]+\]|[^\s/?#@:\\\[\]]+)(:[0-9]{1,5})?")
"""Host header (RFC 9110, section 7.2): without user, path, query and zone, which a parser of URLs would accept."""

KINDS = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
    "": "text/plain; charset=utf-8",
}

HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
    "img-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-cache",
    "Connection": "close",
}


class Assets:
    """Files of the page, read once.

    Parameters
    ----------
    names
        Accepted host names besides addresses, localhost and the name of this machine.
    """

    def __init__(self, *names: str) -> None:
        self._files = {
            f"/{path.relative_to(FOLDER)}": (KINDS[path.suffix], path.read_bytes())
            for path in FOLDER.rglob("*")
            if path.is_file() and path.suffix in KINDS
        }
        self._files["/"] = self._files["/index.html"]
        machine = socket.gethostname().lower()
        self._names = {"localhost", machine, f"{machine}.local", *(name.lower() for name in names if name)}

    def answer(self, _connection: "ServerConnection", request: "Request") -> "Response | None":
        """A file or a refusal; None continues with the handshake."""
        host = _single(request.headers, "Host")
        name = _name_in(host)
        if not self._is_ours(name):
            return _text_response(
                HTTPStatus.FORBIDDEN, f"The host name {name!r} is not accepted; add it with web:reached_as=NAME."
            )
        path = request.path.partition("?")[0]
        if path == STREAM:
            ours = {f"http://{host}", f"https://{host}"}
            if any(origin not in ours for origin in request.headers.get_all("Origin")):
                return _text_response(HTTPStatus.FORBIDDEN, "This stream is only for its own page.")
            return None
        if path not in self._files:
            return _text_response(HTTPStatus.NOT_FOUND, "There is no such page.")
        return _response(HTTPStatus.OK, *self._files[path])

    def _is_ours(self, name: str) -> bool:
        try:
            ipaddress.ip_address(name)
        except ValueError:
            return name in self._names
        return True


def _single(headers: "Headers", name: str) -> str:
    """Value of a header; empty if there is none or more than one."""
    values = headers.get_all(name)
    return values[0] if len(values) == 1 else ""


def _name_in(host: str) -> str:
    """Name in a Host header, in lower case; empty if the header is anything but a name and a port."""
    if not HOST.fullmatch(host):
        return ""
    try:
        return (urlsplit(f"//{host}").hostname or "").lower()
    except ValueError:
        return ""


def _text_response(status: HTTPStatus, text: str) -> "Response":
    return _response(status, KINDS[""], text.encode() + b"\n")


def _response(status: HTTPStatus, kind: str, body: bytes) -> "Response":
    from websockets.datastructures import Headers
    from websockets.http11 import Response

    headers = Headers(HEADERS | {"Content-Type": kind, "Content-Length": str(len(body))})
    return Response(status.value, status.phrase, headers, body)
