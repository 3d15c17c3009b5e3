"""Write a recording as it happens: samples, raw bytes and link events, one file after another.

Everything here runs in the thread that reads the port and never waits; only a `DiskFile` waits.
"""

import os
import platform
import re
import sys
import time
from collections import deque
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from gyrodrift import __version__
from gyrodrift.link.clocks.clock import CLOCK_SET
from gyrodrift.link.link import Link
from gyrodrift.link.protocols.decoder import DeviceDescription
from gyrodrift.recording.disk import MOST_WAITING_BYTES, DiskFile, RecordingError, disk_left_bytes
from gyrodrift.session.mcap.write import McapWriter
from gyrodrift.values.sample import Sample
from gyrodrift.values.secret import without_secrets

NAMELESS_S = 2.0
"""Raw bytes wait this long for the first sample, which brings the name of the device; then a file begins without it."""

MOST_EVENTS = 1000
"""Events kept before the first file begins, the latest ones."""

LONGEST_WORD = 80
"""Characters of a word; names of files have at most 255 bytes."""


@dataclass(frozen=True, slots=True)
class RecordOptions:
    """Options of a recording.

    rotate_bytes, rotate_s
        Size or time after which a new file begins; None for never.
    keeps_raw
        Whether the raw bytes of the link are recorded too.
    about
        Further tables for the metadata of each file: the config of the service at the start.
    beginning
        Gives further tables when a file begins: the state of the filter at that moment.
    mode
        Permissions of a file, less the umask.
    """

    folder: Path
    profile: str = ""
    note: str = ""
    rotate_bytes: int | None = None
    rotate_s: float | None = None
    keeps_raw: bool = False
    about: Mapping[str, dict[str, str]] = field(default_factory=dict)
    beginning: Callable[[], Mapping[str, dict[str, str]]] = dict
    mode: int = 0o666


class Recorder:
    """Records a link into a folder; check the folder before with `gyrodrift.io.files.check_writable`.

    `unflushed` counts the samples that are in no file yet. A file begins with the first sample, because its name has
    the name of the device.

    Raises
    ------
    RecordingError
        From every method: the recording cannot go on.
    """

    def __init__(self, options: RecordOptions, link: Link, monotonic: Callable[[], float] = time.monotonic) -> None:
        self.options = options
        self.samples = self.unflushed = 0
        self._ended_paths: list[Path] = []
        self._about_tables, self._mode = options.about, options.mode
        self._finished_bytes = 0
        self._link = link
        self._monotonic = monotonic
        self._disk: DiskFile | None = None
        self._writer: McapWriter | None = None
        self._finishing: list[DiskFile] = []
        self._device: DeviceDescription | None = None
        self._begun_s = 0.0
        self._waiting: list[tuple[bytes, float]] = []
        self._waiting_s = 0.0
        self._events: deque[tuple[str, float, dict[str, Any]]] = deque(maxlen=MOST_EVENTS)
        self._left_bytes = disk_left_bytes(options.folder)
        if options.keeps_raw:
            link.tap = self.take_raw

    @property
    def paths(self) -> list[Path]:
        """Files so far, in order of time."""
        current = [] if self._disk is None else [self._disk]
        return self._ended_paths + [disk.path for disk in self._finishing + current]

    @property
    def is_writing(self) -> bool:
        """Whether a file exists and bytes are written to it."""
        return self._disk is not None and self._disk.is_taking

    @property
    def is_over(self) -> bool:
        """Whether all files are on the disk."""
        return self._disk is None and all(disk.is_finished for disk in self._finishing)

    @property
    def size_bytes(self) -> int:
        """Size of all files together."""
        return self._finished_bytes + (self._writer.size if self._writer else 0)

    @property
    def left_bytes(self) -> int | None:
        """Free space at the last check, bytes; None if the folder is gone."""
        if self._disk is not None and self._disk.is_there:
            self._left_bytes = self._disk.left_bytes
        return self._left_bytes

    def take(self, samples: list[Sample]) -> None:
        """Record samples."""
        if samples:
            self.unflushed += len(samples)
            self._writer_of(samples).add_all(samples)
            self.samples += len(samples)

    def take_raw(self, content: bytes, t_host_s: float) -> None:
        """Record the bytes of one read."""
        if self._writer is None:
            self._waiting_s = self._waiting_s if self._waiting else self._monotonic()
            self._waiting.append((content, t_host_s))
        else:
            self._writer.add_read(content, t_host_s)

    def on_event(self, event: str, fields: Mapping[str, Any]) -> None:
        """Record a link event; after the host clock was set, the next sample begins a new file."""
        t_host_s = self._link.unix_s()
        if self._writer is None:
            self._events.append((event, t_host_s, dict(fields)))
            return
        self._writer.add_event(event, t_host_s, dict(fields))
        if event == CLOCK_SET:
            self._end()

    def set_about(self, about: Mapping[str, dict[str, str]], mode: int) -> None:
        """Change the tables of this and later files, and the permissions of later files, after a new config."""
        self._about_tables, self._mode = about, mode
        if self._writer is not None:
            for name, table in about.items():
                self._writer.add_metadata(name, table)

    def tick(self, _now_s: float) -> None:
        """Flush the file, and begin a new one if it is full; call this a few times a second."""
        while self._finishing and _is_over(self._finishing[0]):
            self._ended_paths.append(self._finishing.pop(0).path)
        if self._writer is None:
            if self._waiting and self._monotonic() - self._waiting_s >= NAMELESS_S:
                self._begun()
            return
        if self._disk is not None:
            self._disk.check()
        self._keep_device(self._writer)
        self._writer.flush()
        self.unflushed = 0
        if self._is_full(self._writer):
            self._end()

    def stats(self) -> dict[str, Any]:
        """Fields for the log."""
        left_bytes = self.left_bytes
        left_mb = None if left_bytes is None else round(left_bytes / 1e6)
        return {"recorded": self.samples, "recorded_bytes": self.size_bytes, "disk_left_mb": left_mb}

    def close(self) -> None:
        """Finish the file and wait until everything is on the disk."""
        try:
            self.finish()
        finally:
            self._join_all()

    def finish(self) -> None:
        """Finish the file without waiting for the disk; `is_over` becomes true, and `close` raises a failure."""
        try:
            if self._waiting:
                self._begun()
            self._end()
        finally:
            self.abandon()

    def abandon(self) -> None:
        """Stop recording; the file stays as it is."""
        if self._link.tap == self.take_raw:  # a later recording may have taken it
            self._link.tap = None
        if self._disk is not None:
            self._release(self._disk)

    def _release(self, disk: DiskFile) -> None:
        disk.finish()
        self._finishing.append(disk)
        self._disk = self._writer = None

    def _join_all(self) -> None:
        """Wait for every file, also after a failure; a disk that hangs is waited for only once."""
        failures = []
        hung: list[DiskFile] = []
        for disk in self._finishing:
            try:
                disk.join(0.0 if hung else None)
            except RecordingError as error:
                failures.append(error)
                hung += [] if disk.is_finished else [disk]
        if len(hung) > 1:
            lost = sum(disk.waiting_bytes for disk in hung)
            folder = self.options.folder
            raise RecordingError(f"{folder}: the disk hangs: {lost} bytes of {len(hung)} files are not written")
        if failures:
            raise failures[0]

    def _writer_of(self, samples: list[Sample]) -> McapWriter:
        """The open file; a new one if none is open, or if it cannot hold all values of the samples."""
        writer = self._writer
        if writer is not None and writer.has_axes and writer.has_device_yaw:
            return writer
        has_axes = any(sample.inertial is not None for sample in samples)
        has_device_yaw = self._is_filtering or any(sample.device_yaw is not None for sample in samples)
        if writer is not None:
            if has_axes <= writer.has_axes and has_device_yaw <= writer.has_device_yaw:
                return writer
            has_axes, has_device_yaw = has_axes or writer.has_axes, has_device_yaw or writer.has_device_yaw
            self._end()
        return self._begun(has_axes=has_axes, has_device_yaw=has_device_yaw)

    @property
    def _is_filtering(self) -> bool:
        """Whether the device says that it runs a filter; its first samples may come without a result."""
        decoder = self._link.decoder
        return decoder is not None and decoder.device.device_filter is not None

    def _begun(self, *, has_axes: bool = False, has_device_yaw: bool = False) -> McapWriter:
        """The open file; a new one if none is open."""
        if self._writer is not None:
            return self._writer
        device = self._device = self._link.decoder.device if self._link.decoder else DeviceDescription()
        about = self._about()  # before the new file, because `continues` names the previous one
        self._disk = self._new_file(device.device_id or "", datetime.now(UTC))
        self._begun_s = self._monotonic()
        self._writer = McapWriter(
            self._disk,
            {
                "recording": about,
                **self._about_tables,
                **self.options.beginning(),
                **_device_tables(device),
            },
            has_axes=has_axes,
            has_device_yaw=has_device_yaw,
        )
        for content, t_host_s in self._waiting:
            self._writer.add_read(content, t_host_s)
        for event, t_host_s, fields in self._events:
            self._writer.add_event(event, t_host_s, fields)
        self._waiting.clear()
        self._events.clear()
        return self._writer

    def _new_file(self, device: str, begun: datetime) -> DiskFile:
        folder, taken = self.options.folder, set(self.paths)
        if sum(disk.waiting_bytes for disk in self._finishing) > MOST_WAITING_BYTES:
            raise RecordingError(f"{folder}: recording stopped: the disk is too slow for this stream")

        def path() -> Path:
            return recording_path(folder, begun, device, self.options.profile, taken)

        return DiskFile(path(), path, self._mode)

    def _about(self) -> dict[str, str]:
        """Metadata of the recording when a file begins."""
        decoder = self._link.decoder
        table = {
            "program": f"gyrodrift {__version__}",
            "python": platform.python_version(),
            "host": platform.node(),
            "system": f"{sys.platform} {platform.release()} {platform.machine()}",
            "port": without_secrets(self._link.name),
            "baud": str(self._link.baud),
            "protocol": decoder.name if decoder else "",
            "begun": datetime.now(UTC).isoformat(timespec="milliseconds"),
            "profile": self.options.profile,
            "note": self.options.note,
            "continues": self.paths[-1].name if self.paths else "",
        }
        return {key: value for key, value in table.items() if value}

    def _keep_device(self, writer: McapWriter) -> None:
        """Record the identity of the device, which it may send late or change."""
        device = self._link.decoder.device if self._link.decoder else None
        if device is not None and device is not self._device:
            if device != self._device:
                for name, table in _device_tables(device).items():
                    writer.add_metadata(name, table)
            self._device = device

    def _is_full(self, writer: McapWriter) -> bool:
        most_bytes, most_s = self.options.rotate_bytes, self.options.rotate_s
        return (most_bytes is not None and writer.size >= most_bytes) or (
            most_s is not None and self._monotonic() - self._begun_s >= most_s
        )

    def _end(self) -> None:
        """Finish the file; the next sample begins another one."""
        if self._writer is None or self._disk is None:
            return
        self._writer.add_metadata("link", self._link_counters())
        self._writer.finish()
        self.unflushed = 0
        self._finished_bytes += self._writer.size
        self._release(self._disk)

    def _link_counters(self) -> dict[str, str]:
        """Counters of the link up to now."""
        counters, decoder = self._link.counters, self._link.decoder
        drift_ppm = self._link.clock.drift_ppm if self._link.clock else None
        table: dict[str, object] = {name: getattr(counters, name) for name in counters.__slots__}
        if decoder is not None:
            table |= {name: getattr(decoder.counters, name) for name in decoder.counters.__slots__}
            if not decoder.counters.lone_yaws:
                del table["lone_yaws"]
        if drift_ppm is not None:
            table["clock_ppm"] = round(drift_ppm, 2)
        return {name: str(value) for name, value in table.items()}


def _is_over(disk: DiskFile) -> bool:
    """Whether a file is on the disk; raises its failure."""
    if disk.is_finished:
        disk.join()
    return disk.is_finished


def _device_tables(device: DeviceDescription) -> dict[str, dict[str, str]]:
    table = {name: str(getattr(device, name)) for name in device.__slots__ if getattr(device, name) is not None}
    return {"device": table} if table else {}


def recording_path(
    folder: Path, begun: datetime, device: str, profile: str, taken: Collection[Path] = frozenset()
) -> Path:
    """A path that does not exist yet: `2026-05-01T12-30-00Z_bench-7_turntable.mcap`; `begun` is in UTC.

    Paths in `taken` count as existing.
    """
    words = [f"{begun:%Y-%m-%dT%H-%M-%SZ}", _plain(device), _plain(profile)]
    stem = "_".join(word for word in words if word)
    path, number = folder / f"{stem}.mcap", 1
    while path in taken or os.path.lexists(path):  # a link to nowhere takes a name too
        number += 1
        path = folder / f"{stem}_{number}.mcap"
    return path


def _plain(text: str) -> str:
    """Text as a part of a file name for any file system, shortened."""
    return re.sub(r"[^A-Za-z0-9.-]+", "-", text)[:LONGEST_WORD].strip("-.")
