"""What every output is: one shape, of which an output fills in what it has a use for.

All outputs run in one process beside the service, on one asyncio loop. Nothing here may wait but `open` and `close`:
a client who does not read gets a queue of its own that is bounded (`net` has the servers), and a library that waits
gets a thread of its own.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar, Generic, TypeVar

from gyrodrift.logger import FilteringBoundLogger
from gyrodrift.outputs.status import ClientStatus, ServiceStatus
from gyrodrift.sample import Corrected

O = TypeVar("O")  # noqa: E741 - the options of an output


class OutputError(Exception):
    """An output cannot be opened, or cannot go on; it is tried again after a while. The text says why, to a person."""


@dataclass(frozen=True, slots=True)
class ControlAccess:
    """Path of the control socket, and the token that a local page needs for it."""

    path: str
    token: str = field(repr=False)


@dataclass(slots=True)
class OutputHost:
    """Surroundings of an output.

    log
        Its logger; every line names the output.
    status
        State of the service as of the last second.
    access
        Way to the control socket; None where the service has none.
    """

    log: FilteringBoundLogger
    status: ServiceStatus = field(default_factory=ServiceStatus)
    access: ControlAccess | None = None


class Output(Generic[O]):
    """Takes corrected samples and sends them on.

    options_type
        The frozen dataclass of its options.
    address
        Where it listens or sends to, for a person; set by `open`.
    warning
        What is wrong although it is open, for a person; empty where nothing is.
    """

    options_type: ClassVar[type[Any]]

    def __init__(self, options: O, host: OutputHost) -> None:
        self.options = options
        self.host = host
        self.address = ""
        self.warning = ""

    @classmethod
    def claims(cls, options: O) -> frozenset[str]:
        """What it takes for itself alone, such as its port: an output that goes must let go of it first."""
        port, path = getattr(options, "port", 0), getattr(options, "path", "")
        return frozenset([*([f"port {port}"] if port else []), *([f"path {path}"] if path else [])])

    async def open(self) -> None:
        """Begin to listen, or connect.

        Raises
        ------
        OutputError
            Where that does not go; it is tried again after a while.
        """

    def take(self, samples: Sequence[Corrected]) -> None:
        """Take samples, in order: those that reached this process together, one to some hundred.

        Raises
        ------
        OutputError
            Where it cannot go on; it is closed, and opened again after a while.
        """

    def hear(self, event: str, fields: Mapping[str, Any]) -> None:
        """Take an event of the service's log: a gap, a lost link, a config that was applied."""

    def note(self, status: ServiceStatus) -> None:
        """Take the service's state, once a second."""

    def clients(self) -> Sequence[ClientStatus]:
        """Who listens now."""
        return ()

    def counts(self) -> tuple[int, int]:
        """Messages sent and dropped since it was opened, to clients that are gone too."""
        return 0, 0

    async def close(self) -> None:
        """Let go of everything; also called after an `open` that failed half way."""
