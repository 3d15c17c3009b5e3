"""Source `FILE.mcap`: a recording, followed while it grows.

It is read from its beginning. Its end is the end of a finished file.
"""

import os
from contextlib import suppress
from math import isnan, nan
from pathlib import Path

from gyrodrift.io.files import UnreadableError, open_ordinary
from gyrodrift.link.port import PortGoneError
from gyrodrift.link.protocols.decoder import CountingDecoder, DeviceDescription
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.link.sources.source import ByteSource, SourceAddress, SourceEndedError, SourcePort
from gyrodrift.session.follow import SampleStream
from gyrodrift.session.mcap.layout import CLOSED_TAIL, CLOSED_TAIL_BYTES, LATEST_S, MAGIC
from gyrodrift.values.constants import CLOCK_MASK, COUNTER_MASK
from gyrodrift.values.errors import DataError, LinkError, PortDeniedError, PortMissingError
from gyrodrift.values.sample import Reading, Sample

READ_BYTES = 65_536
LOOK_S = 0.05
"""Time between two looks at the file, s; a recorder writes at least once a second."""


class FollowedFile(SourcePort):
    """Open file that another program writes."""

    def __init__(self, path: str, file: int, name: str) -> None:
        super().__init__(path, None)
        self.wake_s = 0.0
        self._file = file
        self._name = name
        self._position = 0
        self._tail = b""

    def read(self) -> bytes:
        """The next bytes, up to a limit.

        Raises
        ------
        SourceEndedError
            The file is finished.
        PortGoneError
            The file was truncated or replaced; it is then read from its beginning.
        """
        if os.fstat(self._file).st_size < self._position:
            self.note("source_truncated", at_byte=self._position)
            raise PortGoneError(self.path)
        chunk = os.read(self._file, READ_BYTES)
        self.wake_s = 0.0 if chunk else LOOK_S
        if chunk:
            self._position += len(chunk)
            self._tail = (self._tail + chunk)[-CLOSED_TAIL_BYTES:]
        elif self._tail.startswith(CLOSED_TAIL) and self._tail.endswith(MAGIC):
            raise SourceEndedError(self.path)
        elif self._is_replaced():
            self.note("source_replaced", at_byte=self._position)
            raise PortGoneError(self.path)
        return chunk

    def close(self) -> None:
        """Close the file."""
        with suppress(OSError):
            os.close(self._file)

    def _is_replaced(self) -> bool:
        """Whether the name has another file; a file that was deleted is still read."""
        try:
            return not os.path.samestat(os.stat(self._name), os.fstat(self._file))  # noqa: PTH116 - of a descriptor, too
        except OSError:
            return False


class McapDecoder(CountingDecoder):
    """Readings of the samples in a file. After damage to its structure nothing can be read."""

    name = "mcap"

    def __init__(self) -> None:
        super().__init__()
        self._stream: SampleStream | None = SampleStream("the file")
        self._is_introduced = False

    def push(self, chunk: bytes) -> list[Reading]:
        """Readings of the next bytes, or of a part of them."""
        if self._stream is None:
            return []
        damaged = self._stream.damaged
        try:
            samples = self._stream.push(chunk)
        except DataError:
            self.counters.damaged += 1
            self._stream, self.is_behind = None, False
            return []
        self.is_behind = self._stream.is_behind
        self.unread = self._stream.unread_contents
        timed = [sample for sample in samples if abs(sample.t_device_s) <= LATEST_S]
        self.counters.frames += len(timed)
        self.counters.damaged += self._stream.damaged - damaged + len(samples) - len(timed)
        if self._stream.device and not self._is_introduced:
            self._is_introduced = True
            self.device = _device(self._stream.device)
        return [_reading(sample) for sample in timed]


def _reading(sample: Sample) -> Reading:
    """Reading with the low bits of time and counter, as on a wire."""
    seq, t_device_s, _, rate_dps, encoder_deg, temp_c, still, inertial, device_yaw, aids = sample
    t_us = round(t_device_s * 1e6) & CLOCK_MASK
    if device_yaw is not None and isnan(device_yaw.yaw_deg):  # a recording has no other sign of a missing result
        device_yaw = None
    count = seq & COUNTER_MASK if seq >= 0 else None
    aids = aids and tuple(aid._replace(t_s=aid.t_s - t_device_s) for aid in aids)
    return Reading(t_us, count, rate_dps, encoder_deg, temp_c, still, nan, inertial, device_yaw, aids=aids)


def _device(table: dict[str, str]) -> DeviceDescription:
    numbers: dict[str, float] = {}
    for name in ("sample_rate_hz", "dps_per_lsb"):
        with suppress(KeyError, ValueError):
            numbers[name] = float(table[name])
    return DeviceDescription(table.get("device_id"), **numbers)  # type: ignore[arg-type]  # two floats


def open_mcap(address: SourceAddress) -> FollowedFile:
    """Open a file at its beginning.

    Raises
    ------
    LinkError
        It cannot be opened; the message says why.
    """
    try:
        file = open_ordinary(Path(address.rest))
    except FileNotFoundError as error:
        raise PortMissingError(f"{address.text}: there is no such file; with --timeout 0 it is waited for") from error
    except UnreadableError as error:
        raise LinkError(f"{address.text}: {error}; give a recording that another program writes") from error
    except PermissionError as error:
        raise PortDeniedError(f"{address.text}: no permission to read it") from error
    except OSError as error:
        raise LinkError(f"{address.text}: cannot be opened: {error.strerror}") from error
    return FollowedFile(address.text, file, address.rest)


FOLLOWED = WireProtocol(
    "mcap",
    "samples of a recording",
    McapDecoder,
    has_clock=True,
    rank=0,
    has_unit=True,
    is_detected=False,
    without_rate="it has no channel /gyro, and no other channel with rates that can be read",
)

MCAP = ByteSource(
    "mcap",
    "FILE.mcap",
    "recording that another program writes, followed while it grows",
    open_mcap,
    protocol=FOLLOWED,
    holds_back=True,
    silence="its writer has written nothing yet",
)
