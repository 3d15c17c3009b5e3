"""IIO devices of this machine in sysfs: names, channels, scales, mount matrix, trigger and buffer."""

import errno
import os
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import isfinite, nan
from pathlib import Path

from gyrodrift.link.sources.iio_readings import IDENTITY, IioChannel, IioDescription, is_rotation
from gyrodrift.values.errors import LinkError, PortBusyError, PortDeniedError, PortMissingError

IIO_DEVICES = Path("/sys/bus/iio/devices")
DEVICE_FILES = Path("/dev")

LONGEST_ATTRIBUTE_BYTES = 4096
"""Length of a page: the kernel's limit for an attribute."""

GONE = frozenset({errno.ENODEV, errno.ENOENT, errno.ENXIO})
RULE = (
    'SUBSYSTEM=="iio", GROUP="dialout", MODE="0660", RUN+="/bin/sh -c \'chgrp -R dialout /sys%p; chmod -R g+w /sys%p\'"'
)
NUMBER = re.compile(r"[-+]?\d{1,20}(?:\.\d{0,20})?(?:[eE][-+]?\d{1,3})?")
AXES = "xyz"


@dataclass(frozen=True, slots=True)
class IioDevice:
    """Folder of a device.

    file
        `iio:device0`.
    name
        Name of the chip, which several devices may have.
    parent
        Folder of the chip, which a gyro shares with its accelerometer.
    """

    folder: Path
    file: str
    name: str
    parent: str

    def names(self) -> tuple[str, ...]:
        """Names in an address: its label or the name of the chip, and its number."""
        return self.name, self.text("name"), self.file, self.file.removeprefix("iio:")

    def text(self, attribute: str) -> str:
        """Content of an attribute; empty without it."""
        try:
            with (self.folder / attribute).open("rb") as file:
                return file.read(LONGEST_ATTRIBUTE_BYTES).decode("ascii", "replace").strip("\0 \n")
        except OSError:
            return ""

    def number(self, *attributes: str, default: float = nan) -> float:
        """First attribute that is a number."""
        for attribute in attributes:
            match = NUMBER.match(self.text(attribute))
            if match is not None:
                return float(match[0])
        return default

    def has_axes(self, kind: str, axes: str = "z") -> bool:
        """Whether it measures a kind, such as `anglvel`, about the axes."""
        return all((self.folder / f"in_{kind}_{axis}_raw").exists() for axis in axes)

    def has_temperature(self) -> bool:
        """Whether it measures its temperature."""
        return any((self.folder / f"in_temp_{form}").exists() for form in ("input", "raw"))

    def write(self, attribute: str, value: str) -> None:
        """Write an attribute.

        Raises
        ------
        LinkError
            It is not possible; the message says why and what to do.
        """
        path = self.folder / attribute
        try:
            fd = os.open(path, os.O_WRONLY | os.O_TRUNC)
            try:
                os.write(fd, value.encode())
            finally:
                os.close(fd)
        except OSError as error:
            raise explained(path, error) from error

    def try_to_write(self, attribute: str, value: str) -> bool:
        """Write an attribute that not all drivers have."""
        try:
            self.write(attribute, value)
        except LinkError:
            return False
        return True

    def channel(self, name: str) -> IioChannel:
        """Scale and offset of a channel such as `anglvel_z`; those of its kind serve all axes."""
        kind, _, _ = name.partition("_")
        scale = self.number(f"in_{name}_scale", f"in_{kind}_scale", default=1.0)
        offset = self.number(f"in_{name}_offset", f"in_{kind}_offset", default=0.0)
        return IioChannel(scale, offset)

    def described(self, kind: str, channels: Mapping[str, IioChannel]) -> IioDescription:
        """Description with the mount matrix of a kind; a matrix that is no rotation is left out."""
        return IioDescription(self.name, self.rate_hz(), self.matrix(kind) or IDENTITY, channels)

    def check_scale(self, kind: str, text: str) -> None:
        """Check that the counts of a kind have a unit.

        Raises
        ------
        LinkError
            A scale is absent, 0, or no number.
        """
        for axis in AXES:
            if not self.has_axes(kind, axis):
                continue
            scale = self.number(f"in_{kind}_{axis}_scale", f"in_{kind}_scale")
            if not isfinite(scale) or not scale:
                shown = self.text(f"in_{kind}_{axis}_scale") or self.text(f"in_{kind}_scale") or "absent"
                raise LinkError(
                    f"{text}: the scale of in_{kind}_{axis} in {self.folder} is {shown}, so its unit is unknown; "
                    f"write a value of in_{kind}_scale_available into in_{kind}_scale, or update the driver"
                )

    def rate_hz(self) -> float:
        """Sampling frequency; 0 if unknown."""
        return self.number("in_anglvel_sampling_frequency", "sampling_frequency", default=0.0)

    def matrix(self, kind: str) -> tuple[float, ...] | None:
        """Mount matrix by rows, the identity without one; None if it is no rotation."""
        names = (f"in_{kind}_mount_matrix", "in_mount_matrix", "mount_matrix")
        text = next(filter(None, map(self.text, names)), "")
        if not text:
            return IDENTITY
        numbers = tuple(float(match) for match in NUMBER.findall(text))
        return numbers if is_rotation(numbers) else None


def iio_devices() -> list[IioDevice]:
    """All IIO devices, by number."""
    folders = sorted(IIO_DEVICES.glob("iio:device*"), key=lambda folder: (len(folder.name), folder.name))
    return [_device(folder) for folder in folders]


def _device(folder: Path) -> IioDevice:
    parent = str(Path(os.path.realpath(folder)).parent)
    device = IioDevice(folder, folder.name, "", parent)
    return IioDevice(folder, folder.name, device.text("label") or device.text("name") or folder.name, parent)


def device_named(name: str, kind: str, text: str) -> IioDevice:
    """Device with a name or number that measures a kind, `anglvel` or `accel`.

    Raises
    ------
    PortMissingError
        There is none; the message lists the others.
    LinkError
        Several devices have this name.
    """
    devices = [device for device in iio_devices() if device.has_axes(kind)]
    matching = [device for device in devices if name in device.names()]
    if len(matching) > 1:
        raise LinkError(
            f"{text}: {len(matching)} devices are called {name}: {_listed(matching)}; name one by its number"
        )
    if matching:
        return matching[0]
    measures = "gyro" if kind == "anglvel" else "accelerometer"
    there = _listed(devices) if devices else f"no IIO {measures} in {IIO_DEVICES}"
    raise PortMissingError(
        f"{text}: there is no IIO {measures} {name!r}; there is {there}; is its driver loaded, and the device-tree "
        "overlay set?"
    )


def _listed(devices: Iterable[IioDevice]) -> str:
    return ", ".join(
        f"{device.file.removeprefix('iio:')} ({device.name} at {Path(device.parent).name})" for device in devices
    )


def accelerometer_of(gyro: IioDevice) -> IioDevice | None:
    """Accelerometer of the same chip that is another IIO device; None without one."""
    siblings = (device for device in iio_devices() if device.parent == gyro.parent and device.file != gyro.file)
    return next((device for device in siblings if device.has_axes("accel", "xyz")), None)


def explained(path: Path, error: OSError) -> LinkError:
    """Error about an attribute or a device file."""
    if error.errno in (errno.EACCES, errno.EPERM):
        return PortDeniedError(
            f"{path}: no permission; poll with ?poll=100, or put {RULE} into /etc/udev/rules.d/99-iio.rules, and join "
            "the group with 'sudo usermod -aG dialout $USER'"
        )
    if error.errno == errno.EBUSY:
        return PortBusyError(f"{path}: another program reads this device; stop that program first, such as iiod")
    if error.errno in GONE:
        return PortMissingError(f"{path}: the device is not there: {error.strerror}")
    return LinkError(f"{path}: {error.strerror}; check dmesg for the driver")
