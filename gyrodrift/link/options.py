"""Options and counters of a link, and the type of its event handlers."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from gyrodrift.link.protocols.registry import AUTO

EventHandler = Callable[..., Any]
"""Function that gets the name and the fields of a link event: `on_event("gap", missing=3, seconds=0.04)`."""


@dataclass(slots=True)
class LinkCounters:
    """Counters since the link was opened.

    impossible, clipped, unmeasured
        Samples with a rate that cannot be, at the end of the range, and passed on without their rate.
    """

    bytes: int = 0
    samples: int = 0
    gaps: int = 0
    missing: int = 0
    device_resets: int = 0
    reconnects: int = 0
    gone_s: float = 0.0
    impossible: int = 0
    clipped: int = 0
    unmeasured: int = 0


@dataclass(frozen=True, slots=True)
class LinkOptions:
    """Options of a link.

    baud
        Baud rate; None to find it.
    timeout_s
        Longest time without a decodable sample after the start, s; 0 to wait forever.
    columns
        Columns of the text protocol; None for other protocols.
    waits
        Whether a port that is not there at the start is waited for.
    send
        Bytes that are sent to the device after its port was opened.
    keeps_on
        Whether rates that contradict their guessed form only give an event, as for a recording.
    """

    port: str
    baud: int | None = None
    protocol: str = AUTO
    timeout_s: float = 10.0
    columns: str | None = None
    send: bytes = b""
    waits: bool = False
    keeps_on: bool = False
