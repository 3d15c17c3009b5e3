"""Values of an IIO device in sysfs: rates and accelerations that are polled, and the temperature."""

import os
import time
from contextlib import suppress
from math import inf, isnan

from gyrodrift.link.port import PortGoneError
from gyrodrift.link.protocols.batch import ReadingBatch
from gyrodrift.link.sources.iio_buffer import CHANNELS, description_of, unreadable
from gyrodrift.link.sources.iio_readings import MILLI, TIMESTAMP, IioReadings
from gyrodrift.link.sources.iio_sysfs import IioDevice, explained
from gyrodrift.link.sources.source import SourcePort

POLL_HZ = 100.0
"""Usual highest rate of polling: a value takes about 0.4 ms at an I²C bus of 400 kHz, and there are six."""

TEMPERATURE_S = 10.0
"""Time between two temperatures, s: a chip warms up over minutes."""

LONGEST_NUMBER_BYTES = 32


class PolledPort(SourcePort):
    """Gyro and accelerometer whose values are read from sysfs, with the time of reading."""

    def __init__(self, path: str, gyro: IioDevice, accel: IioDevice | None, rate_hz: float) -> None:
        super().__init__(path, None)
        self.wake_s = 1.0 / rate_hz
        self._due_s = 0.0
        self._files: dict[str, int] = {}
        devices = {name: gyro if accel is None or name.startswith("anglvel") else accel for name in CHANNELS}
        present = {name: device for name, device in devices.items() if device.has_axes(*name.split("_"))}
        channels = {name: device.channel(name) for name, device in present.items()}
        description = description_of(gyro, "anglvel", channels)
        if description is None:
            raise unreadable(gyro, channels)
        self._readings = IioReadings(description)
        self._temperature = Temperature(gyro)
        try:
            for name, device in present.items():
                self._files[name] = os.open(device.folder / f"in_{name}_raw", os.O_RDONLY)
        except OSError as error:
            self.close()
            raise explained(gyro.folder, error) from error

    def read(self) -> ReadingBatch:
        """One reading if it is due."""
        batch, now_s = ReadingBatch(self._readings.device), time.monotonic()
        if now_s < self._due_s:
            return batch
        self._due_s = max(self._due_s + self.wake_s, now_s)
        begun_ns = time.monotonic_ns()
        try:
            texts = {name: os.pread(file, LONGEST_NUMBER_BYTES, 0) for name, file in self._files.items()}
            counts = {name: int(text) for name, text in texts.items()}
        except (OSError, ValueError) as error:
            raise PortGoneError(self.path) from error
        counts[TIMESTAMP] = (begun_ns + time.monotonic_ns()) // 2
        message = b" ".join(map(bytes.strip, texts.values())) + b"\n"
        batch.add(message, self._readings.reading(counts, self._temperature.now_c()))
        return batch

    def close(self) -> None:
        """Close the files."""
        for file in self._files.values():
            with suppress(OSError):
                os.close(file)
        self._files = {}


class Temperature:
    """Temperature from sysfs every `TEMPERATURE_S`, for a device without it in its scans.

    Many drivers refuse it while the buffer is on, so the first one is read before.
    """

    def __init__(self, device: IioDevice) -> None:
        self._device = device
        self._last_c = self._read_c()
        self._due_s = time.monotonic() + TEMPERATURE_S if device.has_temperature() else inf

    def now_c(self) -> float:
        """Last temperature, °C; NaN before the first one."""
        now_s = time.monotonic()
        if now_s >= self._due_s:
            self._due_s = now_s + TEMPERATURE_S
            temp_c = self._read_c()
            self._last_c = self._last_c if isnan(temp_c) else temp_c
        return self._last_c

    def _read_c(self) -> float:
        device = self._device
        milli_c = device.number("in_temp_input")
        if isnan(milli_c):
            offset = device.number("in_temp_offset", default=0.0)
            milli_c = (device.number("in_temp_raw") + offset) * device.number("in_temp_scale", default=1.0)
        return milli_c * MILLI
