"""Guard around all decoders: an error inside a decoder costs a frame, not the service.

Shipped decoders do not raise, which property tests check. Protocols may be registered from outside, however, and their
errors count as damage.
"""

from collections.abc import Callable
from typing import Any

from gyrodrift.link.heard import quoted
from gyrodrift.link.protocols.decoder import Decoder
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.values.sample import Reading

EVENT = "decoder_failed"
QUOTED_BYTES = 80


def _ignore_event(event: str, **fields: Any) -> None:
    """Ignore the event."""
    _ = event, fields


class Guard:
    """Push bytes into decoders; the first error is an event, and every error counts as damage."""

    def __init__(self, on_event: Callable[..., Any] = _ignore_event) -> None:
        self._on_event = on_event
        self._is_told = False

    def push(self, protocol: WireProtocol, decoder: Decoder, chunk: Any) -> tuple[Decoder, list[Reading]]:
        """Completed readings, and the decoder to use from now on.

        After an error that is a fresh decoder, as after a reconnect. It gets the same bytes again, one by one, so that
        an error costs one frame.
        """
        try:
            return decoder, decoder.push(chunk)
        except Exception as error:  # noqa: BLE001 - any error, the next frame is read
            first_error = error
        fresh, readings, errors = self._push_bytes(protocol, renewed(protocol, decoder), chunk)
        if not errors:  # earlier bytes were a part of it
            self._count(protocol, fresh, first_error, chunk)
        return fresh, readings

    def _push_bytes(self, protocol: WireProtocol, decoder: Decoder, chunk: bytes) -> tuple[Decoder, list[Reading], int]:
        readings: list[Reading] = []
        begun = errors = 0
        for position in range(len(chunk)):
            try:
                readings += decoder.push(chunk[position : position + 1])
            except Exception as error:  # noqa: BLE001 - as above
                decoder = renewed(protocol, decoder)
                self._count(protocol, decoder, error, chunk[begun : position + 1])
                begun, errors = position + 1, errors + 1
        return decoder, readings, errors

    def _count(self, protocol: WireProtocol, decoder: Decoder, error: Exception, content: bytes) -> None:
        decoder.counters.damaged += 1
        if not self._is_told:
            self._is_told = True
            shown = quoted(content[-QUOTED_BYTES:].decode("ascii", "backslashreplace"))
            self._on_event(EVENT, protocol=protocol.name, error=type(error).__name__, content=shown)


def renewed(protocol: WireProtocol, decoder: Decoder) -> Decoder:
    """Fresh decoder with the counters and the device of the old one.

    The scale is dropped: until the device sends it again, it may be another device.
    """
    fresh = protocol.decoder()
    fresh.counters, fresh.device = decoder.counters, decoder.device
    return fresh
