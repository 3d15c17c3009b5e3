"""Damage to a closed recording: it is found, told with the samples it costs, and everything else is read."""

import io
import struct
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader

from gyrodrift.session.damage import DamagedError
from gyrodrift.session.mcap.ending import DATA_END, is_closed
from gyrodrift.session.mcap.layout import CLOSED_TAIL, CLOSED_TAIL_BYTES, MESSAGE, SAMPLE_HEAD, SEAL_START
from gyrodrift.session.mcap.read import read_mcap
from gyrodrift.session.mcap.repair import repair
from gyrodrift.session.mcap.write import McapWriter
from gyrodrift.session.session import Session
from gyrodrift.values.errors import DataError
from gyrodrift.values.sample import Sample

COUNT, FLUSHED = 1000, 25
BLOCK = 4096
RATE_OFFSET = struct.calcsize(SAMPLE_HEAD + "qdd")
COLUMNS = ("t_device_s", "rate_dps", "t_host_s", "seq", "encoder_deg", "temp_c")


def recording(*, is_finished: bool = True, device_id: str = "bench") -> bytes:
    """A recording at 100 Hz, flushed four times a second, with events and raw bytes between its samples."""
    stream = io.BytesIO()
    writer = McapWriter(stream, {"device": {"device_id": device_id}})
    dice = np.random.default_rng(1)
    for number, rate_dps in enumerate(dice.normal(0.0, 10.0, COUNT).tolist()):
        still = float(number // 300 % 2)
        writer.add(Sample(number, number / 100, 1.7e9 + number / 100, rate_dps, 0.1 * number, 25.0, still))
        if number % FLUSHED == FLUSHED - 1:
            writer.add_read(dice.bytes(40), 1.7e9 + number / 100)
            writer.add_event("gap", 1.7e9 + number / 100, {"missing": 1})
            writer.flush()
    writer.add_metadata("link", {"samples": str(COUNT)})
    if is_finished:
        writer.finish()
    return stream.getvalue()


WHOLE = recording()
EARLIER = Path(__file__).parent / "earlier"
"""Recordings of 100 samples by a version that wrote tables of checksums."""


def loaded(folder: Path, content: bytes, *, allow_damage: bool = False) -> Session:
    path = folder / "s.mcap"
    path.write_bytes(content)
    return read_mcap(path, allow_damage=allow_damage)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Session:
    return loaded(tmp_path_factory.mktemp("whole"), WHOLE)


def are_original(session: Session, whole: Session) -> bool:
    """Whether every sample is one of the whole recording, bit for bit, and none comes twice."""
    assert session.seq is not None
    numbers = session.seq
    if len(numbers) and (np.diff(numbers) <= 0).any():
        return False
    result = [getattr(session, name) for name in COLUMNS]
    return all(np.array_equal(here, getattr(whole, name)[numbers]) for here, name in zip(result, COLUMNS, strict=True))


def damaged_at(location: int, content: bytes, removed: int | None = None) -> bytes:
    return WHOLE[:location] + content + WHOLE[location + (len(content) if removed is None else removed) :]


BLOCKS = {"zeros": bytes(BLOCK), "ones": b"\xff" * BLOCK, "text": b"hello wo" * (BLOCK // 8), "missing": b""}


@pytest.mark.promise("Crashes")
@pytest.mark.parametrize("kind", BLOCKS)
def test_a_damaged_block_costs_the_samples_in_it_and_no_others(tmp_path: Path, whole: Session, kind: str) -> None:
    """A damaged block of 4 KiB costs at most 49 samples; everything after it is read."""
    position = len(WHOLE) // 2 // BLOCK * BLOCK
    content = damaged_at(position, BLOCKS[kind], BLOCK)
    with pytest.raises(DamagedError, match=r"samples \d+ to \d+ \(\d.* s, at ") as report:
        loaded(tmp_path, content)
    session = loaded(tmp_path, content, allow_damage=True)
    ((_, damage),) = report.value.damages
    assert damage == session.damage
    assert are_original(session, whole)
    assert session.seq is not None
    assert session.seq[-1] == COUNT - 1
    missing = np.setdiff1d(np.arange(COUNT), session.seq)
    assert sum(item.count or 0 for item in damage.lost) == len(missing) <= BLOCK // MESSAGE.size + 2
    assert damage.lost_seconds == pytest.approx(len(missing) / 100)
    assert damage.kept == COUNT - len(missing)
    assert damage.lost[0].first == missing[0]


@pytest.mark.promise("Crashes")
def test_one_flipped_bit_of_a_rate_costs_that_sample(tmp_path: Path, whole: Session) -> None:
    """A flipped bit costs at most one sample."""
    content = flipped(WHOLE.index(whole.rate_dps[500].tobytes()), 3)
    with pytest.raises(DamagedError, match=r"lost is sample 500 \(0.01 s, at 5.00 s\); 999 samples are whole"):
        loaded(tmp_path, content)
    session = loaded(tmp_path, content, allow_damage=True)
    assert are_original(session, whole)
    assert session.seq is not None
    assert np.setdiff1d(np.arange(COUNT), session.seq).tolist() == [500]


def test_a_lost_sample_is_told_by_its_number_in_the_file(tmp_path: Path) -> None:
    stream = io.BytesIO()
    writer = McapWriter(stream)
    writer.add_all(Sample(-1 if number < 5 else 70_000, number / 100, 1.7e9, 0.5 + number) for number in range(10))
    writer.add_event("gap", 1.7e9, {"missing": 1})
    writer.finish()
    content = stream.getvalue()
    with pytest.raises(DamagedError, match=r"lost is sample 7 .* 9 samples are whole"):
        loaded(tmp_path, flipped(content.index(struct.pack("<d", 7.5)), 1, content))
    with pytest.raises(DamagedError, match=r"records other than samples are lost .*; no sample is lost; 10 samples"):
        loaded(tmp_path, flipped(content.index(b"missing"), 1, content))


@pytest.mark.promise("Crashes")
@pytest.mark.parametrize("kind", ["twice", "moved"])
def test_records_in_another_place_are_read_in_their_order(tmp_path: Path, whole: Session, kind: str) -> None:
    """Records in another place are read in their order, and a sample of another recording is not read."""
    content = damaged(WHOLE, WHOLE.index(whole.rate_dps[500].tobytes()) - RATE_OFFSET, 2 * MESSAGE.size, kind)
    with pytest.raises(DamagedError, match="no sample is lost"):
        loaded(tmp_path, content)
    session = loaded(tmp_path, content, allow_damage=True)
    assert are_original(session, whole)
    assert len(session.rate_dps) == COUNT


@pytest.mark.promise(
    "Crashes", "records in another place are read in their order, and a sample of another recording is not read"
)
def test_samples_of_another_recording_are_none_of_this_one(tmp_path: Path, whole: Session) -> None:
    stranger = recording(device_id="shelf")
    start = WHOLE.index(whole.rate_dps[400].tobytes()) // BLOCK * BLOCK
    session = loaded(tmp_path, damaged_at(start, stranger[start : start + BLOCK]), allow_damage=True)
    assert session.damage is not None
    assert session.damage.lost_count > 40
    assert are_original(session, whole)


def flipped(location: int, bit: int, content: bytes = WHOLE) -> bytes:
    return content[:location] + bytes([content[location] ^ (1 << bit)]) + content[location + 1 :]


@pytest.mark.promise("Crashes")
def test_every_byte_of_a_recording_is_watched_over(tmp_path: Path, whole: Session) -> None:
    """Checksums cover every byte of a recording."""
    for position in range(0, len(WHOLE), 307):
        assert_told_or_whole(tmp_path, flipped(position, position % 8), whole)
    for position in range(len(WHOLE) - 800, len(WHOLE), 7):
        assert_told_or_whole(tmp_path, flipped(position, position % 8), whole)


def assert_told_or_whole(folder: Path, content: bytes, whole: Session) -> None:
    """The promise: all samples, or the damage is told and every sample is one that was written."""
    try:
        session = loaded(folder, content)
    except DataError as error:
        damage = error.damages[0][1] if isinstance(error, DamagedError) else None
        if damage is not None and damage.kept:
            session = loaded(folder, content, allow_damage=True)
            assert are_original(session, whole)
            assert len(session.rate_dps) == damage.kept
            assert damage.lost or damage.remarks or len(session.rate_dps) == COUNT
        return
    assert are_original(session, whole)
    if len(session.rate_dps) < COUNT:  # what is only cut off was, for all one can know, never closed
        with (folder / "s.mcap").open("rb") as file:
            assert not is_closed(file)


places = st.integers(0, len(WHOLE))
damages = st.one_of(
    st.tuples(places, st.sampled_from([1, 83, 512, BLOCK]), st.sampled_from(["zeros", "ones", "text", "noise"])),
    st.tuples(places, st.integers(1, 9000), st.sampled_from(["missing", "twice", "moved"])),
    st.tuples(places, st.integers(0, 7), st.just("flip")),
    st.tuples(places, st.just(0), st.just("cut")),
)


def damaged(content: bytes, location: int, size: int, kind: str) -> bytes:
    head, rest = content[:location], content[location:]
    match kind:
        case "flip":
            return flipped(min(location, len(content) - 1), size, content) if content else content
        case "cut":
            return head
        case "missing" | "twice" | "moved":
            return (
                head + {"missing": rest[size:], "twice": rest[:size] + rest, "moved": rest[size:] + rest[:size]}[kind]
            )
    patterns = {
        "zeros": b"\0",
        "ones": b"\xff",
        "text": b"hello wo",
        "noise": np.random.default_rng(location).bytes(BLOCK),
    }
    return head + (patterns[kind] * size)[: min(size, len(rest))] + rest[size:]


@pytest.mark.promise(
    "Crashes",
    "for any change to a closed recording (except two damages near a cut), either all samples are read, "
    "or the damage is reported",
)
@given(st.lists(damages, min_size=1, max_size=2))
def test_whatever_is_done_to_a_recording_is_told_or_harmless(
    tmp_path_factory: pytest.TempPathFactory, done: list[tuple[int, int, str]]
) -> None:
    folder = tmp_path_factory.getbasetemp()
    whole = loaded(folder, WHOLE)
    content = WHOLE
    for position, size, kind in done:
        content = damaged(content, position, size, kind)
    if not content.startswith(WHOLE[:8]) and SEAL_START not in content:
        return  # nothing shows that it was a recording
    if len(done) > 1 and content[-CLOSED_TAIL_BYTES:][: len(CLOSED_TAIL)] != CLOSED_TAIL:
        return  # as good as interrupted: its last records are not watched over yet
    assert_told_or_whole(folder, content, whole)


@pytest.mark.promise("Crashes")
def test_bytes_of_a_device_that_look_like_samples_are_none(tmp_path: Path) -> None:
    """Bytes of a device that look like samples are not read as samples, also after a kill."""
    stream, forged = io.BytesIO(), recording(device_id="forger", is_finished=False)
    writer = McapWriter(stream, {"device": {"device_id": "bench"}})
    for number in range(10):
        writer.add(Sample(number, number / 100, 1.7e9, 0.5))
        writer.add_read(forged, 1.7e9)
        writer.flush()
    for content in (stream.getvalue(), flipped(len(stream.getvalue()) // 2, 1, stream.getvalue())):
        session = loaded(tmp_path, content, allow_damage=True)
        assert session.seq is not None
        assert session.seq.tolist() == list(range(10))
        assert (session.rate_dps == 0.5).all()


def test_what_was_said_of_rest_stays_with_its_samples(tmp_path: Path, whole: Session) -> None:
    """The messages name samples by number, and numbers before them may be missing."""
    content = damaged_at(WHOLE.index(whole.rate_dps[120].tobytes()), bytes(100))
    session = loaded(tmp_path, content, allow_damage=True)
    assert session.seq is not None
    assert session.still is not None
    assert whole.still is not None
    is_said = np.isfinite(session.still)
    assert is_said.mean() > 0.5
    assert np.array_equal(session.still[is_said], whole.still[session.seq[is_said]])


def test_a_flipped_bit_in_an_interrupted_recording_is_told_too(tmp_path: Path, whole: Session) -> None:
    content = recording(is_finished=False)
    assert len(loaded(tmp_path, content).rate_dps) == COUNT
    assert len(loaded(tmp_path, content[:-30]).rate_dps) == COUNT
    for number in (500, COUNT - 1):
        position = content.index(whole.rate_dps[number].tobytes())
        with pytest.raises(DamagedError, match=f"lost is sample {number} "):
            loaded(tmp_path, flipped(position, 2, content))


def test_public_readers_take_the_seals_as_they_are() -> None:
    records = list(StreamReader(io.BytesIO(WHOLE), validate_crcs=True).records)
    assert type(records[-1]).__name__ == "Footer"
    messages = list(make_reader(io.BytesIO(WHOLE), validate_crcs=True).iter_messages(["/gyro"]))
    assert len(messages) == COUNT


@pytest.mark.promise("Crashes")
def test_a_repair_without_checksums_is_told_each_time_the_file_is_read(tmp_path: Path) -> None:
    """A file that was repaired without checksums says so each time it is read."""
    path = tmp_path / "d.mcap"
    path.write_bytes((EARLIER / "one_axis.mcap").read_bytes().replace(b"gdcrc", b"xxxxx"))
    assert repair(path) is not None
    session = read_mcap(path)
    assert session.damage is None
    assert "repaired from a damaged file" in session.remarks[0]
    path.write_bytes(path.read_bytes().replace(b"/gyro", b"/gy\0o", 1))
    assert repair(path) is not None
    assert read_mcap(path).remarks == session.remarks


def test_samples_before_bytes_that_are_no_record_are_not_called_whole(tmp_path: Path) -> None:
    damage = loaded(tmp_path, WHOLE[: len(WHOLE) // 2] + b"\x07" * 3000, allow_damage=True).damage
    assert damage is not None
    assert not damage.is_sure
    assert "no checksum says which samples are damaged" in str(damage)
    assert str(damage).endswith("samples are there")


@pytest.mark.promise("Crashes")
@pytest.mark.parametrize("name", ["one_axis", "three_axes_and_yaw"])
@pytest.mark.parametrize("kind", ["flip", "zeros", "missing", "twice"])
def test_damage_in_a_recording_of_an_earlier_version_is_told_by_sample(tmp_path: Path, name: str, kind: str) -> None:
    """Damage in a recording of an earlier version is reported by sample."""
    path, content = tmp_path / "s.mcap", (EARLIER / f"{name}.mcap").read_bytes()
    whole = loaded(tmp_path, content)
    assert len(whole.rate_dps) == 100
    path.write_bytes(damaged(content, len(content) // 2, 0 if kind == "flip" else 512, kind))
    with pytest.raises(DamagedError, match=r"lost are samples 50 to 73 \(0.24 s, at 0.50 s\); 76 samples are whole"):
        read_mcap(path)
    kept = read_mcap(path, allow_damage=True)
    assert are_original(kept, whole)
    repaired = repair(path)
    assert repaired is not None
    assert repaired.samples == len(kept.rate_dps)
    assert b"uint32 crc32" in path.read_bytes()
    after = read_mcap(path)
    assert after.damage is None
    for column in (*COLUMNS, "device_yaw_deg"):
        assert np.array_equal(after.filled(column), kept.filled(column), equal_nan=True)


@pytest.mark.parametrize("name", ["one_axis", "three_axes_and_yaw"])
def test_an_interrupted_recording_of_an_earlier_version_is_closed(tmp_path: Path, name: str) -> None:
    path, content = tmp_path / "s.mcap", (EARLIER / f"{name}.mcap").read_bytes()
    for length in range(len(content) - 2500, content.rindex(DATA_END), 61):
        path.write_bytes(content[:length])
        samples = len(read_mcap(path).rate_dps)
        repaired = repair(path)
        assert repaired is not None
        assert (repaired.samples, repaired.damage, repaired.tail) == (samples, None, None)
        assert len(read_mcap(path).rate_dps) == samples > 70
