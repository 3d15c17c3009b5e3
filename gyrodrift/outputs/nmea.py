"""NMEA 0183 sentences over TCP, UDP or a pty: HDT once a heading was set, ROT, and XDR for temperature and attitude.

ROT is in degrees per minute, negative when the bow turns to port. Pitch is positive with the bow up, roll with the
starboard side down.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isnan
from pathlib import Path
from typing import Annotated, Literal

from annotated_types import MaxLen

from gyrodrift.outputs.line_output import runtime_folder
from gyrodrift.outputs.net.addresses import DatagramSender
from gyrodrift.outputs.net.lines import LineServer, LineSession
from gyrodrift.outputs.net.pty import PtyWriter
from gyrodrift.outputs.net.servers import ServerOutput
from gyrodrift.outputs.options import LOOPBACK, About, Host, Port, Rate
from gyrodrift.outputs.output import OutputHost
from gyrodrift.outputs.thinning import Thinning
from gyrodrift.values.sample import Corrected

NAME = "gyrodrift.nmea"

TALKER = "II"
"""Talker of integrated instrumentation: gpsd 3.22 does not take HE or HN, the talkers of a gyro compass."""


@dataclass(frozen=True, slots=True)
class NmeaOptions:
    """Transport, address and rate."""

    to: Annotated[
        Literal["tcp", "udp", "pty"],
        About("tcp listens on host and port, udp sends there, pty makes a serial port at path"),
    ] = "tcp"
    host: Annotated[Host, About("address to listen on, or the receiver")] = LOOPBACK
    port: Annotated[Port, About("port to listen on or to send to; 0 takes a free one to listen on")] = 10110
    path: Annotated[str, MaxLen(4096), About(f"link to the pty; {NAME} in the runtime directory if empty")] = ""
    rate_hz: Annotated[Rate, About("at most this many sentences of each kind a second of device time")] = 10.0


class NmeaOutput(ServerOutput[NmeaOptions, "LineServer[NmeaSession]"]):
    """Sends up to four sentences per sample."""

    options_type = NmeaOptions

    def __init__(self, options: NmeaOptions, host: OutputHost) -> None:
        super().__init__(options, host)
        self._thinning = Thinning(options.rate_hz)
        self.server = LineServer(lambda _: NmeaSession(), host.log)
        self._datagrams = DatagramSender()
        self._pty = PtyWriter()

    async def open(self) -> None:
        """Listen, resolve the receiver, or make the pty."""
        options = self.options
        if options.to == "tcp":
            self.address = await self.server.listen_tcp(options.host, options.port)
        elif options.to == "udp":
            self.address = await self._datagrams.open(options.host, options.port)
        else:
            self.address = self._pty.open(Path(options.path) if options.path else runtime_folder() / NAME)

    def take(self, samples: Sequence[Corrected]) -> None:
        """Send the sentences of samples that are due."""
        for sample in self._thinning.due(samples):
            lines = sentences(sample)
            for sentence in lines:
                self._datagrams.send(sentence)
            self._pty.send(b"".join(lines), len(lines))
            for client in self.server.clients:
                client.send(b"".join(lines), len(lines))

    def counts(self) -> tuple[int, int]:
        """Sentences sent and dropped."""
        sent, dropped = super().counts()
        writers = (self._datagrams, self._pty)
        return sent + sum(writer.sent for writer in writers), dropped + sum(writer.dropped for writer in writers)

    async def close(self) -> None:
        """Close the server, the socket and the pty."""
        await super().close()
        self._datagrams.close()
        self._pty.close()


class NmeaSession(LineSession):
    """One client; its lines, such as broadcasts of a chart plotter, are ignored."""

    def dropped(self, messages: int) -> bytes:
        """Text sentence for a client that was too slow."""
        return _sentence("TXT", "01", "01", "02", f"{messages} sentences dropped")

    def refused(self, why: str) -> bytes:
        """Text sentence for a client whose connection is closed."""
        return _sentence("TXT", "01", "01", "02", why)


def sentences(sample: Corrected) -> list[bytes]:
    """HDT, ROT and XDR of a sample, without unknown values.

    Pitch and roll have the transducer names that chart plotters know.
    """
    lines = [_sentence("ROT", f"{-60.0 * sample.corrected_dps:.1f}", "A")]
    if not isnan(sample.heading_deg):
        lines.insert(0, _sentence("HDT", f"{round(sample.heading_deg, 2) % 360.0:.2f}", "T"))
    if sample.attitude is not None and not isnan(sample.attitude.roll_deg + sample.attitude.pitch_deg):
        pitch, roll = (f"{angle_deg:z.2f}" for angle_deg in (-sample.attitude.pitch_deg, sample.attitude.roll_deg))
        lines.append(_sentence("XDR", "A", pitch, "D", "PTCH", "A", roll, "D", "ROLL"))
    if not isnan(sample.sample.temp_c):
        lines.append(_sentence("XDR", "C", f"{sample.sample.temp_c:.2f}", "C", "GYRO"))
    return lines


def _sentence(kind: str, *fields: str) -> bytes:
    from pynmeagps import GET, NMEAMessage

    encoded: bytes = NMEAMessage(TALKER, kind, GET, payload=list(fields)).serialize()
    return encoded
