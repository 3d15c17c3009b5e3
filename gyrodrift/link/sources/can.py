"""Source `can:CHANNEL`: a gyro on a CAN bus, through python-can."""

import errno
import json
import os
import socket
from collections.abc import Mapping
from contextlib import suppress
from math import degrees
from struct import Struct
from typing import TYPE_CHECKING, Any

from gyrodrift.link.port import PortGoneError
from gyrodrift.link.protocols.batch import ReadingBatch
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.link.sources.can_dbc import SIGNALS, SIGNALS_ALONE, dbc_gyro, dbc_signals
from gyrodrift.link.sources.can_frames import CAN_PROTOCOL, EXTENDED, FORCES, RATES, CanGyro, CanReadings
from gyrodrift.link.sources.source import ByteSource, SourceAddress, SourcePort
from gyrodrift.values.constants import STANDARD_GRAVITY_MPS2
from gyrodrift.values.errors import LinkError, PortMissingError, UsageError

if TYPE_CHECKING:
    import can

BOSCH_IDS = (0x174, 0x178, 0x17C)
BOSCH_FRAME = Struct("<HxxH")
BOSCH_ZERO = 0x8000
BOSCH_DPS = 0.005
BOSCH_MPS2 = 0.000127465 * STANDARD_GRAVITY_MPS2
BOSCH_FIELDS = (("gz", "ay"), ("gx", "ax"), ("gy", "az"))
"""Rate and acceleration of the three frames."""

XSENS_TIME, XSENS_COUNTER = 0x005, 0x006
XSENS_RATES, XSENS_RATES_HR, XSENS_FORCES, XSENS_FORCES_HR = 0x032, 0x040, 0x034, 0x041
XSENS_IDS = (XSENS_TIME, XSENS_COUNTER, XSENS_RATES, XSENS_FORCES, XSENS_RATES_HR, XSENS_FORCES_HR)
XSENS_TICK_US = 100
XSENS_DPS = degrees(2.0**-9)
XSENS_MPS2 = 2.0**-8
TICKS, COUNT, VECTOR = Struct(">I"), Struct(">H"), Struct(">3h")


def bosch(name: str, ids: tuple[int, ...], *, is_upside_down: bool) -> CanGyro:
    """Gyro of Bosch with the ids of its frames in the order of the data sheet."""
    has_pitch = name != "bosch-mm5.10"
    kinds = dict(zip(ids, BOSCH_FIELDS, strict=True))

    def fields(number: int, content: bytes) -> Mapping[str, float]:
        """Rate and acceleration of a frame."""
        if len(content) < BOSCH_FRAME.size:
            return {}
        rate, force = BOSCH_FRAME.unpack_from(content)
        rate_name, force_name = kinds[number]
        values = {force_name: (force - BOSCH_ZERO) * BOSCH_MPS2}
        if has_pitch or rate_name != "gy":
            values[rate_name] = (rate - BOSCH_ZERO) * BOSCH_DPS
        return values

    return CanGyro(name, frozenset(ids), fields, is_upside_down)


def xsens(name: str, ids: tuple[int, ...], *, is_upside_down: bool) -> CanGyro:
    """Gyro of Xsens; its frames have fixed ids unless its configuration changes them."""
    kinds = dict(zip(ids, XSENS_IDS, strict=True))

    def fields(number: int, content: bytes) -> Mapping[str, float]:
        """Values of a frame."""
        kind = kinds[number]
        if kind == XSENS_TIME and len(content) == TICKS.size:
            return {"t_us": TICKS.unpack(content)[0] * XSENS_TICK_US}
        if kind == XSENS_COUNTER and len(content) == COUNT.size:
            return {"seq": COUNT.unpack(content)[0]}
        if len(content) != VECTOR.size or kind in (XSENS_TIME, XSENS_COUNTER):
            return {}
        is_rate = kind in (XSENS_RATES, XSENS_RATES_HR)
        names, scale = (RATES, XSENS_DPS) if is_rate else (FORCES, XSENS_MPS2)
        return {name: value * scale for name, value in zip(names, VECTOR.unpack(content), strict=True)}

    return CanGyro(name, frozenset(ids), fields, is_upside_down)


CAN_GYROS = {
    "bosch-mm5.10": (bosch, BOSCH_IDS),
    "bosch-mm7.10": (bosch, BOSCH_IDS),
    "xsens": (xsens, XSENS_IDS),
}
"""Gyros by name, with their usual ids."""


OPTIONS = ("gyro", "dbc", "signals", *SIGNALS, "unit", "accel_unit", "ids", "z", "interface", "bitrate")
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
    """Open bus."""

    def __init__(self, path: str, bus: "can.BusABC", channel: str, gyro: CanGyro) -> None:
        super().__init__(path, _descriptor(bus))
        self._bus, self._channel, self._ids = bus, channel, gyro.ids
        self._gyro, self._readings = gyro, CanReadings(gyro)
        if self.fd is None:
            self.wake_s = POLL_S
        else:
            _enlarge_buffer(self.fd)

    def read(self) -> ReadingBatch:
        """Frames that have arrived, up to a limit, as lines of candump."""
        batch = ReadingBatch(self._readings.device)
        for _ in range(FRAMES_PER_READ):
            message = self._received()
            if message is None:
                break
            number = message.arbitration_id | (EXTENDED if message.is_extended_id else 0)
            if number in self._ids and not message.is_error_frame and not message.is_remote_frame:
                time_us, content = max(0, round(message.timestamp * 1e6)), bytes(message.data)
                if self._gyro.name == SIGNALS_ALONE:
                    batch.add(json.dumps(self._gyro.fields(number, content)).encode(), None)
                    continue
                reading = self._readings.reading(time_us, number, content)
                batch.add(self._line(message, time_us, content), reading)
        return batch

    def close(self) -> None:
        """Close the bus."""
        with suppress(Exception):  # drivers have errors of any kind for a device that is gone
            self._bus.shutdown()

    def _line(self, message: "can.Message", time_us: int, content: bytes) -> bytes:
        """Line of candump -L, which canplayer and python-can read."""
        number = f"{message.arbitration_id:0{8 if message.is_extended_id else 3}X}"
        mark = f"##{message.bitrate_switch | message.error_state_indicator << 1:X}" if message.is_fd else "#"
        return f"({time_us / 1e6:.6f}) {self._channel} {number}{mark}{content.hex().upper()}\n".encode()

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

    channel, options = address.split_query(OPTIONS)
    gyro = gyro_of(address)
    interface = options.get("interface", USUAL_INTERFACE)
    settings: dict[str, Any] = {"can_filters": _filters(gyro.ids)} if interface == USUAL_INTERFACE else {}
    if "bitrate" in options:
        settings["bitrate"] = _number(address, options["bitrate"], 1_000_000)
    try:
        bus = can.Bus(channel=channel, interface=interface, **settings)
    except Exception as error:  # drivers have errors of any kind
        raise _explained(address.text, channel, error) from error
    return CanPort(address.text, bus, channel, gyro)


def gyro_of(address: SourceAddress) -> CanGyro:
    """Gyro that the options of an address name.

    Raises
    ------
    UsageError
        The options do not name one, or have a mistake.
    """
    channel, options = address.split_query(OPTIONS)
    names = ", ".join(CAN_GYROS)
    if channel and {"dbc", "signals"} <= options.keys():
        return dbc_signals(address.text, options)
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
    """Protocol of an address, after the check of its gyro."""
    gyro_of(address)
    return CAN_PROTOCOL


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
