"""Source `mavlink:CONNECTION`: the gyro of an autopilot, over UDP, TCP or a serial line."""

import re

from gyrodrift.link.port import HAS_TERMIOS, Port
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.link.sources.mavlink_frames import (
    DPS_PER_MRADS,
    MESSAGES,
    MPS2_PER_MG,
    ImuChoice,
    mavlink_protocol,
)
from gyrodrift.link.sources.query import split_query
from gyrodrift.link.sources.sockets import SocketPort, connected
from gyrodrift.link.sources.source import ByteSource, OpenPort, SourceAddress
from gyrodrift.link.sources.udp import UdpPort, bound_socket
from gyrodrift.values.errors import UsageError

USUAL_BAUD = 57600
"""Default of `SERIAL1_BAUD` of ArduPilot and of telemetry radios; USB ignores it."""

OPTIONS = ("system", "message", "raw")
NETWORK = re.compile(r"(udpin|udp|tcp):(.*)")
SERIAL = re.compile(r"(.+?)(?:,(\d{1,7}))?")
SYSTEM = re.compile(r"[0-9]{1,3}")
COUNTS = re.compile(r"lsb/(\d{1,9}(?:\.\d{1,9})?)")


class FramesPort(UdpPort):
    """Bound datagram socket whose datagrams are frames, never text."""

    def _as_stream(self, content: bytes) -> bytes:
        return content


def open_mavlink(address: SourceAddress) -> OpenPort:
    """Listen, connect, or open the serial line.

    Raises
    ------
    UsageError
        The address has a mistake.
    LinkError
        The connection cannot be opened; the message says why.
    """
    rest, _ = split_query(address, OPTIONS)
    network = NETWORK.fullmatch(rest)
    if network is None:
        return _open_line(address, rest)
    part = SourceAddress(address.text, f"mavlink:{network[1]}", network[2])
    if network[1] == "tcp":
        return SocketPort(address.text, connected(part))
    return FramesPort(address.text, bound_socket(part))


def protocol_of(address: SourceAddress) -> WireProtocol:
    """Protocol with the vehicle, the message and the unit of the address.

    Raises
    ------
    UsageError
        An option has a mistake.
    """
    _, options = split_query(address, OPTIONS)
    system, message, raw = (options.get(name) for name in OPTIONS)
    if system is not None and (SYSTEM.fullmatch(system) is None or not 0 < int(system) <= 0xFF):
        raise UsageError(f"--port {address.text}: system={system} is no number from 1 to 255")
    names = [entry.name for entry in MESSAGES.values()]
    if message is not None and message.lower() not in names:
        raise UsageError(f"--port {address.text}: message={message} has no gyro; there are {', '.join(names)}")
    scales = _raw_scales(address, raw) if raw is not None else (None, None)
    number = None if system is None else int(system)
    return mavlink_protocol(ImuChoice(number, None if message is None else message.lower(), *scales))


def _raw_scales(address: SourceAddress, raw: str) -> tuple[float, float | None]:
    """Scales of the rates and accelerations of RAW_IMU."""
    if raw == "mrads":
        return DPS_PER_MRADS, MPS2_PER_MG
    counts = COUNTS.fullmatch(raw)
    if counts is None or not float(counts[1]):
        raise UsageError(
            f"--port {address.text}: raw={raw} is no unit of RAW_IMU; expected mrads (mrad/s and mg, as in ArduPilot)"
            " or lsb/N (N counts per deg/s)"
        )
    return 1.0 / float(counts[1]), None


def _open_line(address: SourceAddress, rest: str) -> OpenPort:
    line = SERIAL.fullmatch(rest)
    if line is None or line[1].isalpha():
        raise UsageError(
            f"--port {address.text}: expected mavlink:udpin:[HOST]:PORT, mavlink:tcp:HOST:PORT or mavlink:PATH[,BAUD]"
        )
    baud = int(line[2] or USUAL_BAUD)
    if HAS_TERMIOS:
        return Port(line[1], baud)
    from gyrodrift.link.thread_port import ThreadPort

    return ThreadPort(line[1], baud)


MAVLINK = ByteSource(
    "mavlink",
    "mavlink:CONNECTION",
    "the gyro of an autopilot: udpin:[HOST]:PORT, tcp:HOST:PORT or PATH[,BAUD]",
    open_mavlink,
    protocol_of=protocol_of,
    silence="check that the vehicle sends MAVLink to this machine and port; udpin:0.0.0.0:PORT listens on all networks",
)
