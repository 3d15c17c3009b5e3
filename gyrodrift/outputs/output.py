"""Base class of the outputs.

All outputs run in one process beside the service, on one asyncio loop. Only `open` and `close` may wait. A client that
does not read has a bounded queue (see the servers in `net`). A library that waits needs a thread.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar, Generic, TypeVar

from gyrodrift.io.logger import FilteringBoundLogger
from gyrodrift.outputs.status import ClientStatus, ServiceStatus
from gyrodrift.values.sample import Corrected

O = TypeVar("O")  # noqa: E741 - the options of an output


class OutputError(Exception):
    """An output cannot be opened, or has failed; it is retried later. The text says why."""


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
        Access to the control socket; None without one.
    source
        Name of the source of its samples; empty if there is one gyro.
    """

    log: FilteringBoundLogger
    status: ServiceStatus = field(default_factory=ServiceStatus)
    access: ControlAccess | None = None
    source: str = ""


class Output(Generic[O]):
    """Takes corrected samples and sends them on.

    options_type
        The frozen dataclass of its options.
    address
        Address that it listens on or sends to, as text; set by `open`.
    warning
        Problem of an open output, as text; empty without one.
    """

    options_type: ClassVar[type[Any]]

    def __init__(self, options: O, host: OutputHost) -> None:
        self.options = options
        self.host = host
        self.address = ""
        self.warning = ""

    @classmethod
    def exclusive_resources(cls, options: O) -> frozenset[str]:
        """Exclusive resources, such as a port: a closing output must free them first."""
        port, path = getattr(options, "port", 0), getattr(options, "path", "")
        return frozenset([*([f"port {port}"] if port else []), *([f"path {path}"] if path else [])])

    async def open(self) -> None:
        """Begin to listen, or connect.

        Raises
        ------
        OutputError
            If that fails; it is retried later.
        """

    def take(self, samples: Sequence[Corrected]) -> None:
        """Take samples that reached this process together, in order: one to some hundred.

        Raises
        ------
        OutputError
            If it has failed; it is closed, and opened again later.
        """

    def hear(self, event: str, fields: Mapping[str, Any]) -> None:
        """Take an event of the log of the service: a gap, a lost link, a new config."""

    def note(self, status: ServiceStatus) -> None:
        """Take the state of the service, once a second."""

    def clients(self) -> Sequence[ClientStatus]:
        """Present clients."""
        return ()

    def counts(self) -> tuple[int, int]:
        """Messages sent and dropped since it was opened, with those of former clients."""
        return 0, 0

    async def close(self) -> None:
        """Close everything; also called after an `open` that failed."""
