"""Record of a wire protocol, which link, detection, `--protocol` and help use."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from gyrodrift.link.protocols.decoder import Decoder
from gyrodrift.values.sample import Reading

SURE_FRAMES = 3
"""Good frames that make a protocol certain: noise passes any shipped protocol less than once in 10^9 runs."""


def _any_reading(readings: Sequence[Reading]) -> bool:  # noqa: ARG001 - a checksum is enough
    """Accept all readings."""
    return True


@dataclass(frozen=True, slots=True)
class WireProtocol:
    """A wire protocol.

    name
        Name for `--protocol`, and of the decoder.
    help
        Short description for the help of a command.
    decoder
        Function that creates a decoder.
    has_clock
        Whether its readings can have device times; others get their arrival time.
    rank
        Order of detection, ascending: strong checksums come first.
    sure_frames
        Number of good frames that make the protocol certain; so does the id of a device.
    is_detected
        Whether detection tries it; False if the user must describe its layout.
    has_unit
        Whether the protocol defines the unit of its rates; otherwise the unit is checked.
    is_unit_said
        Whether the unit of its rates is stated; if not, a stream in another unit is an error.
    is_asked
        Whether the user named the protocol or its columns; a detected one is a guess until the device turns.
    rate_scale
        Deg/s per unit of its rates, if the user stated it; their readings are in deg/s.
    sends_angle
        Whether its readings have an angle instead of a rate, which a filter in the device has processed.
    is_plausible
        Function that checks readings; lines without a checksum may only look like the protocol.
    asked_decoder
        Decoder for a protocol that the user names, if it accepts more than detection may.
    holds_zero
        Whether its devices send exactly 0 at rest, because their filter removes bias and noise.
    without_rate
        Advice for a device that sends no rate; empty if every frame has one.
    choice_hint
        Advice if the stream holds further devices, which are passed over.
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
    is_asked: bool = False
    rate_scale: float = 1.0
    sends_angle: bool = False
    is_plausible: Callable[[Sequence[Reading]], bool] = _any_reading
    asked_decoder: Callable[[], Decoder] | None = None
    holds_zero: bool = False
    without_rate: str = ""
    choice_hint: str = (
        "the first talker is used; --columns 'TIROT 1=rate:lsb/60:-' chooses another one, here the rate of TI, "
        "and --columns 'HEHDT 1=yaw:deg:-' the heading of HE"
    )
