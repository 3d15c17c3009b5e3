"""BNO08x in UART-RVC mode: `AA AA index yaw pitch roll x y z … sum` at 100 Hz; the rate is the difference of yaw.

The chip sends yaw in hundredths of a degree, and no rate. Differences give a rate with a resolution of 1 deg/s, whose
sum is exactly the yaw of the chip. The filter of the chip has removed the bias already, so that another filter can
correct little. Only other protocols of the chip have the rate of the sensor (BNO080 data sheet 1000-3927, 1.3.5 and
6.5; yaw is positive counter-clockwise, chapter 4).

The index counts frames of 10 ms and is the clock: a lost frame is a gap, and yaw stays right.
"""

import re
from struct import Struct

from gyrodrift.link.clocks.clock import FASTEST_DPS
from gyrodrift.link.protocols.decoder import DeviceDescription
from gyrodrift.link.protocols.frames import FrameDecoder
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.values.constants import CLOCK_MASK, COUNTER_MASK
from gyrodrift.values.sample import Reading

FRAME = Struct("<2sBhhhhhhBBBB")
PERIOD_US = 10_000
CENTIDEGREES = 36_000


class RvcDecoder(FrameDecoder):
    """Decoder of yaw differences; the first frame gives no reading."""

    name = "bno08x-rvc"
    head = b"\xaa\xaa"
    header = re.compile(head)
    header_bytes = len(head)
    needs_two = True

    def __init__(self) -> None:
        super().__init__()
        self.device = DeviceDescription(sample_rate_hz=100.0, dps_per_lsb=1.0)
        self._yaw: int | None = None
        self._index = 0
        self._count = 0

    def length(self, buffer: bytes, position: int) -> int | None:  # noqa: ARG002 - constant here
        """Length of all frames."""
        return FRAME.size

    def is_whole(self, frame: bytes) -> bool:
        """Whether the sum of all bytes between head and sum is right."""
        return sum(frame[2:-1]) & 0xFF == frame[-1]

    def read(self, frame: bytes) -> Reading | None:
        """Mean rate since the last frame."""
        _, index, yaw, *_ = FRAME.unpack(frame)
        before, steps = self._yaw, (index - self._index) & 0xFF
        self._yaw, self._index = yaw, index
        self._count += steps
        if before is None or not steps:
            return None
        turn_centideg = (yaw - before + CENTIDEGREES // 2) % CENTIDEGREES - CENTIDEGREES // 2
        rate_dps = turn_centideg / steps
        if abs(rate_dps) > FASTEST_DPS:
            return None
        return Reading(self._count * PERIOD_US & CLOCK_MASK, self._count & COUNTER_MASK, rate_dps)


PROTOCOL = WireProtocol(
    "bno08x-rvc",
    "yaw of a BNO08x in UART-RVC mode, as a rate of 1 deg/s resolution",
    RvcDecoder,
    has_clock=True,
    rank=18,
    has_unit=True,
    holds_zero=True,
)
