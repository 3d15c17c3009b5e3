"""Source `can:CHANNEL`: a gyro on a CAN bus, through python-can."""

import errno
import os
import socket
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from gyrodrift.link.port import PortGoneError
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.link.sources.can_dbc import SIGNALS, dbc_gyro
from gyrodrift.link.sources.can_frames import EXTENDED, FRAME, FRAME_HEADER, CanGyro, can_protocol
from gyrodrift.link.sources.can_gyros import CAN_GYROS
from gyrodrift.link.sources.packets import packet
from gyrodrift.link.sources.query import split_query
from gyrodrift.link.sources.source import ByteSource, SourceAddress, SourcePort
from gyrodrift.values.errors import LinkError, PortMissingError, UsageError

if TYPE_CHECKING:
    import can

OPTIONS = ("gyro", "dbc", *SIGNALS, "unit", "accel_unit", "ids", "z", "interface", "bitrate")
USUAL_INTERFACE = "socketcan"

FRAMES_PER_READ = 512
"""Largest number of frames at a time, so that a flood does not block the loop: 60 ms of a full bus at 1 Mbit/s."""

POLL_S = 0.005
"""Time between two reads of an interface without a descriptor, s."""

BUFFER_BYTES = 1 << 21
"""Wanted size of the receive buffer; a frame takes almost 1 kB of it. Without privileges the kernel gives less."""

FORCED_BUFFER = getattr(socket, "SO_RCVBUFFORCE", 33)
"""Option of Linux for privileged users, which exceeds `net.core.rmem_max` (socket(7)); Python has no name for it."""

ABSENT = frozenset({errno.ENODEV, errno.ENETDOWN, errno.ENOENT, errno.ENXIO})
LONGEST_ID = (1 << 29) - 1
LONGEST_BASE_ID = (1 << 11) - 1


class CanPort(SourcePort):
    """Open bus; its frames become packets with the time of reception."""

    def __init__(self, path: str, bus: "can.BusABC", ids: frozenset[int]) -> None:
        super().__init__(path, _descriptor(bus))
        self._bus = bus
        self._ids = ids
        if self.fd is None:
            self.wake_s = POLL_S
        else:
            _enlarge_buffer(self.fd)

    def read(self) -> bytes:
        """Packets of the frames that have arrived, up to a limit."""
        packets: list[bytes] = []
        for _ in range(FRAMES_PER_READ):
            message = self._received()
            if message is None:
                break
            number = message.arbitration_id | (EXTENDED if message.is_extended_id else 0)
            if number in self._ids and not message.is_error_frame and not message.is_remote_frame:
                time_us = max(0, round(message.timestamp * 1e6))
                packets.append(packet(FRAME, FRAME_HEADER.pack(time_us, number) + bytes(message.data)))
        return b"".join(packets)

    def close(self) -> None:
        """Close the bus."""
        with suppress(Exception):  # drivers have errors of any kind for a device that is gone
            self._bus.shutdown()

    def _received(self) -> "can.Message | None":
        try:
            return self._bus.recv(0.0)
        except Exception as error:  # as above
            raise PortGoneError(self.path) from error


def open_can(address: SourceAddress) -> CanPort:
    """Open the bus for the frames of the gyro.

    Raises
    ------
    UsageError
        The address has a mistake.
    LinkError
        The bus cannot be opened; the message says why.
    """
    import can

    channel, options = split_query(address, OPTIONS)
    ids = gyro_of(address).ids
    interface = options.get("interface", USUAL_INTERFACE)
    settings: dict[str, Any] = {"can_filters": _filters(ids)} if interface == USUAL_INTERFACE else {}
    if "bitrate" in options:
        settings["bitrate"] = _number(address, options["bitrate"], 1_000_000)
    try:
        bus = can.Bus(channel=channel, interface=interface, **settings)
    except Exception as error:  # drivers have errors of any kind
        raise _explained(address.text, channel, error) from error
    return CanPort(address.text, bus, ids)


def gyro_of(address: SourceAddress) -> CanGyro:
    """Gyro that the options of an address name.

    Raises
    ------
    UsageError
        The options do not name one, or have a mistake.
    """
    channel, options = split_query(address, OPTIONS)
    names = ", ".join(CAN_GYROS)
    if not channel or ("gyro" in options) == ("dbc" in options) or ("dbc" in options) != ("signal" in options):
        raise UsageError(
            f"--port {address.text}: expected can:CHANNEL?dbc=FILE&signal=NAME, or can:CHANNEL?gyro=NAME with {names}"
        )
    if options.get("z", "up") not in ("up", "down"):
        raise UsageError(f"--port {address.text}: z={options['z']} is unknown; expected z=up or z=down")
    is_upside_down = options.get("z") == "down"
    if "dbc" in options:
        return dbc_gyro(address.text, options, is_upside_down=is_upside_down)
    if options["gyro"] not in CAN_GYROS:
        raise UsageError(f"--port {address.text}: gyro={options['gyro']} is unknown; there are {names}")
    make, usual_ids = CAN_GYROS[options["gyro"]]
    return make(options["gyro"], _ids(address, options.get("ids"), usual_ids), is_upside_down=is_upside_down)


def protocol_of(address: SourceAddress) -> WireProtocol:
    """Protocol of the gyro of an address."""
    return can_protocol(gyro_of(address))


def _ids(address: SourceAddress, text: str | None, usual: tuple[int, ...]) -> tuple[int, ...]:
    """Ids of the frames; `ids=0x70,0x80,0x576` replaces the usual ones."""
    if text is None:
        return usual
    numbers = [_number(address, word, LONGEST_ID) for word in text.split(",")]
    ids = tuple(number | (EXTENDED if number > LONGEST_BASE_ID else 0) for number in numbers)
    if len(set(ids)) != len(usual):
        raise UsageError(f"--port {address.text}: ids={text} has not {len(usual)} different ids")
    return ids


def _number(address: SourceAddress, word: str, largest: int) -> int:
    try:
        number = int(word[:12], 0)
    except ValueError:
        number = -1
    if not 0 <= number <= largest:
        raise UsageError(f"--port {address.text}: {word!r} is no number from 0 to {largest:#x}")
    return number


def _filters(ids: frozenset[int]) -> list[dict[str, Any]]:
    """Filters for the kernel, so that a busy bus costs little.

    Other interfaces filter in python-can, where a frame of another device looks like the end of the waiting frames.
    """
    return [
        {"can_id": number & ~EXTENDED, "can_mask": LONGEST_ID, "extended": bool(number & EXTENDED)}
        for number in sorted(ids)
    ]


def _descriptor(bus: "can.BusABC") -> int | None:
    """Descriptor to wait on; None for an interface without one, or for other systems than Linux and macOS."""
    if os.name != "posix":
        return None
    try:
        fd = bus.fileno()
    except Exception:  # noqa: BLE001 - NotImplementedError, or an error of a driver
        return None
    return fd if isinstance(fd, int) and fd >= 0 else None


def _enlarge_buffer(fd: int) -> None:
    """Ask for a larger buffer; the usual one holds some hundred frames, 0.1 s of a gyro with four frames at 400 Hz."""
    for option in (FORCED_BUFFER, socket.SO_RCVBUF):
        with suppress(OSError), socket.socket(fileno=os.dup(fd)) as connection:
            connection.setsockopt(socket.SOL_SOCKET, option, BUFFER_BYTES)
            return


def _explained(text: str, channel: str, error: Exception) -> LinkError:
    number = getattr(error, "errno", None) or getattr(error, "error_code", None)
    if number in ABSENT:
        return PortMissingError(
            f"{text}: there is no CAN channel {channel}: {error}; list them with 'ip -brief link', and turn one on "
            f"with 'sudo ip link set {channel} up type can bitrate 500000'"
        )
    if number == errno.EAFNOSUPPORT:
        return LinkError(f"{text}: this kernel has no CAN: {error}; load it with 'sudo modprobe can_raw'")
    return LinkError(f"{text}: the CAN bus cannot be opened: {error}; check interface= and the adapter")


CAN = ByteSource(
    "can",
    "can:CHANNEL",
    "gyro on a CAN bus, by a DBC file or by its name",
    open_can,
    protocol_of=protocol_of,
    packages=("can", "cantools"),
    extra="can",
    unit=("RestrictAddressFamilies=AF_CAN",),
    silence="no frame with its ids arrives; check the bit rate, the termination, and the ids with candump",
)
