"""The one place where decoders are called: an error inside of a decoder costs a frame, never the service.

No shipped decoder raises, and property tests hold that. A device can send anything at all, though, and protocols may be
registered from outside: whatever a decoder raises is damage here.
"""

from collections.abc import Callable
from typing import Any

from gyrodrift.link.heard import quoted
from gyrodrift.link.protocols.decoder import Decoder
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.sample import Reading

EVENT = "decoder_failed"
QUOTED_BYTES = 80


def _unheard(event: str, **fields: Any) -> None:
    """Nobody listens."""
    _ = event, fields


class Guard:
    """Pushes bytes into decoders; of the first error there is an event, and every error counts as damage."""

    def __init__(self, on_event: Callable[..., Any] = _unheard) -> None:
        self._on_event = on_event
        self._is_told = False

    def push(self, protocol: WireProtocol, decoder: Decoder, chunk: bytes) -> tuple[Decoder, list[Reading]]:
        """The readings that the bytes complete, and the decoder to go on with.

        That is a fresh one after an error, as after a reconnect. It is given the same bytes once more, one by one, and
        so an error costs the frame it is in.
        """
        try:
            return decoder, decoder.push(chunk)
        except Exception as error:  # noqa: BLE001 - whatever it is, the next frame is read
            first_error = error
        fresh, readings, errors = self._push_bytes(protocol, renewed(protocol, decoder), chunk)
        if not errors:  # what came before these bytes was a part of it
            self._count(protocol, fresh, first_error, chunk)
        return fresh, readings

    def _push_bytes(self, protocol: WireProtocol, decoder: Decoder, chunk: bytes) -> tuple[Decoder, list[Reading], int]:
        readings: list[Reading] = []
        begun = errors = 0
        for at in range(len(chunk)):
            try:
                readings += decoder.push(chunk[at : at + 1])
            except Exception as error:  # noqa: BLE001 - likewise
                decoder = renewed(protocol, decoder)
                self._count(protocol, decoder, error, chunk[begun : at + 1])
                begun, errors = at + 1, errors + 1
        return decoder, readings, errors

    def _count(self, protocol: WireProtocol, decoder: Decoder, error: Exception, content: bytes) -> None:
        decoder.counters.damaged += 1
        if not self._is_told:
            self._is_told = True
            shown = quoted(content[-QUOTED_BYTES:].decode("ascii", "backslashreplace"))
            self._on_event(EVENT, protocol=protocol.name, error=type(error).__name__, content=shown)


def renewed(protocol: WireProtocol, decoder: Decoder) -> Decoder:
    """A fresh decoder that goes on counting, and remembers whom it heard.

    Half a frame, and the scale, went with the old one: until it is said again nobody knows that it is the same device.
    """
    fresh = protocol.decoder()
    fresh.counters, fresh.device = decoder.counters, decoder.device
    return fresh
