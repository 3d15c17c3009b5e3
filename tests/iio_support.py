"""A sysfs tree and device files as the kernel's ABI document describes them, for tests of the source iio."""

import os
from pathlib import Path
from struct import pack

GYRO_SCALE, ACCEL_SCALE = 0.001, 0.01
AXES = "xyz"


class IioTree:
    """Folders `/sys/bus/iio/devices` and `/dev` of a test."""

    def __init__(self, folder: Path) -> None:
        self.devices, self.files, self._chips = folder / "bus", folder / "dev", folder / "chips"
        for subfolder in (self.devices, self.files):
            subfolder.mkdir(parents=True)

    def trigger(self, number: int, name: str) -> None:
        folder = self.devices / f"trigger{number}"
        folder.mkdir()
        (folder / "name").write_text(f"{name}\n")


class IioChip:
    """One IIO device with a buffer, whose scans the test writes into a named pipe."""

    def __init__(self, tree: IioTree, number: int, name: str, address: str, kinds: tuple[str, ...]) -> None:
        self.file = f"iio:device{number}"
        self.folder = tree._chips / address / self.file
        self.folder.mkdir(parents=True)
        self.link, self.pipe = tree.devices / self.file, tree.files / self.file
        self.kinds = kinds
        self._writer = -1
        self.write("name", name)
        self.write("sampling_frequency", "100.000000")
        self.write("current_timestamp_clock", "realtime")
        index = 0
        for kind in kinds:
            self.write(f"in_{kind}_scale", str(GYRO_SCALE if kind == "anglvel" else ACCEL_SCALE))
            for axis in AXES:
                self.write(f"in_{kind}_{axis}_raw", str(100 * (AXES.index(axis) + 1)))
                self.element(f"in_{kind}_{axis}", index, "le:s16/16>>0")
                index += 1
        self.element("in_timestamp", index, "le:s64/64>>0")
        for attribute, value in (("enable", "0"), ("length", "2"), ("watermark", "1")):
            self.write(f"buffer/{attribute}", value)
        self.plug_in()

    def write(self, attribute: str, value: str) -> None:
        path = self.folder / attribute
        path.parent.mkdir(exist_ok=True)
        path.write_text(f"{value}\n")

    def text(self, attribute: str) -> str:
        return (self.folder / attribute).read_text().strip()

    def element(self, name: str, index: int, form: str) -> None:
        for suffix, value in (("en", "0"), ("index", str(index)), ("type", form)):
            self.write(f"scan_elements/{name}_{suffix}", value)

    def plug_in(self) -> None:
        self.link.symlink_to(self.folder)
        os.mkfifo(self.pipe)
        self._writer = os.open(self.pipe, os.O_RDWR | os.O_NONBLOCK)

    def unplug(self) -> None:
        self.link.unlink()
        self.pipe.unlink()
        self.close()

    def close(self) -> None:
        if self._writer >= 0:
            os.close(self._writer)
            self._writer = -1

    def send(self, t_ns: int, *counts: int) -> None:
        """A scan: counts, padding to 8 bytes, timestamp."""
        values = pack(f"<{len(counts)}h", *counts)
        os.write(self._writer, values + bytes(-len(values) % 8) + pack("<q", t_ns))
