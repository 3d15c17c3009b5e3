"""Detection of the protocol: all decoders get the same bytes, and the first certain one wins."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from gyrodrift.link.protocols.decoder import Decoder
from gyrodrift.link.protocols.guard import Guard
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.values.sample import Reading


@dataclass(slots=True)
class _Candidate:
    protocol: WireProtocol
    decoder: Decoder
    readings: list[Reading] = field(default_factory=list)

    @property
    def is_sure(self) -> bool:
        """Whether enough good frames arrived, or the device sent its id."""
        decoder = self.decoder
        return decoder.counters.frames >= self.protocol.sure_frames or decoder.device.device_id is not None


class Detector:
    """Feed all candidate decoders until one is certain, and keep its readings."""

    def __init__(self, protocols: Sequence[WireProtocol], guard: Guard | None = None) -> None:
        self._candidates = [_Candidate(protocol, protocol.decoder()) for protocol in protocols]
        self._is_given = len(self._candidates) == 1
        self._guard = guard or Guard()

    @property
    def is_warm(self) -> bool:
        """Whether a decoder has decoded a frame."""
        return any(candidate.decoder.counters.frames for candidate in self._candidates)

    def push(self, chunk: bytes) -> tuple[Decoder, list[Reading]] | None:
        """Add bytes; return the certain decoder with all its readings, or None."""
        return self._push(self._candidates, chunk)

    def join(self, protocols: Sequence[WireProtocol], chunk: bytes) -> tuple[Decoder, list[Reading]] | None:
        """Add candidates, which get only the last bytes of those before; return the certain decoder, or None."""
        new = [_Candidate(protocol, protocol.decoder()) for protocol in protocols]
        self._candidates += new
        return self._push(new, chunk)

    def _push(self, candidates: Sequence[_Candidate], chunk: bytes) -> tuple[Decoder, list[Reading]] | None:
        for candidate in candidates:
            candidate.decoder, readings = self._guard.push(candidate.protocol, candidate.decoder, chunk)
            candidate.readings += readings
            if candidate.is_sure and (self._is_given or candidate.protocol.is_plausible(candidate.readings)):
                return candidate.decoder, candidate.readings
        return None
