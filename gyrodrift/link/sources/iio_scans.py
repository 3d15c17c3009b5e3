"""Decoder of the packets of an IIO device: descriptions, scans of the gyro and of the accelerometer, temperatures.

Gyro and accelerometer may be two IIO devices, as with the LSM6DS family. The timestamps of the kernel join
their scans.
"""

from collections import deque
from enum import IntEnum
from math import degrees, isfinite, nan
from struct import Struct

from gyrodrift.link.protocols.decoder import DeviceDescription
from gyrodrift.link.protocols.lines import MAX_RATE_DPS
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.link.sources.iio_layout import IioLayout, described
from gyrodrift.link.sources.packets import PacketDecoder
from gyrodrift.values.sample import Inertial, Reading
from gyrodrift.values.vectors import Vector

CLOCK_MASK = 0xFFFFFFFF
MILLI = 1e-3
TEMPERATURE = Struct("<f")

JOIN_NS = 50_000_000
"""Longest time between a rate and its acceleration, ns: half a period at the usual minimum of 12.5 Hz."""

MOST_FORCES = 64
MAX_FORCE_MPS2 = 1e4
"""Several times the range of accelerometers on the market; a larger number is an impossible scale."""


class IioPacket(IntEnum):
    """Kinds of packets."""

    GYRO_LAYOUT = 1
    ACCEL_LAYOUT = 2
    GYRO_SCAN = 3
    ACCEL_SCAN = 4
    TEMPERATURE = 5


LAYOUTS = (IioPacket.GYRO_LAYOUT, IioPacket.ACCEL_LAYOUT)


class IioDecoder(PacketDecoder):
    """Decoder that knows the layouts from the stream."""

    name = "iio"

    def __init__(self) -> None:
        super().__init__()
        self._gyro: IioLayout | None = None
        self._accel: IioLayout | None = None
        self._forces: deque[tuple[int, Vector]] = deque(maxlen=MOST_FORCES)
        self._temp_c = nan

    def is_valid(self, kind: int, content: bytes) -> bool:
        """Whether a description can be read, and a scan has the length of its layout, if that is known."""
        match kind:
            case IioPacket.GYRO_LAYOUT | IioPacket.ACCEL_LAYOUT:
                return described(content) is not None
            case IioPacket.GYRO_SCAN:
                return self._gyro is None or len(content) == self._gyro.size
            case IioPacket.ACCEL_SCAN:
                return self._accel is None or len(content) == self._accel.size
        return kind == IioPacket.TEMPERATURE and len(content) == TEMPERATURE.size

    def read(self, frame: bytes) -> Reading | None:
        """Reading of a scan of the gyro."""
        kind, content = frame[2], frame[5:]
        match kind:
            case IioPacket.GYRO_SCAN:
                return None if self._gyro is None else self._measured(self._gyro, content)
            case IioPacket.ACCEL_SCAN:
                self._keep_forces(content)
            case IioPacket.TEMPERATURE:
                (temp_c,) = TEMPERATURE.unpack(content)
                self._temp_c = temp_c if isfinite(temp_c) else nan
            case IioPacket.GYRO_LAYOUT:
                self._gyro = described(content)
                self._describe()
            case IioPacket.ACCEL_LAYOUT:
                self._accel = described(content)
        return None

    def _describe(self) -> None:
        layout = self._gyro
        if layout is not None and "anglvel_z" in layout.channels:
            scale = degrees(layout.channels["anglvel_z"].scale)
            axes = 3 if "anglvel_x" in layout.channels else 1
            self.device = DeviceDescription(layout.name, layout.rate_hz or None, scale, axes=axes)

    def _measured(self, layout: IioLayout, scan: bytes) -> Reading | None:
        z = layout.channels.get("anglvel_z")
        if z is None:
            return None
        t_ns = _time_ns(layout, scan)
        temp = layout.channels.get("temp")
        if temp is not None:
            temp_c = temp.value(scan) * MILLI
            self._temp_c = temp_c if isfinite(temp_c) else nan
        rates = layout.vector(scan, "anglvel")
        rates_dps = (degrees(z.value(scan)),) if rates is None else tuple(map(degrees, rates))
        if not all(abs(rate_dps) <= MAX_RATE_DPS for rate_dps in rates_dps):
            return None
        forces = layout.vector(scan, "accel") or self._force_at(t_ns)
        is_plausible = forces is not None and all(abs(force) <= MAX_FORCE_MPS2 for force in forces)
        inertial = None if rates is None else Inertial(*rates_dps, *(forces if forces and is_plausible else ()))
        t_us = None if t_ns is None else t_ns // 1000 & CLOCK_MASK
        return Reading(t_us, None, rates_dps[-1], temp_c=self._temp_c, inertial=inertial)

    def _keep_forces(self, scan: bytes) -> None:
        if self._accel is not None:
            forces, t_ns = self._accel.vector(scan, "accel"), _time_ns(self._accel, scan)
            if forces is not None and t_ns is not None:
                self._forces.append((t_ns, forces))

    def _force_at(self, t_ns: int | None) -> Vector | None:
        """Acceleration of the scan that is nearest in time; None without a near one."""
        if t_ns is None or not self._forces:
            return None
        force_ns, forces = min(self._forces, key=lambda entry: abs(entry[0] - t_ns))
        return forces if abs(force_ns - t_ns) <= JOIN_NS else None


def _time_ns(layout: IioLayout, scan: bytes) -> int | None:
    channel = layout.channels.get("timestamp")
    return None if channel is None else channel.raw(scan)


IIO_PROTOCOL = WireProtocol(
    "iio",
    "scans of a Linux IIO device",
    IioDecoder,
    has_clock=True,
    rank=4,
    is_detected=False,
    has_unit=True,
)
