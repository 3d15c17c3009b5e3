"""A Signal K server of npm with one data connection, asked over HTTP for what it shows."""

import json
import os
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any
from urllib.request import urlopen

from clients_support import CLIENTS, need_node
from support import PATIENCE_S, free_port

SIGNALK = CLIENTS / "signalk"
NAVIGATION = "/signalk/v1/api/vessels/self/navigation"


@dataclass(frozen=True, slots=True)
class SignalkServer:
    """Port of its HTTP."""

    port: int

    def navigation(self, name: str, feed: Callable[[int], object]) -> dict[str, Any]:
        until_s = time.monotonic() + 6 * PATIENCE_S
        for number in count():
            feed(number)
            with suppress(OSError), urlopen(f"http://127.0.0.1:{self.port}{NAVIGATION}", timeout=PATIENCE_S) as answer:
                shown = dict(json.load(answer))
                if name in shown:
                    return shown
            assert time.monotonic() < until_s, f"the server shows no {name}"
            time.sleep(0.1)
        raise AssertionError


@contextmanager
def signalk_server(kind: str, source: dict[str, Any], folder: Path) -> Iterator[SignalkServer]:
    """A server that reads a source of this kind; the test skips where there is none."""
    node, number = need_node(SIGNALK, "signalk-server"), free_port()
    element = {"type": "providers/simple", "options": {"type": kind, "logging": False, "subOptions": source}}
    provider = {"id": "gyro", "enabled": True, "pipeElements": [element]}
    settings = {"interfaces": {}, "port": number, "mdns": False, "pipedProviders": [provider]}
    (folder / "settings.json").write_text(json.dumps(settings))
    with subprocess.Popen(
        [node, SIGNALK / "node_modules" / "signalk-server" / "bin" / "signalk-server", "-c", folder],
        env=os.environ | {"PORT": str(number), "SIGNALK_DISABLE_SERVER_UPDATES": "true"},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    ) as server:
        try:
            yield SignalkServer(number)
        finally:
            server.kill()
