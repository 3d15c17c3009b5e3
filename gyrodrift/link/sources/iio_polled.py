"""Values of an IIO device in sysfs: rates and accelerations that are polled, and the temperature."""

import os
import time
from contextlib import suppress
from math import isnan
from struct import pack

from gyrodrift.link.port import PortGoneError
from gyrodrift.link.sources.iio_buffer import CHANNELS, scan_layout
from gyrodrift.link.sources.iio_layout import ChannelEntry, description
from gyrodrift.link.sources.iio_scans import MILLI, TEMPERATURE, IioPacket
from gyrodrift.link.sources.iio_sysfs import TIMESTAMP, IioDevice, explained
from gyrodrift.link.sources.packets import packet
from gyrodrift.link.sources.source import SourcePort

POLL_HZ = 100.0
"""Usual highest rate of polling: a value takes about 0.4 ms at an I²C bus of 400 kHz, and there are six."""

DESCRIBE_S = 1.0
"""Time between two descriptions, s, as devices of the native protocol send them."""

TEMPERATURE_S = 10.0
"""Time between two temperatures, s: a chip warms up over minutes."""

POLLED_TYPE = "le:s32/32>>0"
CLOCK_TYPE = "le:s64/64>>0"
LONGEST_NUMBER_BYTES = 32


class Repeated:
    """Description that is sent again: an open port may get a new decoder, as after `--port auto`."""

    def __init__(self, content: bytes) -> None:
        self._content = content
        self._due_s = 0.0

    def due(self) -> bytes:
        """Description if it is due; else empty."""
        now_s = time.monotonic()
        if now_s < self._due_s:
            return b""
        self._due_s = now_s + DESCRIBE_S
        return self._content


class PolledPort(SourcePort):
    """Gyro and accelerometer whose values are read from sysfs, with the time of reading."""

    def __init__(self, path: str, gyro: IioDevice, accel: IioDevice | None, rate_hz: float) -> None:
        super().__init__(path, None)
        self.wake_s = 1.0 / rate_hz
        self._due_s = 0.0
        self._files: list[int] = []
        self._temperature = Temperature(gyro)
        devices = [gyro if accel is None or kind == "anglvel" else accel for kind, _ in CHANNELS]
        present = [
            (device, kind, axis)
            for device, (kind, axis) in zip(devices, CHANNELS, strict=True)
            if device.has_axes(kind, axis)
        ]
        self._entries = [device.channel(kind, axis, POLLED_TYPE) for device, kind, axis in present]
        self._entries.append(ChannelEntry(TIMESTAMP, CLOCK_TYPE))
        layout = scan_layout(gyro, "anglvel", self._entries)
        try:
            for device, kind, axis in present:
                self._files.append(os.open(device.folder / f"in_{kind}_{axis}_raw", os.O_RDONLY))
        except OSError as error:
            self.close()
            raise explained(gyro.folder, error) from error
        self._padding = bytes(-4 * len(self._files) % 8)
        self._layout = Repeated(packet(IioPacket.GYRO_LAYOUT, description(layout, self._entries)))

    def read(self) -> bytes:
        """One packet if it is due."""
        now_s = time.monotonic()
        if now_s < self._due_s:
            return b""
        self._due_s = max(self._due_s + self.wake_s, now_s)
        begun_ns = time.monotonic_ns()
        try:
            raw = [int(os.pread(file, LONGEST_NUMBER_BYTES, 0)) for file in self._files]
        except (OSError, ValueError) as error:
            raise PortGoneError(self.path) from error
        middle_ns = (begun_ns + time.monotonic_ns()) // 2
        counts = (max(-(1 << 31), min(count, (1 << 31) - 1)) for count in raw)
        scan = pack(f"<{len(raw)}i", *counts) + self._padding + pack("<q", middle_ns)
        return self._layout.due() + self._temperature.packet() + packet(IioPacket.GYRO_SCAN, scan)

    def close(self) -> None:
        """Close the files."""
        for file in self._files:
            with suppress(OSError):
                os.close(file)
        self._files = []


class Temperature:
    """Temperature from sysfs every `TEMPERATURE_S`, for a device without it in its scans.

    Many drivers refuse it while the buffer is on, so the first one is read before.
    """

    def __init__(self, device: IioDevice) -> None:
        self._device = device
        self._first = self._read()
        self._due_s = time.monotonic() + TEMPERATURE_S if device.has_temperature() else float("inf")

    def packet(self) -> bytes:
        """Packet with a temperature that is due; empty without one."""
        if self._first:
            content, self._first = self._first, b""
            return content
        now_s = time.monotonic()
        if now_s < self._due_s:
            return b""
        self._due_s = now_s + TEMPERATURE_S
        return self._read()

    def _read(self) -> bytes:
        device = self._device
        milli_c = device.number("in_temp_input")
        if isnan(milli_c):
            offset = device.number("in_temp_offset", default=0.0)
            milli_c = (device.number("in_temp_raw") + offset) * device.number("in_temp_scale", default=1.0)
        return b"" if isnan(milli_c) else packet(IioPacket.TEMPERATURE, TEMPERATURE.pack(milli_c * MILLI))
