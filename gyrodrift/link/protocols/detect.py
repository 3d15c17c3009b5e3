"""Which protocol is this? All decoders listen to the same bytes, and the first one that is sure wins."""

from collections.abc import Callable

from gyrodrift.errors import UsageError
from gyrodrift.link.protocols.csv import CsvDecoder
from gyrodrift.link.protocols.decoder import Decoder
from gyrodrift.link.protocols.native import NativeDecoder
from gyrodrift.link.protocols.witmotion import WitmotionDecoder
from gyrodrift.sample import Reading

DECODERS: dict[str, Callable[[], Decoder]] = {
    NativeDecoder.name: NativeDecoder,
    CsvDecoder.name: CsvDecoder,
    WitmotionDecoder.name: WitmotionDecoder,
}
AUTO = "auto"
PROTOCOLS = (AUTO, *DECODERS)

SURE_FRAMES = 3
"""Good frames to be sure: of noise, fewer than one in 10^9 such runs passes any of the three protocols."""


def decoder_for(protocol: str) -> Decoder:
    """A fresh decoder for a protocol given by name."""
    if protocol not in DECODERS:
        raise UsageError(f"unknown protocol {protocol!r}; known are {', '.join(PROTOCOLS)}")
    return DECODERS[protocol]()


class Detector:
    """Listens with every decoder that comes into question until one is sure; the readings of that one are kept."""

    def __init__(self, protocol: str = AUTO) -> None:
        names = DECODERS if protocol == AUTO else [protocol]
        self._candidates: list[tuple[Decoder, list[Reading]]] = [(decoder_for(name), []) for name in names]

    @property
    def is_warm(self) -> bool:
        """Whether some decoder has understood something."""
        return any(decoder.counters.frames for decoder, _ in self._candidates)

    def push(self, chunk: bytes) -> tuple[Decoder, list[Reading]] | None:
        """Take the next bytes; the decoder that is sure, with all it has read so far, or None."""
        for decoder, readings in self._candidates:
            readings.extend(decoder.push(chunk))
            if decoder.counters.frames >= SURE_FRAMES or decoder.facts.device_id is not None:
                return decoder, readings
        return None
