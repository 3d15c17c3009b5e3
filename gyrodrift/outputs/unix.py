"""JSON lines on a unix socket."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from annotated_types import MaxLen

from gyrodrift.outputs.line_output import LineOutput
from gyrodrift.outputs.options import About, Rate
from gyrodrift.outputs.output import OutputHost

LONGEST_PATH = 107
"""Longest path in bytes: sun_path of unix(7)."""

NAME = "gyrodrift.sock"


@dataclass(frozen=True, slots=True)
class UnixOptions:
    """Address and rate."""

    path: Annotated[
        str, MaxLen(LONGEST_PATH), About(f"path of the socket; {NAME} in the runtime directory if empty")
    ] = ""
    rate_hz: Annotated[Rate, About("at most this many lines a second for clients that request no rate")] = None


class UnixOutput(LineOutput[UnixOptions]):
    """Like `tcp`, but only for this user."""

    options_type = UnixOptions

    def __init__(self, options: UnixOptions, host: OutputHost) -> None:
        super().__init__(options, host, options.rate_hz)

    async def open(self) -> None:
        """Begin to listen."""
        self.address = await self.server.listen_unix(Path(self.options.path or runtime_folder() / NAME))


def runtime_folder() -> Path:
    """Runtime folder of the service under systemd or of the session of the user; otherwise /tmp."""
    for name in ("RUNTIME_DIRECTORY", "XDG_RUNTIME_DIR"):
        folder = os.environ.get(name, "").partition(":")[0]
        if folder and Path(folder).is_dir():
            return Path(folder)
    return Path("/tmp")  # noqa: S108 - the socket is only for this user, and a foreign socket is refused
