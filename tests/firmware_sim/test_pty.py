"""The pty: a name that stands or does not, bytes that arrive as they are, and readers that come and go."""

import os
import select
import signal
import subprocess
import sys
import termios
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from hashlib import sha256
from itertools import count
from pathlib import Path

import pytest
import serial
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support import PATIENCE_S, never, speaking_on

from firmware_sim import player, pty
from firmware_sim.player import LONGEST_NAP_S, play, play_after_each_opening, stopped_by_signals
from firmware_sim.pty import DRAIN_S, OPENING_S, LinkInUseError, PtyDevice
from firmware_sim.wire.encoder import Frame

ALL_BYTES = bytes(range(256))
MEGABYTE = ALL_BYTES * 4100

SLOW_READER = """
import hashlib, serial, sys
total, content = int(sys.argv[2]), bytearray()
with serial.Serial(sys.argv[1], timeout=240) as port:
    while len(content) < total and (piece := port.read(min(997, total - len(content)))):
        content += piece
print(hashlib.sha256(content).hexdigest())
"""


class Clock:
    """Time that passes only in sleep; put in the place of the module `time`."""

    def __init__(self) -> None:
        self.now_s = 1000.0
        self.naps_s: list[float] = []
        self.while_asleep: Callable[[], object] = never

    def monotonic(self) -> float:
        return self.now_s

    def sleep(self, seconds: float) -> None:
        self.naps_s.append(seconds)
        self.now_s += seconds
        self.while_asleep()


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    for module in (pty, player):
        monkeypatch.setattr(module, "time", clock)
    return clock


@pytest.fixture
def link(tmp_path: Path) -> Path:
    return tmp_path / "gyro"


@pytest.fixture
def device(link: Path) -> Iterator[PtyDevice]:
    with speaking_on(link) as device:
        yield device


@contextmanager
def pyserial_on(device: PtyDevice) -> Iterator[serial.Serial]:
    """A reader as people write it, once the device knows that it is there."""
    with serial.Serial(str(device.link), timeout=PATIENCE_S) as port:
        device.wait_for_reader(never)
        yield port


@contextmanager
def raw_on(device: PtyDevice) -> Iterator[int]:
    """A reader that opens the port and does nothing else, as cat does."""
    fd = os.open(device.link, os.O_RDWR | os.O_NOCTTY)
    try:
        yield fd
    finally:
        os.close(fd)


def wait_for_bytes(fd: int) -> None:
    assert select.select([fd], [], [], PATIENCE_S)[0], "nothing arrives"


def read_up_to(fd: int, end: bytes) -> bytes:
    """All bytes up to the first that end so; a pty hands on what was written at once in as many pieces as it likes."""
    content = b""
    while not content.endswith(end):
        wait_for_bytes(fd)
        content += os.read(fd, 1000)
    return content


def names_in(folder: Path) -> list[str]:
    return [path.name for path in folder.iterdir()]


def frames_at(*times_s: float) -> list[Frame]:
    return [Frame(t_s, f"{t_s}\n".encode(), 1) for t_s in times_s]


# The name.


def test_the_name_leads_to_the_pty_and_is_gone_at_the_end(link: Path) -> None:
    with speaking_on(link) as device:
        assert str(link.readlink()) == device.slave_name
        assert names_in(link.parent) == [link.name]
    assert names_in(link.parent) == []


def test_folders_on_the_way_to_the_name_are_made(link: Path) -> None:
    """A name in a folder that is not there yet is no mistake."""
    with speaking_on(link / "by-id" / "gyro") as device:
        assert device.link.is_symlink()


def test_a_link_of_an_earlier_device_is_replaced(link: Path) -> None:
    """A name left by a device that was killed leads to the new one."""
    link.symlink_to("/dev/pts/gone")
    with speaking_on(link) as device:
        assert str(link.readlink()) == device.slave_name
        assert names_in(link.parent) == [link.name]


def test_the_name_is_never_missing_while_it_is_replaced(link: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The old link stands until the new one takes its place in one step."""
    link.symlink_to("/dev/pts/gone")
    stood: list[str] = []
    replace = Path.replace

    def spy(fresh: Path, name: Path) -> Path:
        stood.append(str(name.readlink()))
        return replace(fresh, name)

    monkeypatch.setattr(Path, "replace", spy)
    with speaking_on(link):
        assert stood == ["/dev/pts/gone"]


@pytest.mark.parametrize("make", [Path.touch, Path.mkdir])
def test_what_is_no_link_is_not_replaced(link: Path, make: Callable[[Path], None]) -> None:
    """A file or folder at the name stays, and the message says what to do."""
    make(link)
    with pytest.raises(LinkInUseError, match=r"gyro exists and is not a link to a pty; choose another name"):
        PtyDevice(link)
    assert not link.is_symlink()
    assert names_in(link.parent) == [link.name]


def test_a_name_that_cannot_be_made_is_told_with_its_cause(link: Path) -> None:
    """A file where a folder would have to be is such a case."""
    link.touch()
    with pytest.raises(LinkInUseError, match=r"gyro/port cannot be made: "):
        PtyDevice(link / "port")


def test_a_name_that_cannot_be_replaced_leaves_nothing(link: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_fresh: Path, _name: Path) -> Path:
        raise PermissionError(1, "Operation not permitted")

    link.symlink_to("/dev/pts/gone")
    monkeypatch.setattr(Path, "replace", refuse)
    with pytest.raises(LinkInUseError, match="not permitted"):
        PtyDevice(link)
    assert names_in(link.parent) == [link.name]


def test_the_name_of_another_device_is_left_to_it(link: Path) -> None:
    """A device whose name was taken over does not take it away when it ends."""
    with speaking_on(link) as newer:
        with speaking_on(link.with_name("other")) as older:
            older.link = link
        assert str(link.readlink()) == newer.slave_name


def test_a_name_that_is_gone_already_is_no_trouble_at_the_end(device: PtyDevice) -> None:
    device.link.unlink()
    device.close()
    assert not device.link.is_symlink()


# Bytes.


def test_every_byte_arrives_unchanged(device: PtyDevice) -> None:
    """Zeros, line ends, interrupts and flow control are bytes like all others, in one piece or alone."""
    with pyserial_on(device) as port:
        assert device.send(ALL_BYTES)
        assert all(device.send(bytes([byte])) for byte in ALL_BYTES)
        assert port.read(512) == ALL_BYTES * 2


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.binary(min_size=1, max_size=300), min_size=1, max_size=10))
def test_any_bytes_arrive_unchanged(tmp_path_factory: pytest.TempPathFactory, contents: list[bytes]) -> None:
    with speaking_on(tmp_path_factory.mktemp("any") / "gyro") as device, pyserial_on(device) as port:
        assert all(device.send(content) for content in contents)
        assert port.read(sum(map(len, contents))) == b"".join(contents)


def test_every_byte_arrives_at_a_reader_that_sets_nothing(device: PtyDevice) -> None:
    """The pty is raw from the start: cat and screen see what pyserial sees."""
    with raw_on(device) as fd:
        assert device.send(ALL_BYTES)
        assert read_up_to(fd, ALL_BYTES[-1:]) == ALL_BYTES


def test_what_the_reader_says_is_not_echoed(device: PtyDevice) -> None:
    """Commands to the device are taken and dropped; they do not come back as measurements."""
    with pyserial_on(device) as port:
        port.write(b"RATE 100\r\n\x03")
        assert device.send(b"after")
        assert port.read(5) == b"after"


# Readers.


def test_without_a_reader_nothing_is_sent(device: PtyDevice) -> None:
    """The device is told so, and whoever comes later does not get it."""
    assert not device.has_reader()
    assert not device.send(b"lost")
    assert not device.send_all(b"lost", never)
    with pyserial_on(device) as port:
        assert device.send(b"found")
        assert port.read(5) == b"found"


def test_readers_come_and_go(device: PtyDevice) -> None:
    for content in (b"one", b"two", b"six"):
        with pyserial_on(device) as port:
            assert device.has_reader()
            assert device.send(content)
            assert port.read(3) == content
        assert not device.has_reader()
        assert not device.send(content)


def test_every_fresh_reader_is_greeted_first(link: Path) -> None:
    """The greeting stands before everything else, for the first reader and for the next."""
    with closing(PtyDevice(link, b"hello")) as device:
        for content in (b"one", b"two"):
            with pyserial_on(device) as port:
                assert device.send(content)
                assert port.read(8) == b"hello" + content


def test_a_reader_that_only_opens_the_port_is_waited_for_no_longer_than_it_takes(
    device: PtyDevice, clock: Clock
) -> None:
    with raw_on(device):
        device.wait_for_reader(never)
    assert OPENING_S < clock.now_s - 1000.0 < OPENING_S + 0.02


def test_the_wait_for_a_reader_ends_when_all_is_over(device: PtyDevice, clock: Clock) -> None:
    """A device that is stopped does not wait for a reader any more."""
    device.wait_for_reader(lambda: clock.now_s > 1003.0)
    assert not device.has_reader()


def test_a_reader_too_slow_misses_whole_sends_and_gets_no_halves(device: PtyDevice) -> None:
    with pyserial_on(device) as port:
        taken, got = bytearray(), bytearray()
        for number in count():
            content = bytes([number % 256]) * 1000
            if not device.send(content):
                break
            taken += content
        while not device.send(b"the end"):
            got += port.read(port.in_waiting)
        taken += b"the end"
        assert got + port.read(len(taken) - len(got)) == taken


def test_a_megabyte_reaches_a_slow_reader_in_another_process(device: PtyDevice) -> None:
    """A reader that takes small pieces at its own pace gets every byte of send_all."""
    command = [sys.executable, "-c", SLOW_READER, str(device.link), str(len(MEGABYTE))]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as reader:
        device.wait_for_reader(lambda: reader.poll() is not None)
        for start in range(0, len(MEGABYTE), 40_000):
            assert device.send_all(MEGABYTE[start : start + 40_000], lambda: reader.poll() is not None)
        assert reader.communicate(timeout=PATIENCE_S)[0].strip() == sha256(MEGABYTE).hexdigest()


def test_send_all_goes_on_as_the_reader_makes_room(device: PtyDevice) -> None:
    content, got = MEGABYTE[:40_000], bytearray()
    with pyserial_on(device) as port:

        def read_a_bit() -> bool:
            got.extend(port.read(port.in_waiting))
            return False

        assert device.send_all(content, read_a_bit)
        assert got + port.read(len(content) - len(got)) == content


def test_send_all_gives_up_when_the_reader_leaves(device: PtyDevice) -> None:
    """A reader that goes in the middle ends it, and the next one does not get the rest."""
    with pyserial_on(device) as port:

        def leave_in_the_middle() -> bool:
            if port.is_open and port.in_waiting:
                port.close()
            return False

        assert not device.send_all(MEGABYTE, leave_in_the_middle)
    with pyserial_on(device) as port:
        assert device.send_all(b"fresh", never)
        assert port.read(5) == b"fresh"


def test_what_is_sent_after_a_flush_is_not_lost(link: Path) -> None:
    """A reader that empties its buffer loses what was before that, and nothing that is sent later."""
    with closing(PtyDevice(link, b"hello")) as device, pyserial_on(device) as port:
        assert device.send_all(b"before", never)
        wait_for_bytes(port.fileno())
        port.reset_input_buffer()
        assert device.send_all(b"after", never)
        assert port.read(10) == b"helloafter"


def test_drain_waits_until_all_is_read(device: PtyDevice, clock: Clock) -> None:
    with pyserial_on(device) as port:
        got = bytearray()
        clock.while_asleep = lambda: got.extend(port.read(min(10, 256 - len(got))))
        assert device.send(ALL_BYTES)
        device.drain()
        assert got == ALL_BYTES


def test_drain_does_not_wait_for_a_reader_for_ever(device: PtyDevice, clock: Clock) -> None:
    """A reader that is there and does not read gets its time, and no more."""
    with pyserial_on(device) as port:
        assert device.send(b"never read")
        wait_for_bytes(port.fileno())
        clock.now_s = 1000.0
        device.drain()
        assert DRAIN_S <= clock.now_s - 1000.0 < DRAIN_S + 0.02


def test_drain_waits_for_a_late_reader_until_it_is_over(device: PtyDevice, clock: Clock) -> None:
    with pyserial_on(device) as port:
        assert device.send(b"never read")
        wait_for_bytes(port.fileno())
        clock.now_s = 1000.0
        device.drain(lambda: clock.now_s > 1000.0 + 5.0 * DRAIN_S)
        assert clock.now_s > 1000.0 + 5.0 * DRAIN_S


def test_drain_without_a_reader_ends_at_once(device: PtyDevice, clock: Clock) -> None:
    device.drain()
    assert not clock.naps_s


# The pace.


@pytest.mark.parametrize("speed", [0.5, 1.0, 20.0])
def test_frames_leave_at_their_times(
    device: PtyDevice, clock: Clock, monkeypatch: pytest.MonkeyPatch, speed: float
) -> None:
    """A frame is sent its own time after the start, by the speed."""
    left_s: list[float] = []

    def send(_content: bytes) -> bool:
        left_s.append(clock.now_s - 1000.0)
        return True

    monkeypatch.setattr(device, "send", send)
    times_s = (0.0, 0.01, 0.5, 3.0)
    assert play(iter(frames_at(*times_s)), device, speed) == (4, 0)
    assert left_s == pytest.approx([t_s / speed for t_s in times_s])


def test_a_device_without_reader_counts_what_is_lost(device: PtyDevice, clock: Clock) -> None:
    frames = [Frame(0.0, b"hello", 0), *frames_at(0.0, 1.0, 2.0)]
    assert play(iter(frames), device, 1.0) == (0, 3)
    assert clock.now_s == pytest.approx(1002.0)


@pytest.mark.parametrize("speed", [1.0, None])
def test_each_reader_gets_all_frames_from_the_first(device: PtyDevice, clock: Clock, speed: float | None) -> None:
    """A board that is reset by opening its port starts over for the second reader."""
    frames, ports = frames_at(0.0, 1.0, 2.0), [serial.Serial(str(device.link), timeout=PATIENCE_S)]
    got: list[bytes] = []
    content = b"".join(frame.content for frame in frames)

    def read_and_open_again() -> bool:
        if not ports[-1].is_open:
            ports.append(serial.Serial(str(device.link), timeout=PATIENCE_S))
        elif ports[-1].in_waiting == len(content):
            got.append(ports[-1].read(len(content)))
            ports[-1].close()
        return len(got) == 2

    counts = play_after_each_opening(lambda: iter(frames), device, speed, read_and_open_again)
    ports[-1].close()
    assert (counts, got) == ((6, 0), [content, content])
    assert clock.now_s < 2000.0


def test_a_long_rest_between_frames_can_be_ended(device: PtyDevice, clock: Clock) -> None:
    """The device asks often whether all is over, even where the next frame is an hour away."""
    play(iter(frames_at(0.0, 3600.0)), device, 1.0, is_over=lambda: clock.now_s > 1001.0)
    assert clock.now_s < 1001.0 + 2 * LONGEST_NAP_S
    assert max(clock.naps_s) <= LONGEST_NAP_S


def test_at_full_speed_nothing_is_lost_while_nobody_reads(device: PtyDevice, monkeypatch: pytest.MonkeyPatch) -> None:
    """The device waits for its reader and starts with the very first frame."""
    frames = frames_at(*range(20))
    ports: list[serial.Serial] = []

    def come_late() -> bool:
        if not ports:
            ports.append(serial.Serial(str(device.link), timeout=PATIENCE_S))
        return False

    wait = device.wait_for_reader
    monkeypatch.setattr(device, "wait_for_reader", lambda _is_over: wait(come_late))
    assert play(iter(frames), device, None) == (20, 0)
    with ports[0] as port:
        content = b"".join(frame.content for frame in frames)
        assert port.read(len(content)) == content


def test_at_full_speed_nothing_is_lost_to_a_reader_who_is_just_opening(device: PtyDevice) -> None:
    """A port that is open and not yet flushed is not spoken to, since pyserial would throw that away."""
    request = count()
    frames = [*frames_at(0.0, 1.0), Frame(2.0, b"end\n", 0)]
    with raw_on(device) as fd:

        def flush_later() -> bool:
            if next(request) == 4:
                termios.tcflush(fd, termios.TCIFLUSH)
            return False

        assert play(iter(frames), device, None, is_over=flush_later) == (2, 0)
        assert read_up_to(fd, b"end\n") == b"0.0\n1.0\nend\n"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_and_the_old_handlers_come_back(number: int) -> None:
    before = signal.getsignal(number)
    with stopped_by_signals() as is_over:
        assert not is_over()
        os.kill(os.getpid(), number)
        assert is_over()
    assert signal.getsignal(number) is before
