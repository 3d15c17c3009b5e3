"""Closing what a kill left open: whole records stay, public readers accept the file, and a repair repairs itself."""

import fcntl
import io
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import IO

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from mcap.reader import NonSeekingReader, make_reader
from mcap.stream_reader import StreamReader
from mcap.writer import Writer
from support import quick

from gyrodrift.cli import main
from gyrodrift.session.files import session_paths
from gyrodrift.session.mcap import ending as looking
from gyrodrift.session.mcap.ending import interrupted
from gyrodrift.session.mcap.layout import MESSAGE
from gyrodrift.session.mcap.raw import raw_size, read_raw
from gyrodrift.session.mcap.read import read_mcap
from gyrodrift.session.mcap.repair import repair
from gyrodrift.session.mcap.write import McapWriter
from gyrodrift.values.errors import DataError
from gyrodrift.values.sample import Sample

METADATA = {"device": {"device_id": "bench"}}


STRIDE = 4
"""Bytes from one cut to the next: every field of a record, the shortest of which has 4 bytes, is cut."""


def sample(number: int) -> Sample:
    return Sample(number, number / 100, 1.7e9 + number / 100, 0.5 * number, 0.1 * number, 25.0)


def written(*, is_finished: bool = False, samples: int = 20) -> bytes:
    """Samples in runs of five, and between them raw bytes, events and a table."""
    stream = io.BytesIO()
    writer = McapWriter(stream, METADATA)
    for number in range(samples):
        writer.add(sample(number))
        if number % 5 == 4:
            writer.add_read(b"x" * number, 1.7e9 + number / 100)
            writer.add_event("gap", 1.7e9 + number / 100, {"missing": number})
            writer.flush()
    writer.add_metadata("link", {"samples": str(samples)})
    if is_finished:
        writer.finish()
    return stream.getvalue()


def whole_messages(content: bytes) -> dict[str, int]:
    """How many messages of `content` are whole, by channel, by walking its heads."""
    position, counts = 8, {"/gyro": 0, "/raw": 0, "/link": 0}
    while position + 9 <= len(content):
        length = int.from_bytes(content[position + 1 : position + 9], "little")
        if position + 9 + length > len(content):
            break
        if content[position] == 5:
            counts[list(counts)[content[position + 9] - 1]] += 1
        position += 9 + length
    return counts


def messages(path: Path) -> dict[str, int]:
    """How many messages a public reader finds, by channel."""
    with path.open("rb") as file:
        topics = [channel.topic for _, channel, _ in make_reader(file, validate_crcs=True).iter_messages()]
    return {topic: topics.count(topic) for topic in ("/gyro", "/raw", "/link")}


def public(path: Path) -> list[tuple[int, float]]:
    """Sequence and log time of the samples, by the public readers with every check they have."""
    with path.open("rb") as file:
        records = list(StreamReader(file, validate_crcs=True).records)
    assert type(records[-1]).__name__ == "Footer"
    with path.open("rb") as file:
        streamed = [message.sequence for _, _, message in NonSeekingReader(file, True).iter_messages(["/gyro"])]
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics is not None
        result = [(message.sequence, message.log_time * 1e-9) for _, _, message in reader.iter_messages(["/gyro"])]
        every = sum(1 for _ in reader.iter_messages())
        names = [index.name for index in summary.metadata_indexes]
        assert [record.name for record in reader.iter_metadata()] == names
    assert summary.statistics.message_count == every
    assert sum(summary.statistics.channel_message_counts.values()) == every
    assert streamed == [sequence for sequence, _ in result]
    return result


@pytest.mark.parametrize("is_finished", [True, False])
def test_torn_at_any_byte_it_is_closed_with_every_whole_message(tmp_path: Path, is_finished: bool) -> None:  # noqa: FBT001 - a parameter of a test
    """Samples, raw bytes and events."""
    content = written(is_finished=is_finished)
    path = tmp_path / "s.mcap"
    for length in range(len(content) - 900, len(content), STRIDE):
        path.write_bytes(content[:length])
        whole = whole_messages(content[:length])
        expected = whole["/gyro"]
        done = repair(path)
        assert done is not None
        assert (done.samples, done.tail) == (expected, None)
        assert [sequence for sequence, _ in public(path)] == list(range(expected))
        assert messages(path) == whole
        assert read_mcap(path).rate_dps.tolist() == [0.5 * number for number in range(expected)]
        assert repair(path) is None


def test_a_repair_that_is_cut_off_is_repaired(tmp_path: Path) -> None:
    path = tmp_path / "s.mcap"
    path.write_bytes(written())
    repair(path)
    repaired = path.read_bytes()
    for length in range(len(written()), len(repaired), STRIDE):
        path.write_bytes(repaired[:length])
        assert repair(path) is not None
        assert path.read_bytes() == repaired


def test_a_closed_file_stays_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "s.mcap"
    path.write_bytes(written(is_finished=True))
    before = path.stat().st_mtime_ns
    assert repair(path) is None
    assert (path.stat().st_mtime_ns, path.read_bytes()) == (before, written(is_finished=True))


@pytest.mark.promise("Crashes")
@pytest.mark.parametrize("content", [b"", b"\x89MC", b"\x89MCAP0\r\n", bytes(4096)], ids=["none", "3", "8", "zeros"])
def test_a_recording_that_had_not_begun_is_in_nobodys_way(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], content: bytes
) -> None:
    """A recording that was killed before its first sample does not stop other commands."""
    bare, whole = tmp_path / "s.mcap", tmp_path / "t.mcap"
    bare.write_bytes(content)
    whole.write_bytes(written(is_finished=True))
    assert main(["info", str(tmp_path)]) == 0
    assert session_paths([tmp_path]) == [whole]
    assert list(interrupted(tmp_path)) == []
    for words in (["info", str(bare)], ["repair", str(bare)]):
        assert main(words) == 4
        assert "nothing was recorded" in capsys.readouterr().err
    assert bare.read_bytes() == content


def test_zeros_of_a_power_cut_are_cut_off(tmp_path: Path) -> None:
    """A page that was given to the file and never written."""
    path = tmp_path / "s.mcap"
    path.write_bytes(written() + bytes(4096))
    done = repair(path)
    assert done is not None
    assert (done.samples, done.cut_bytes, done.tail) == (20, 4096, None)
    assert len(public(path)) == 20


def test_bytes_that_are_no_torn_record_are_kept_beside(tmp_path: Path) -> None:
    garbage = np.random.default_rng(3).bytes(500)
    path = tmp_path / "s.mcap"
    path.write_bytes(written() + garbage)
    done = repair(path)
    assert done is not None
    assert done.tail == tmp_path / "s.mcap.tail"
    assert done.tail.read_bytes() == garbage
    assert len(public(path)) == 20
    path.write_bytes(written() + garbage[1:])
    again = repair(path)
    assert again is not None
    assert again.tail == tmp_path / "s.mcap.tail_2"
    assert (again.tail.read_bytes(), done.tail.read_bytes()) == (garbage[1:], garbage)


def test_a_hole_before_the_last_bytes_stays_one(tmp_path: Path) -> None:
    path = tmp_path / "s.mcap"
    path.write_bytes(written() + b"\xfegarbage" * 100)
    os.truncate(path, 1 << 36)
    with path.open("ab") as file:
        file.write(b"end")
    done = repair(path)
    assert done is not None
    assert done.tail is not None
    with done.tail.open("rb") as tail:
        assert tail.read(800) == b"\xfegarbage" * 100
        assert tail.seek(-3, os.SEEK_END) + 3 == done.cut_bytes
        assert tail.read() == b"end"
    assert done.tail.stat().st_blocks * 512 < 1 << 24


def test_raw_bytes_and_events_survive_too(tmp_path: Path) -> None:
    path = tmp_path / "s.mcap"
    path.write_bytes(written()[:-20])
    repair(path)
    assert [read.content for read in read_raw(path)] == [b"x" * number for number in (4, 9, 14, 19)]
    assert raw_size(path) == (4, 46)
    with path.open("rb") as file:
        events = [json.loads(message.data) for _, _, message in make_reader(file).iter_messages(["/link"])]
    assert [event["missing"] for event in events] == [4, 9, 14, 19]


records = st.lists(st.sampled_from(["sample", "read", "event", "metadata", "flush"]), max_size=60)


@given(records, st.floats(0.0, 1.0))
def test_whatever_was_recorded_and_wherever_it_was_cut(
    tmp_path_factory: pytest.TempPathFactory, kinds: list[str], share: float
) -> None:
    """The samples are the first ones of those recorded, and the public readers agree."""
    stream = io.BytesIO()
    writer = McapWriter(stream, METADATA)
    start = len(stream.getvalue())
    number = 0
    for position, kind in enumerate(kinds):
        match kind:
            case "sample":
                writer.add(sample(number))
                number += 1
            case "read":
                writer.add_read(bytes(position), 1.7e9)
            case "event":
                writer.add_event("gap", 1.7e9, {})
            case "metadata":
                writer.add_metadata(f"table {position}", {})
            case _:
                writer.flush()
    content = stream.getvalue()
    content = content[: start + round(share * (len(content) - start))]
    path = tmp_path_factory.mktemp("s") / "s.mcap"
    path.write_bytes(content)
    done = repair(path)
    assert done is not None
    assert done.samples == whole_messages(content)["/gyro"] <= number
    assert [sequence for sequence, _ in public(path)] == list(range(done.samples))


def of_another_program() -> bytes:
    stream = io.BytesIO()
    writer = Writer(stream, use_chunking=False)
    writer.start(library="somebody's")
    channel = writer.register_channel("/x", "json", 0)
    writer.add_message(channel, 0, b"{}" * 100, 0)
    return stream.getvalue()


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (of_another_program(), "it was written by another program"),
        (b"", "nothing was recorded into it"),
        (b"t_device_s,rate_dps\n", "it does not begin as an MCAP file"),
    ],
)
def test_what_is_not_ours_is_left_alone(tmp_path: Path, content: bytes, message: str) -> None:
    path = tmp_path / "s.mcap"
    path.write_bytes(content)
    with pytest.raises(DataError, match=message):
        repair(path)
    assert path.read_bytes() == content


@pytest.fixture
def in_use(tmp_path: Path) -> Iterator[Path]:
    """A file that somebody is writing."""
    path = tmp_path / "s.mcap"
    path.write_bytes(written())
    with path.open("rb") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield path


def test_a_file_that_is_being_written_is_left_alone(in_use: Path) -> None:
    with pytest.raises(DataError, match="is being written by another process"):
        repair(in_use)
    assert list(interrupted(in_use.parent)) == []
    assert in_use.read_bytes() == written()


def test_only_files_that_were_never_closed_are_interrupted(tmp_path: Path) -> None:
    for name, content in {"b": written(), "a": written()[:-3], "c": written(is_finished=True)}.items():
        (tmp_path / f"{name}.mcap").write_bytes(content)
    (tmp_path / "folder.mcap").mkdir()
    (tmp_path / "notes.txt").write_text("x")
    assert [path.name for path in interrupted(tmp_path)] == ["a.mcap", "b.mcap"]


def test_the_command_closes_a_folder_and_tells_what_it_did(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.mcap").write_bytes(of_another_program())
    (tmp_path / "b.mcap").write_bytes(written()[: -MESSAGE.size])
    (tmp_path / "c.mcap").write_bytes(written(is_finished=True))
    assert main(["repair", str(tmp_path)]) == 4
    statement = capsys.readouterr()
    assert "a.mcap: cannot be repaired: it was written by another program" in statement.err
    assert f"{tmp_path / 'b.mcap'}: closed, 19 samples, " in statement.out
    assert f"{tmp_path / 'c.mcap'}: is whole" in statement.out
    assert len(public(tmp_path / "b.mcap")) == 19


def test_a_path_that_is_not_there_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["repair", str(tmp_path / "x.mcap")]) == 4
    assert capsys.readouterr().err == f"gyrodrift: {tmp_path / 'x.mcap'}: there is no such file or folder\n"


def test_torn_inside_its_first_records_it_is_closed_or_left_alone(tmp_path: Path) -> None:
    """Closed from where it says that it is ours; before that nobody knows whose it is, and nothing is in it."""
    content = written(samples=1)
    header_end = 8 + 9 + int.from_bytes(content[9:17], "little")
    path = tmp_path / "s.mcap"
    for length in range(len(content)):
        path.write_bytes(content[:length])
        if length < header_end:
            with pytest.raises(DataError, match=r"nothing was recorded|before it says which program"):
                repair(path)
            assert path.read_bytes() == content[:length]
        else:
            done = repair(path)
            assert done is not None
            assert len(public(path)) == done.samples == whole_messages(content[:length])["/gyro"]


@pytest.mark.parametrize("library", [b"gyrodrift", b"somebody's"])
def test_a_file_that_ends_before_it_says_whose_it_is_stays_as_it_is(tmp_path: Path, library: bytes) -> None:
    content = written() if library == b"gyrodrift" else of_another_program()
    path = tmp_path / "s.mcap"
    path.write_bytes(content[: content.index(library) + 3])
    with pytest.raises(DataError, match="it ends before it says which program wrote it"):
        repair(path)
    assert path.read_bytes() == content[: content.index(library) + 3]


@pytest.mark.parametrize("zeros", quick([1, 83, 4096, 200_000], 4096))
def test_a_sample_that_ends_in_zeros_of_a_power_cut_is_not_made_up(tmp_path: Path, zeros: int) -> None:
    """A page boundary falls anywhere in a sample; what is torn there must not be read with zeros for values."""
    path = tmp_path / "s.mcap"
    content = written(samples=19)
    content = content[: content.rindex(b"\x0c")]  # without the table
    whole = whole_messages(content)["/gyro"]
    assert whole == 19
    for torn in range(1, MESSAGE.size):
        path.write_bytes(content[:-torn] + bytes(torn + zeros))
        assert len(read_mcap(path).rate_dps) == whole - 1
        done = repair(path)
        assert done is not None
        assert (done.samples, done.tail) == (whole - 1, None)
        assert [sequence for sequence, _ in public(path)] == list(range(whole - 1))


def test_a_whole_sample_before_zeros_of_a_power_cut_is_kept(tmp_path: Path) -> None:
    path, count = tmp_path / "s.mcap", 0
    for first in range(600):
        stream = io.BytesIO()
        writer = McapWriter(stream)
        writer.add_all(sample(first + number) for number in range(2))
        writer.flush()
        count += stream.getvalue().endswith(b"\0")
        if stream.getvalue().endswith(b"\0"):
            path.write_bytes(stream.getvalue() + bytes(4096))
            assert len(read_mcap(path).rate_dps) == 2
            assert repair(path) is not None
            assert len(public(path)) == 2
    assert count


def test_a_read_that_ends_in_zeros_of_a_power_cut_is_not_made_up(tmp_path: Path) -> None:
    path = tmp_path / "s.mcap"
    path.write_bytes(written()[: written().rindex(b"x" * 19) + 5] + bytes(4096))
    assert [len(read.content) for read in read_raw(path)] == [4, 9, 14]
    assert repair(path) is not None
    assert [len(read.content) for read in read_raw(path)] == [4, 9, 14]


def record_end(content: bytes) -> int:
    position = 8
    while position + 9 <= len(content) and position + 9 + int.from_bytes(
        content[position + 1 : position + 9], "little"
    ) <= len(content):
        position += 9 + int.from_bytes(content[position + 1 : position + 9], "little")
    return position + 9 + int.from_bytes(content[position + 1 : position + 9], "little")


@given(st.floats(0.0, 1.0), st.integers(1, 5000))
def test_zeros_behind_any_cut_make_nothing_up(
    tmp_path_factory: pytest.TempPathFactory, share: float, zeros: int
) -> None:
    content, start = written(), len(written(samples=0)) // 2
    content = content[: start + round(share * (len(content) - start))]
    assume(record_end(content) != len(content) + zeros)
    path = tmp_path_factory.mktemp("s") / "s.mcap"
    path.write_bytes(content + bytes(zeros))
    done = repair(path)
    assert done is not None
    assert done.samples == whole_messages(content)["/gyro"]
    assert read_rates(path) == [0.5 * number for number in range(done.samples)]


def read_rates(path: Path) -> list[float]:
    """The rates in a file, perhaps none."""
    return read_mcap(path).rate_dps.tolist() if public(path) else []


@pytest.mark.parametrize("cut", [0, 1, 100, 500])
def test_bytes_behind_an_end_are_kept_beside(tmp_path: Path, cut: int) -> None:
    garbage = np.random.default_rng(4).bytes(500)
    finished = written(is_finished=True)
    path = tmp_path / "s.mcap"
    path.write_bytes(finished[: len(finished) - cut] + garbage)
    done = repair(path)
    assert done is not None
    assert done.tail is not None
    assert done.tail.read_bytes().endswith(garbage)
    assert path.read_bytes() == finished


@pytest.mark.parametrize("cut", [0, 1, 100, 500])
def test_zeros_behind_an_end_are_cut_off(tmp_path: Path, cut: int) -> None:
    finished = written(is_finished=True)
    path = tmp_path / "s.mcap"
    path.write_bytes(finished[: len(finished) - cut] + bytes(3000))
    done = repair(path)
    assert done is not None
    assert done.tail is None
    assert path.read_bytes() == finished


def test_a_repair_that_is_cut_off_after_it_saved_a_tail_keeps_it(tmp_path: Path) -> None:
    garbage = np.random.default_rng(5).bytes(50)
    path = tmp_path / "s.mcap"
    path.write_bytes(written() + garbage)
    repair(path)
    repaired = path.read_bytes()
    for length in range(len(written()), len(repaired), STRIDE):
        path.write_bytes(repaired[:length])
        repair(path)
        assert path.read_bytes() == repaired
        assert (tmp_path / "s.mcap.tail").read_bytes() == garbage


def test_a_message_too_short_to_be_one_is_told(tmp_path: Path) -> None:
    content = written() + b"\x05" + (3).to_bytes(8, "little") + b"abc"
    path = tmp_path / "s.mcap"
    path.write_bytes(content)
    with pytest.raises(DataError, match="cannot be repaired: a message is too short"):
        repair(path)
    assert path.read_bytes() == content


@given(st.lists(st.tuples(st.integers(8, len(written()) - 1), st.integers(0, 255)), min_size=1, max_size=5))
def test_whatever_is_damaged_in_a_file_it_is_mended_or_told(
    tmp_path_factory: pytest.TempPathFactory, damage: list[tuple[int, int]]
) -> None:
    """A recording begins with a look at its folder, and must not end with it."""
    content = bytearray(written())
    for position, byte in damage:
        content[position] = byte
    path = tmp_path_factory.mktemp("s") / "s.mcap"
    path.write_bytes(content)
    try:
        done = repair(path)
    except DataError:
        assert path.read_bytes() == content
    else:
        assert done is not None
        assert repair(path) is None


HOLD = (
    "import fcntl, sys; f = open(sys.argv[1], 'rb'); fcntl.flock(f, fcntl.LOCK_EX); print('held', flush=True); input()"
)


def test_a_file_that_another_process_writes_is_left_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "s.mcap"
    path.write_bytes(written())
    command = [sys.executable, "-c", HOLD, str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as holder:
        assert holder.stdout is not None
        assert holder.stdout.readline() == "held\n"
        assert list(interrupted(tmp_path)) == []
        assert main(["repair", str(tmp_path)]) == 4
        assert "is being written by another process" in capsys.readouterr().err
        assert path.read_bytes() == written()
        holder.kill()
    assert list(interrupted(tmp_path)) == [path]
    assert main(["repair", str(tmp_path)]) == 0


def test_a_file_that_cannot_be_looked_into_does_not_hide_the_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("a", "b", "c"):
        (tmp_path / f"{name}.mcap").write_bytes(written())
    real = looking.is_closed

    def refusing(file: IO[bytes]) -> bool:
        if file.name.endswith("b.mcap"):
            raise PermissionError(13, "Permission denied")
        return real(file)

    monkeypatch.setattr(looking, "is_closed", refusing)
    assert [path.name for path in interrupted(tmp_path)] == ["a.mcap", "c.mcap"]


def test_a_folder_with_the_name_of_a_session_is_no_session(tmp_path: Path) -> None:
    (tmp_path / "folder.mcap").mkdir()
    (tmp_path / "a.mcap").write_bytes(written())
    assert main(["repair", str(tmp_path)]) == 0
