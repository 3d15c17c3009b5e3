"""A real `record` killed at random moments: what was older than a second is in the file, and the file can be mended."""

import signal
import time
from pathlib import Path
from random import Random

import pytest
from mcap.reader import NonSeekingReader, make_reader
from mcap.stream_reader import StreamReader
from support import Command, are_recorded, never, speaking_on

from firmware_sim.pty import PtyDevice
from gyrodrift.cli import main
from gyrodrift.session.mcap.raw import read_raw
from gyrodrift.session.mcap.read import read_mcap
from gyrodrift.session.mcap.repair import repair

KILLS = 5
"""Side by side; `make crash` kills a recording service many more times."""

PERIOD_US = 2000
FLUSHED_S = 1.0


class Speaker:
    """A device on a pty that says numbered lines in real time, and remembers when which had been read."""

    def __init__(self, device: PtyDevice) -> None:
        self.device = device
        self.said = 0
        self.read: list[tuple[float, int]] = []

    def speak(self, seconds: float) -> None:
        """Say what is due since the last time."""
        before = self.said
        for _ in range(max(1, round(seconds * 1e6 / PERIOD_US))):
            self.said += self.device.send(b"%d,%d.5\n" % (self.said * PERIOD_US, self.said % 100))
        if self.device._reader_is_done() and (not self.read or before > self.read[-1][1]):
            self.read.append((time.monotonic(), before))

    def read_in_time(self) -> int:
        """How many lines had been read FLUSHED_S before a turn of the reader's loop that it has ended since.

        Between two entries of `read` it has read. So it has ended every turn but the last, however seldom a busy
        machine lets it run.
        """
        turn_s = self.read[-4][0] if len(self.read) >= 4 else 0.0
        return max((count for read_s, count in self.read if read_s <= turn_s - FLUSHED_S), default=0)


def killed(folder: Path, moments_s: list[float], *options: str) -> list[tuple[Path, int, int]]:
    """Several recordings side by side, each killed at its moment: folder, lines said, and those read in good time."""
    from contextlib import ExitStack  # noqa: PLC0415 - of this one test

    result = []
    with ExitStack() as stack:
        ports = [folder / f"gyro{number}" for number in range(len(moments_s))]
        speakers = [Speaker(stack.enter_context(speaking_on(port))) for port in ports]
        running = [
            stack.enter_context(Command("record", "--port", port, "--out", folder / f"{port.name}-out", *options))
            for port in ports
        ]
        for speaker in speakers:
            speaker.device.wait_for_reader(never)
        remaining = dict(enumerate(moments_s))
        begun_s = last_s = time.monotonic()
        while remaining:
            now_s = time.monotonic()
            for number in remaining:
                speakers[number].speak(now_s - last_s)
            last_s = now_s
            for number in [number for number, moment_s in remaining.items() if now_s - begun_s >= moment_s]:
                running[number].process.send_signal(signal.SIGKILL)
                running[number].process.wait()
                del remaining[number]
                in_time = speakers[number].read_in_time()
                result.append((folder / f"gyro{number}-out", speakers[number].said, in_time))
            time.sleep(0.002)  # a device has its own pace
    return result


@pytest.mark.promise("Crashes")
@pytest.mark.long
@pytest.mark.parametrize("options", [(), ("--raw",)], ids=["samples", "with raw bytes"])
def test_what_is_older_than_a_second_survives_a_kill(
    tmp_path: Path, options: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    """A kill loses at most the last second of a recording."""
    random = Random(len(options))
    kept_in_all = in_time_in_all = 0
    for out, statement, in_time in killed(tmp_path, [random.uniform(0.8, 3.0) for _ in range(KILLS)], *options):
        paths = list(out.glob("*.mcap")) if out.is_dir() else []
        assert paths or not in_time
        for path in paths:
            kept = samples_in(path) if path.stat().st_size else 0
            assert in_time <= kept <= statement
            kept_in_all += kept
            in_time_in_all += in_time
            if kept:
                check_mended(path, kept)
    assert in_time_in_all > 0
    with capsys.disabled():
        print(f" [{KILLS} kills, {kept_in_all} samples kept, {in_time_in_all} had to be]", end="")


def samples_in(path: Path) -> int:
    """How many, after a look that they are the first ones of those that were said."""
    session = read_mcap(path)
    count = len(session.rate_dps)
    assert session.t_device_s.tolist() == [number * PERIOD_US / 1e6 for number in range(count)]
    assert session.rate_dps.tolist() == [number % 100 + 0.5 for number in range(count)]
    return count


def check_mended(path: Path, count: int) -> None:
    """After a repair the public reader finds the same, with its checksums."""
    assert repair(path) is not None
    check_closed(path, count)
    assert samples_in(path) == count
    assert repair(path) is None


def check_closed(path: Path, count: int) -> None:
    with path.open("rb") as file:
        assert type(list(StreamReader(file, validate_crcs=True).records)[-1]).__name__ == "Footer"
    with path.open("rb") as file:
        streamed = NonSeekingReader(file, True)
        assert sum(1 for _ in streamed.iter_messages(["/gyro"])) == count
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        times = [message.log_time for _, _, message in reader.iter_messages()]
        assert sum(1 for _ in reader.iter_messages(["/gyro"])) == count
        summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics is not None
        assert summary.statistics.message_count == len(times)
        assert (summary.statistics.message_start_time, summary.statistics.message_end_time) == (min(times), max(times))
        assert {channel.topic for channel in summary.channels.values()} <= {"/gyro", "/link", "/raw"}
        tables = {table.name: table.metadata for table in reader.iter_metadata()}
    assert tables["recording"]["protocol"] == "csv"


@pytest.mark.promise("Crashes")
def test_the_next_recording_into_the_folder_closes_what_was_killed(tmp_path: Path) -> None:
    """The next recording into the folder closes an interrupted recording."""
    ((out, _, _),) = killed(tmp_path, [2.0])
    (first,) = out.glob("*.mcap")
    count = samples_in(first)
    port = tmp_path / "again"
    with speaking_on(port) as device, Command("record", "--port", port, "--out", out, "--duration", "0.05") as record:
        device.wait_for_reader(never)
        device.send_all(b"".join(b"%d,0.5\n" % (i * 1000) for i in range(200)), never)
        assert record.end() == 0
    assert "event=repaired" in record.log
    assert f"samples={count}" in record.log
    check_closed(first, count)
    assert samples_in(first) == count
    assert len(list(out.glob("*.mcap"))) == 2
    assert main(["repair", str(out)]) == 0


def test_raw_bytes_of_a_killed_recording_are_what_was_said(tmp_path: Path) -> None:
    """Byte for byte, as far as they go."""
    port = tmp_path / "gyro"
    lines = b"".join(b"%d,0.5\n" % (i * 1000) for i in range(3000))
    with speaking_on(port) as device, Command("record", "--port", port, "--out", tmp_path / "out", "--raw") as record:
        device.wait_for_reader(never)
        device.send_all(lines, never)
        device.drain(never)
        record.until(lambda _: are_recorded(2990, tmp_path / "out", len(lines)), "samples and bytes on disk")
        record.process.kill()
    (path,) = (tmp_path / "out").glob("*.mcap")
    kept = b"".join(read.content for read in read_raw(path))
    assert kept
    assert lines.startswith(kept)
    assert repair(path) is not None
    assert b"".join(read.content for read in read_raw(path)) == kept
