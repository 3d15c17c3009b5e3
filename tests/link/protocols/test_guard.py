"""An error inside of a decoder: one frame is lost, counted and quoted, and reading goes on."""

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.link.protocols.decoder import DecoderCounters, DeviceDescription
from gyrodrift.link.protocols.detect import Detector
from gyrodrift.link.protocols.guard import Guard
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.link.protocols.registry import PROTOCOLS
from gyrodrift.values.sample import Reading

POISON = b"POISON\n"


class BrittleDecoder:
    """Lines of a rate; one of them breaks it."""

    name = "brittle"
    unread = ""

    def __init__(self, error: Exception | None = None) -> None:
        self.counters = DecoderCounters()
        self.device = DeviceDescription()
        self._pending = b""
        self._error = error or KeyError("nobody thought of that")

    def push(self, chunk: bytes) -> list[Reading]:
        *lines, self._pending = (self._pending + chunk).split(b"\n")
        readings = []
        for line in lines:
            if line + b"\n" == POISON:
                raise self._error
            if line.isdigit():
                readings.append(Reading(None, None, float(line)))
                self.counters.frames += 1
        return readings


def brittle(error: Exception | None = None) -> WireProtocol:
    return WireProtocol("brittle", "for tests", lambda: BrittleDecoder(error), has_clock=False, rank=1)


class Heard:
    def __init__(self) -> None:
        self.told: list[tuple[str, dict[str, Any]]] = []

    def __call__(self, event: str, **fields: Any) -> None:
        self.told.append((event, fields))


@pytest.mark.promise("Recovery")
@pytest.mark.parametrize("error", [KeyError("x"), RecursionError(), MemoryError(), TypeError("unhashable")])
def test_whatever_a_decoder_raises_costs_the_frame_it_is_in(error: Exception) -> None:
    """An error inside a decoder costs one frame and is counted as `damaged`."""
    protocol, heard = brittle(error), Heard()
    guard, decoder = Guard(heard), protocol.decoder()
    rates = []
    for _ in range(3):
        decoder, readings = guard.push(protocol, decoder, b"1\n2\n" + POISON + b"3\n" + POISON + b"4\n")
        rates += [reading.rate_dps for reading in readings]
    assert rates == [1.0, 2.0, 3.0, 4.0] * 3
    assert decoder.counters.damaged == 6
    ((event, fields),) = heard.told
    assert event == "decoder_failed"
    assert (fields["protocol"], fields["error"]) == ("brittle", type(error).__name__)
    assert "POISON" in fields["content"]


def test_an_error_that_took_two_reads_to_make_is_counted_too() -> None:
    """The bytes of the second one alone are harmless."""
    protocol, heard = brittle(), Heard()
    guard, decoder = Guard(heard), protocol.decoder()
    decoder, _ = guard.push(protocol, decoder, b"1\nPOI")
    decoder, readings = guard.push(protocol, decoder, b"SON\n5\n")
    assert [reading.rate_dps for reading in readings] == [5.0]
    assert (decoder.counters.damaged, len(heard.told)) == (1, 1)


def test_a_decoder_that_fails_does_not_keep_others_from_being_found() -> None:
    heard = Heard()
    detector = Detector([brittle(), PROTOCOLS["csv"]], Guard(heard))
    lines = b"".join(b"%d,0.5\n" % t_us for t_us in range(0, 100_000, 10_000))
    result = detector.push(POISON + lines)
    assert result is not None
    assert result[0].name == "csv"
    assert [event for event, _ in heard.told] == ["decoder_failed"]


@given(st.lists(st.binary(max_size=200), max_size=8))
def test_no_shipped_decoder_needs_it(chunks: list[bytes]) -> None:
    heard = Heard()
    guard = Guard(heard)
    for protocol in PROTOCOLS.values():
        decoder = protocol.decoder()
        for chunk in chunks:
            decoder, _ = guard.push(protocol, decoder, chunk)
    assert heard.told == []
