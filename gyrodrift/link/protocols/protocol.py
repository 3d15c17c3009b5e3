"""What a wire protocol is to the host: one record, from which link, detection, `--protocol` and its help follow."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from gyrodrift.link.protocols.decoder import Decoder
from gyrodrift.sample import Reading

SURE_FRAMES = 3
"""Good frames to be sure: of noise, fewer than one in 10^9 such runs passes any of the shipped protocols."""


def _any_reading(readings: Sequence[Reading]) -> bool:  # noqa: ARG001 - of a protocol whose frames say enough
    """Frames with a checksum are what they look like."""
    return True


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
    is_unit_said
        Whether somebody or something says in which unit its rates are; a stream of another unit ends where nobody does.
    sends_angle
        Whether its readings have an angle in place of a rate: the filter of the device has been at work.
    is_plausible
        Whether readings of good frames can be of the protocol: lines without a checksum may look like it.
    asked_decoder
        The decoder where a person asks for the protocol by name, if it takes more than detection may believe.
    holds_zero
        Whether its devices say exactly 0 at rest: a filter of theirs has taken bias and noise away.
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
    is_unit_said: bool = True
    sends_angle: bool = False
    is_plausible: Callable[[Sequence[Reading]], bool] = _any_reading
    asked_decoder: Callable[[], Decoder] | None = None
    holds_zero: bool = False
    without_rate: str = ""
