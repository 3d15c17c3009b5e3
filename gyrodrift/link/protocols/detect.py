"""Which protocol is this? All decoders listen to the same bytes, and the first one that is sure wins."""

from collections.abc import Sequence

from gyrodrift.link.protocols.decoder import Decoder
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.sample import Reading


class Detector:
    """Listens with every decoder that comes into question until one is sure; the readings of that one are kept."""

    def __init__(self, protocols: Sequence[WireProtocol]) -> None:
        self._listening: list[tuple[Decoder, int, list[Reading]]] = [
            (each.decoder(), each.sure_frames, []) for each in protocols
        ]

    @property
    def is_warm(self) -> bool:
        """Whether some decoder has understood something."""
        return any(decoder.counters.frames for decoder, _, _ in self._listening)

    def push(self, chunk: bytes) -> tuple[Decoder, list[Reading]] | None:
        """Take the next bytes; the decoder that is sure, with all it has read so far, or None."""
        for decoder, sure_frames, readings in self._listening:
            readings.extend(decoder.push(chunk))
            if decoder.counters.frames >= sure_frames or decoder.device.device_id is not None:
                return decoder, readings
        return None
