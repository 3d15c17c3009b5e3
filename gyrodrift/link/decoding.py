"""Decoders of a link: detection of the protocol, a decoder for each sender, plug-ins, and the device's description."""

from typing import Any

from gyrodrift.link.options import EventHandler, LinkOptions
from gyrodrift.link.protocols import text
from gyrodrift.link.protocols.decoder import Decoder, DeviceDescription
from gyrodrift.link.protocols.detect import Detector
from gyrodrift.link.protocols.guard import Guard, renewed
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.link.protocols.registry import AUTO, PROTOCOLS, added_candidates, candidates
from gyrodrift.link.turn_queue import Arrived, LateArrivals
from gyrodrift.values.sample import Reading

STREAMS_MAX = 256
"""Largest number of senders that are heard before the first sample; the decoders of one take about 10 kB."""

PLUG_IN_BYTES = 256
"""Bytes that no protocol of gyrodrift understands before those of plug-ins are tried; chosen, over three frames of most
protocols. So the start with a usual device neither looks for plug-ins nor imports them."""


class Decoding:
    """From bytes to readings, with the decoder of the options, or the one that is found.

    decoder
        The decoder; None until it is found.
    device
        Description of the device by itself; empty without one.

    Parameters
    ----------
    options
        Of the link.
    source_protocol
        The only protocol of a source; None for bytes of any protocol.
    has_known_baud
        Whether no other baud rate is tried, so that the only possible protocol needs no detection.
    on_event
        Takes the events.
    """

    def __init__(
        self,
        options: LinkOptions,
        source_protocol: WireProtocol | None,
        on_event: EventHandler,
        *,
        has_known_baud: bool,
    ) -> None:
        self.decoder: Decoder | None = None
        self.device = DeviceDescription()
        self._options, self._on_event, self._has_known_baud = options, on_event, has_known_baud
        possible = [source_protocol] if source_protocol else candidates(options.protocol, options.columns)
        self._protocols = {protocol.name: protocol for protocol in possible}
        self._columns = options.columns
        self._guard = Guard(on_event)
        self._passed_over: frozenset[str] = frozenset()
        self._late = LateArrivals()
        self._detector = self._begin_detection()
        self._detects_all = len(self._protocols) > 1 and options.protocol == AUTO
        self._stream: object = None
        self._streams: dict[object, tuple[Decoder | None, Detector, LateArrivals]] = {}

    @property
    def is_behind(self) -> bool:
        """Whether the decoder has more of what it got; one of another package may not know the attribute."""
        return getattr(self.decoder, "is_behind", False)

    @property
    def is_warm(self) -> bool:
        """Whether the detection has seen a good frame."""
        return self._detector.is_warm

    @property
    def chosen_protocol(self) -> str:
        """Protocol of the options; columns mean text."""
        return self._options.protocol if self._options.columns is None else text.NAME

    def protocol_of(self, decoder: Decoder) -> WireProtocol:
        """Protocol of a decoder."""
        return self._protocols[decoder.name]

    def push(self, chunk: Any, heard_bytes: int, line: dict[str, int]) -> list[Reading]:
        """Readings of the next bytes.

        Parameters
        ----------
        heard_bytes
            Number of bytes so far, these included.
        line
            Fields of the line, for the event about the protocol.
        """
        if self.decoder is not None:
            self.decoder, readings = self._guard.push(self.protocol_of(self.decoder), self.decoder, chunk)
        else:
            detected = self._detector.push(chunk) or self._ask_plug_ins(chunk, heard_bytes)
            if detected is None:
                return []
            self.decoder, readings = detected
            self._on_event("protocol_found", protocol=self.decoder.name, **line)
        if self.decoder.device is not self.device:
            self._meet(self.decoder.device)
        if self.decoder.counters.passed_over != self._passed_over:
            self._passed_over = self.decoder.counters.passed_over
            hint = self.protocol_of(self.decoder).choice_hint
            self._on_event("talkers_passed_over", names=", ".join(sorted(self._passed_over)), hint=hint)
        return readings

    def by_arrival(self, readings: list[Reading], arrival_s: float) -> list[Arrived]:
        """Readings of a push with their arrival times; some may have waited for their scale."""
        return [] if self.decoder is None else self._late.by_arrival(self.decoder.counters, readings, arrival_s)

    def turn_to(self, stream: object) -> None:
        """Until the first sample each sender has its own decoders, so that none spoils the frames of another."""
        if stream == self._stream:
            return
        self._streams[self._stream] = self.decoder, self._detector, self._late
        if len(self._streams) > STREAMS_MAX:
            del self._streams[next(iter(self._streams))]
        self._stream = stream
        if stream in self._streams:
            self.decoder, self._detector, self._late = self._streams.pop(stream)
        else:
            self._detector, self._late = self._begin_detection(), LateArrivals()

    def keep_sender(self) -> None:
        """Forget the decoders of all other senders."""
        self._streams.clear()

    def restart_detection(self) -> None:
        """Detect again, at another baud rate."""
        self._detector = Detector(list(self._protocols.values()), self._guard)

    def renew(self) -> None:
        """Prepare for bytes after a break."""
        if self.decoder is not None:
            self.decoder = renewed(self.protocol_of(self.decoder), self.decoder)

    def follow_columns(self, columns: str | None) -> None:
        """Read text with other columns from now on, without losing a line; an event reports if that is impossible."""
        if columns == self._columns:
            return
        self._columns = columns
        if columns is None or self.decoder is None or self.decoder.name != text.NAME:
            self._on_event("columns_kept", reason="the device does not send text; restart to apply them")
            return
        protocol = text.text_protocol(columns)
        if protocol.has_clock != self._protocols[text.NAME].has_clock:
            self._on_event("columns_kept", reason="they add or remove the clock; restart to apply them")
            return
        text.read_by(self.decoder, columns)
        self._protocols = {text.NAME: protocol}

    def _begin_detection(self) -> Detector:
        """A fresh detector; the decoder itself if only one is possible."""
        self.decoder = None
        if len(self._protocols) == 1 and self._has_known_baud:
            self.decoder = next(iter(self._protocols.values())).decoder()
        return Detector(list(self._protocols.values()), self._guard)

    def _ask_plug_ins(self, chunk: bytes, heard_bytes: int) -> tuple[Decoder, list[Reading]] | None:
        """Let the protocols of plug-ins join the detection, if the bytes so far are not understood."""
        if not self._detects_all or heard_bytes < PLUG_IN_BYTES:
            return None
        self._detects_all = False
        for problem in PROTOCOLS.problems():
            self._on_event("plug_in_left_out", reason=problem)
        added = added_candidates()
        self._protocols |= {protocol.name: protocol for protocol in added}
        return self._detector.join(added, chunk)

    def _meet(self, device: DeviceDescription) -> None:
        if device != self.device and device.device_id is not None:
            self._on_event(
                "device",
                device_id=device.device_id,
                sample_rate_hz=device.sample_rate_hz,
                dps_per_lsb=device.dps_per_lsb,
                encoder_cpr=device.encoder_cpr,
                **({"device_filter": device.device_filter} if device.device_filter else {}),
            )
        self.device = device
