"""What a wire protocol is to the host: one record, from which link, detection, `--protocol` and its help follow."""

from collections.abc import Callable
from dataclasses import dataclass

from gyrodrift.link.protocols.decoder import Decoder

SURE_FRAMES = 3
"""Good frames to be sure: of noise, fewer than one in 10^9 such runs passes any of the shipped protocols."""


@dataclass(frozen=True, slots=True)
class WireProtocol:
    """One of them.

    name
        What `--protocol` calls it; the decoder's name too.
    help
        What it is, in a few words for the help of a command.
    decoder
        Makes a fresh decoder.
    has_clock
        Whether its readings can carry the time of the device; those that do not are timed by their arrival.
    rank
        Detection asks the protocols in ascending order: those with the strongest checksum come first.
    sure_frames
        So many good frames say that a stream is of this protocol, as one introduction of a device does.
    is_detected
        Whether detection listens for it; not where a person has to say how it is laid out.
    has_unit
        Whether the protocol itself lays down the unit of its rates; those of others are looked at.
    without_rate
        What to do where a device speaks it and sends no rate; empty where each of its frames has one.
    """

    name: str
    help: str
    decoder: Callable[[], Decoder]
    has_clock: bool
    rank: int
    sure_frames: int = SURE_FRAMES
    is_detected: bool = True
    has_unit: bool = False
    without_rate: str = ""
