"""Source `iio:NAME`: gyro and accelerometer with a Linux driver, such as an MPU-6050 at the I²C bus of a Raspberry Pi.

Scans come through the buffer of the kernel with its timestamps, by a trigger or the FIFO of the chip. Without buffer or
trigger, the values in sysfs are polled.
"""

import os
import time
from contextlib import suppress
from math import inf, isnan

from gyrodrift.link.port import PortGoneError
from gyrodrift.link.protocols.batch import ReadingBatch, batch_protocol
from gyrodrift.link.serial_port import SerialPort
from gyrodrift.link.sources import iio_sysfs
from gyrodrift.link.sources.iio_buffer import CHANNELS, Scans, description_of, elements_folder, unreadable
from gyrodrift.link.sources.iio_readings import MILLI, TIMESTAMP, IioReadings
from gyrodrift.link.sources.iio_sysfs import NUMBER, IioDevice, accelerometer_of, device_named, explained, iio_devices
from gyrodrift.link.sources.source import ByteSource, SourceAddress, SourcePort
from gyrodrift.values.errors import LinkError, PortDeniedError, PortMissingError, UsageError

POLL_HZ = 100.0
"""Usual highest rate of polling: a value takes about 0.4 ms at an I²C bus of 400 kHz, and there are six."""

TEMPERATURE_S = 10.0
"""Time between two temperatures, s: a chip warms up over minutes."""

LONGEST_NUMBER_BYTES = 32

OPTIONS = ("accel", "rate", "trigger", "poll")

FASTEST_POLL_HZ = 1000
"""Highest rate of `poll=`; faster chips need the buffer."""


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


class IioPort(SourcePort):
    """Buffered gyro, and the accelerometer of the same chip."""

    def __init__(self, path: str, gyro: Scans, accel: Scans | None, temperature: Temperature) -> None:
        super().__init__(path, gyro.fd)
        self._gyro, self._accel, self._temperature = gyro, accel, temperature
        self._readings = IioReadings(gyro.description, None if accel is None else accel.description)

    def read(self) -> ReadingBatch:
        """Scans that have arrived, accelerations first."""
        batch, temp_c = ReadingBatch(self._readings.device), self._temperature.now_c()
        if self._accel is not None:
            for scan in self._accel.read(self.path):
                self._readings.keep_forces(self._accel.layout.counts(scan))
                batch.add(scan, None)
        for scan in self._gyro.read(self.path):
            batch.add(scan, self._readings.reading(self._gyro.layout.counts(scan), temp_c))
        return batch

    def close(self) -> None:
        """Stop the buffers."""
        self._gyro.close()
        if self._accel is not None:
            self._accel.close()


def open_iio(address: SourceAddress) -> SourcePort:
    """Open the buffers of a device, or poll it.

    Raises
    ------
    UsageError
        An option has a mistake.
    LinkError
        There is no such device, or it cannot be opened; the message says why.
    """
    name, options = address.split_query(OPTIONS)
    gyro = device_named(name, "anglvel", address.text)
    gyro.check_scale("anglvel", address.text)
    accel = _accelerometer(gyro, options.get("accel"), address.text)
    if "rate" in options:
        _set_rate(gyro, options["rate"], address.text)
        if accel is not None:
            accel.try_to_write("sampling_frequency", options["rate"])
    poll_hz = _poll_hz(gyro, options.get("poll"), address.text)
    reason = "poll=" if "poll" in options else _why_polled(gyro, options.get("trigger"), address.text)
    port = _buffered(address.text, gyro, accel) if not reason else PolledPort(address.text, gyro, accel, poll_hz)
    if reason:
        port.note("iio_polled", reason=reason)
    if gyro.matrix("anglvel") is None:
        port.note("mount_matrix_ignored", reason="it is no rotation; correct it in the device tree, or use mount:")
    return port


def _accelerometer(gyro: IioDevice, name: str | None, text: str) -> IioDevice | None:
    """Other IIO device with the accelerations; None if the gyro has them, or nobody."""
    if name == "none" or (name is None and gyro.has_axes("accel", "xyz")) or not gyro.has_axes("anglvel", "xyz"):
        return None
    return device_named(name, "accel", text) if name is not None else accelerometer_of(gyro)


def _buffered(text: str, gyro: IioDevice, accel: IioDevice | None) -> IioPort:
    temperature = Temperature(gyro)
    rates = Scans(gyro, ("anglvel", "accel") if accel is None else ("anglvel",))
    try:
        is_buffered = accel is not None and not _why_polled(accel, None, text)
        return IioPort(text, rates, Scans(accel, ("accel",)) if accel and is_buffered else None, temperature)
    except LinkError:
        rates.close()
        raise


def _poll_hz(gyro: IioDevice, text: str | None, address: str) -> float:
    """Rate of polling: that of the address, else that of the device up to `POLL_HZ`."""
    if text is None:
        return max(1.0, min(gyro.rate_hz() or POLL_HZ, POLL_HZ))
    if not (text.isascii() and text.isdigit() and len(text) <= 4 and 0 < int(text) <= FASTEST_POLL_HZ):
        raise UsageError(f"--port {address}: poll={text} is no number from 1 to {FASTEST_POLL_HZ}")
    return float(text)


def _set_rate(device: IioDevice, rate: str, text: str) -> None:
    if NUMBER.fullmatch(rate) is None or not 0.0 < float(rate) < inf:
        raise UsageError(f"--port {text}: rate={rate} is no number above 0")
    for attribute in ("in_anglvel_sampling_frequency", "sampling_frequency"):
        if device.text(attribute):
            try:
                device.write(attribute, rate)
            except (PortDeniedError, PortMissingError):
                raise
            except LinkError as error:
                raise _impossible_rate(device, attribute, rate, text) from error
            return
    raise UsageError(f"--port {text}: {device.name} has no sampling_frequency in {device.folder}; leave out rate=")


def _impossible_rate(device: IioDevice, attribute: str, rate: str, text: str) -> UsageError:
    possible = device.text(f"{attribute}_available") or device.text("sampling_frequency_available") or "unknown"
    return UsageError(f"--port {text}: {device.name} cannot measure at rate={rate}; possible rates: {possible}")


def _why_polled(device: IioDevice, trigger: str | None, text: str) -> str:
    """Reason why the values must be polled; empty if there is a buffer, and a trigger where one is needed."""
    if not (device.folder / elements_folder(device)).is_dir():
        return "the driver has no buffer"
    if not (iio_sysfs.DEVICE_FILES / device.file).exists():
        return f"{iio_sysfs.DEVICE_FILES / device.file} is not there"
    if not (device.folder / "trigger").is_dir():
        return ""
    if trigger is None and device.text("trigger/current_trigger"):
        return ""
    triggers = {IioDevice(folder, "", "", "").text("name") for folder in iio_sysfs.IIO_DEVICES.glob("trigger*")}
    if trigger is not None and trigger not in triggers:
        names = ", ".join(sorted(triggers)) or "none"
        raise UsageError(f"--port {text}: there is no trigger {trigger!r}; there are: {names}")
    number = device.file.removeprefix("iio:device")
    own = trigger or next((name for name in sorted(triggers) if name.endswith(f"-dev{number}")), None)
    if own is None:
        return "no trigger; create one in configfs (hrtimer), and append ?trigger=NAME"
    device.write("trigger/current_trigger", own)
    return ""


def gyros() -> list[SerialPort]:
    """Gyros of this machine, by name, or by number if several have the name."""
    devices = [device for device in iio_devices() if device.has_axes("anglvel")]
    names = [device.name for device in devices]
    return [
        SerialPort(
            f"iio:{device.name if names.count(device.name) == 1 else device.file.removeprefix('iio:')}",
            str(iio_sysfs.DEVICE_FILES / device.file),
            product=device.name,
        )
        for device in devices
    ]


IIO = ByteSource(
    "iio",
    "iio:NAME",
    "gyro with a Linux IIO driver, such as an MPU-6050 at the I²C bus",
    open_iio,
    protocol=batch_protocol("iio", "scans of a Linux IIO device"),
    devices=gyros,
    unit=("# The buffer of the chip is set up in /sys.", "DeviceAllow=char-iio rw", "ProtectKernelTunables=no"),
    silence="the kernel delivers no scans; check the trigger and the interrupt line of the chip, and dmesg",
)
