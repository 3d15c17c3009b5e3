"""The milli protocol: `W<rate in thousandths of a deg/s>!`. No device clock."""

from gyrodrift.link.protocols.decoder import DecoderCounters, DeviceDescription
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.sample import Reading


class MilliDecoder:
    """Splits the stream at the end marks."""

    name = "milli"

    def __init__(self) -> None:
        self.counters = DecoderCounters()
        self.device = DeviceDescription()
        self.unread = ""
        self._pending = b""

    def push(self, chunk: bytes) -> list[Reading]:
        """Return the readings of complete frames."""
        *frames, self._pending = (self._pending + chunk).split(b"!")
        self._pending = self._pending[-20:]
        rates = [frame[1:] for frame in frames if frame[:1] == b"W" and frame[1:].lstrip(b"-").isdigit()]
        self.counters.frames += len(rates)
        self.counters.damaged += len(frames) - len(rates)
        return [Reading(None, None, int(rate) / 1000.0) for rate in rates]


PROTOCOL = WireProtocol("milli", "rates in thousandths of a deg/s", MilliDecoder, has_clock=False, rank=30)
