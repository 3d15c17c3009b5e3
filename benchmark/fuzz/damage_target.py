"""A recording of known samples that is damaged anywhere: what is read of it is as it was written, or is told."""

import io
from contextlib import suppress
from functools import cache
from pathlib import Path
from random import Random
from struct import Struct

import numpy as np

from gyrodrift.session.mcap.layout import CLOSED_TAIL, CLOSED_TAIL_BYTES, MAGIC
from gyrodrift.session.mcap.read import read_mcap
from gyrodrift.session.mcap.repair import repair
from gyrodrift.session.mcap.write import McapWriter
from gyrodrift.session.session import DEVICE_COLUMNS, Session
from gyrodrift.values.errors import DataError
from gyrodrift.values.sample import DeviceYaw, Inertial, Sample

COUNT, FLUSHED = 400, 25
CHANGE = Struct("<BHHB")
"""What is done, where in the file, over how many bytes, and with which byte."""

MOST_CHANGES = 20
COLUMNS = ("t_device_s", "rate_dps", "t_host_s", "encoder_deg", "temp_c")


@cache
def recording(*, has_axes: bool = False, has_device_yaw: bool = False) -> bytes:
    """Samples, raw bytes and events, with the end that a finished recording has."""
    stream, random = io.BytesIO(), Random(1)
    writer = McapWriter(stream, {"device": {"device_id": "bench"}}, has_axes=has_axes, has_device_yaw=has_device_yaw)
    for number in range(COUNT):
        t_s = number / 100
        sample = Sample(number, t_s, 1.7e9 + t_s, random.gauss(0.0, 10.0), 0.1 * number, 25.0, float(number > 200))
        axes = Inertial(0.5 * number, -1.0, sample.rate_dps, 0.01 * number, 0.0, 9.81)
        own = DeviceYaw(0.3 * number, 0.01 * number, -0.5)
        writer.add(sample._replace(inertial=axes if has_axes else None, device_yaw=own if has_device_yaw else None))
        if number % FLUSHED == FLUSHED - 1:
            writer.add_read(random.randbytes(40), 1.7e9 + t_s)
            writer.add_event("gap", 1.7e9 + t_s, {"missing": 1})
            writer.flush()
    writer.finish()
    return stream.getvalue()


def changed_recording(changes: bytes, *, has_axes: bool = False, has_device_yaw: bool = False) -> bytes:
    """The recording with some changes: bytes written over, flipped, taken out, put in, or copied from elsewhere."""
    made = bytearray(recording(has_axes=has_axes, has_device_yaw=has_device_yaw))
    for at in range(0, min(len(changes), MOST_CHANGES * CHANGE.size) - CHANGE.size + 1, CHANGE.size):
        kind, place, length, value = CHANGE.unpack_from(changes, at)
        place %= len(made) + 1
        match kind % 6:
            case 0 if place < len(made):
                made[place] ^= value or 1
            case 1:
                del made[place : place + length]
            case 2:
                made[place:place] = bytes([value]) * (length % 5000)
            case 3:
                made[place : place + length % 5000] = made[-(length % 5000) :]
            case 4:
                made[place:place] = made[place : place + length]
            case _:
                made[place : place + length % 5000] = bytes([value]) * (length % 5000)
        if not made:
            break
    return bytes(made)


def check_damage(folder: Path, changes: bytes) -> None:
    """Damage, read, read what is whole, repair, read again: one axis, three, and three with the device's own yaw."""
    for has_axes, has_device_yaw in ((False, False), (True, False), (True, True)):
        check_damaged_file(folder, changes, has_axes=has_axes, has_device_yaw=has_device_yaw)


def check_damaged_file(folder: Path, changes: bytes, *, has_axes: bool, has_device_yaw: bool) -> None:
    """Damage, read, read what is whole, repair, read again."""
    path = folder / "d.mcap"
    path.write_bytes(recording(has_axes=has_axes, has_device_yaw=has_device_yaw))
    whole = read_mcap(path)
    content = changed_recording(changes, has_axes=has_axes, has_device_yaw=has_device_yaw)
    if not (content.startswith(MAGIC) and content[-CLOSED_TAIL_BYTES:].startswith(CLOSED_TAIL)):
        return  # as good as interrupted: its last records are not watched over yet
    path.write_bytes(content)
    with suppress(DataError):
        session = read_mcap(path)
        assert len(session.rate_dps) == COUNT
        assert are_original(session, whole)
    with suppress(DataError):
        session = read_mcap(path, allow_damage=True)
        check_kept(session, whole)
        if session.damage is not None and "are no records" in str(session.damage):
            return  # cut off, and its last records are not watched over
    with suppress(DataError):
        repair(path)
        check_kept(read_mcap(path, allow_damage=True), whole)
    for other in folder.glob("d.mcap?*"):
        other.unlink()


def check_kept(session: Session, whole: Session) -> None:
    """Each sample is one that was written, unless it is said that nobody can know."""
    if not session.remarks and (session.damage is None or session.damage.is_sure):
        assert are_original(session, whole)


def are_original(session: Session, whole: Session) -> bool:
    """Whether each sample is one of the whole recording, bit for bit, and none comes twice."""
    numbers = session.seq
    assert numbers is not None
    if len(numbers) and ((np.diff(numbers) <= 0).any() or not 0 <= numbers[0] <= numbers[-1] < COUNT):
        return False
    names = [*COLUMNS]
    names += [] if whole.gyro_dps is None else ["gyro_dps", "accel_mps2"]
    names += [] if whole.device_yaw_deg is None else DEVICE_COLUMNS
    pairs = [(getattr(session, name), getattr(whole, name)) for name in names]
    return all(here is not None and np.array_equal(here, there[numbers]) for here, there in pairs)
