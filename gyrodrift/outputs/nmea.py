"""NMEA 0183 sentences: HDT once a reference was given, ROT, and XDR for temperature; over TCP, UDP or a pty.

ROT is in degrees per minute, minus where the bow turns to port.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isnan
from pathlib import Path
from typing import Annotated, Literal

from annotated_types import MaxLen

from gyrodrift.outputs.net.datagrams import DatagramSender
from gyrodrift.outputs.net.lines import LineClient, LineServer
from gyrodrift.outputs.net.pty import PtyWriter
from gyrodrift.outputs.options import LOOPBACK, About, Host, Port, Rate
from gyrodrift.outputs.output import Output, OutputHost
from gyrodrift.outputs.status import ClientStatus
from gyrodrift.outputs.thinning import Thinning
from gyrodrift.outputs.unix import runtime_folder
from gyrodrift.sample import Corrected

NAME = "gyrodrift.nmea"

TALKER = "II"
"""Integrated instrumentation: gpsd 3.22 does not take HE or HN, which a gyro compass has."""


@dataclass(frozen=True, slots=True)
class NmeaOptions:
    """Over what, where, and how often."""

    to: Annotated[
        Literal["tcp", "udp", "pty"],
        About("tcp listens on host and port, udp sends there, pty makes a serial port at path"),
    ] = "tcp"
    host: Annotated[Host, About("address to listen on, or who receives")] = LOOPBACK
    port: Annotated[Port, About("port to listen on or to send to; 0 takes a free one to listen on")] = 10110
    path: Annotated[str, MaxLen(4096), About(f"link to the pty; {NAME} in the runtime directory where empty")] = ""
    rate_hz: Annotated[Rate, About("at most so many sentences of each kind a second of device time")] = 10.0


class NmeaOutput(Output[NmeaOptions]):
    """Up to three sentences a sample."""

    options_type = NmeaOptions

    def __init__(self, options: NmeaOptions, host: OutputHost) -> None:
        super().__init__(options, host)
        self._thinning = Thinning(options.rate_hz)
        self._server = LineServer(NmeaSession, host.log)
        self._datagrams = DatagramSender()
        self._pty = PtyWriter()

    async def open(self) -> None:
        """Begin to listen, look the receiver up, or make the pty."""
        options = self.options
        if options.to == "tcp":
            self.address = await self._server.listen_tcp(options.host, options.port)
        elif options.to == "udp":
            self.address = await self._datagrams.open(options.host, options.port)
        else:
            self.address = self._pty.open(Path(options.path) if options.path else runtime_folder() / NAME)

    def take(self, samples: Sequence[Corrected]) -> None:
        """Send the sentences of what is due."""
        for each in self._thinning.due(samples):
            said = sentences(each)
            for sentence in said:
                self._datagrams.send(sentence)
            self._pty.send(b"".join(said), len(said))
            for client in self._server.clients:
                client.send(b"".join(said), len(said))

    def clients(self) -> Sequence[ClientStatus]:
        """Who is connected over TCP."""
        return self._server.statuses()

    def counts(self) -> tuple[int, int]:
        """Sentences."""
        sent, dropped = self._server.counts()
        others = (self._datagrams, self._pty)
        return sent + sum(each.sent for each in others), dropped + sum(each.dropped for each in others)

    async def close(self) -> None:
        """Let go of what was opened."""
        await self._server.close()
        self._datagrams.close()
        self._pty.close()


class NmeaSession:
    """One client; NMEA 0183 has no words for anything but sentences."""

    def __init__(self, client: LineClient) -> None:
        pass

    def line(self, text: bytes) -> None:
        """Nothing is asked for over NMEA 0183; what a chart plotter sends to all is passed by."""

    def dropped(self, messages: int) -> bytes:
        """A text sentence, for a client that was too slow."""
        return _sentence("TXT", "01", "01", "02", f"{messages} sentences dropped")

    def refused(self, why: str) -> bytes:
        """A text sentence, for a client whose connection is closed from here."""
        return _sentence("TXT", "01", "01", "02", why)

    def closed(self) -> None:
        """Nothing is kept."""


def sentences(sample: Corrected) -> list[bytes]:
    """HDT, ROT and XDR of a sample; what is not known is left out."""
    said = [_sentence("ROT", f"{-60.0 * sample.corrected_dps:.1f}", "A")]
    if not isnan(sample.heading_deg):
        said.insert(0, _sentence("HDT", f"{round(sample.heading_deg, 2) % 360.0:.2f}", "T"))
    if not isnan(sample.sample.temp_c):
        said.append(_sentence("XDR", "C", f"{sample.sample.temp_c:.2f}", "C", "GYRO"))
    return said


def _sentence(kind: str, *fields: str) -> bytes:
    from pynmeagps import GET, NMEAMessage

    encoded: bytes = NMEAMessage(TALKER, kind, GET, payload=list(fields)).serialize()
    return encoded
