"""Faults: each does what its name says, within its time, the same for the same seed, and nothing else."""

import os
from collections.abc import Callable, Iterator
from contextlib import closing, suppress
from functools import cache
from itertools import pairwise, takewhile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import serial
from support import PATIENCE_S, Command, never

from firmware_sim.faults.cable import received_at
from firmware_sim.faults.catalogue import FAULTS, FaultyCable, faulty_blocks, faulty_frames, parse_fault
from firmware_sim.faults.frames import BANNER
from firmware_sim.measure import COUNTS_MAX, Block, measure
from firmware_sim.motion.profile import load_profile
from firmware_sim.player import play
from firmware_sim.pty import PtyDevice
from firmware_sim.rig import Base, Rig
from firmware_sim.wire.encoder import Frame
from firmware_sim.wire.native import hello_frame
from firmware_sim.wire.registry import ENCODERS
from firmware_sim.yaml_file import FileError

RIG = Rig(base=Base(bias_dps=0.3))
HELLO = hello_frame(RIG.base)
LONG_S = 60.0
CABLE = {"wrong_baud", "unplug"}
SUMMED = {"bno08x-rvc", "navx"}
COUNTED = {"native", "xsens"} | SUMMED
FALSE_RATES = {"stuck_value", "full_scale"}
LASTING = [name for name, kind in FAULTS.items() if "to_s" in kind.model_fields and name not in CABLE]


def measured(seconds: float, *faults: str, block_samples: int = 300) -> list[tuple[int, ...]]:
    """Rows of (seq, t_us, host time in µs, raw rate, clipped, temperature, encoder counts)."""
    blocks = faulty_blocks(blocks_without_end(block_samples), [parse_fault(text) for text in faults])
    rows = (row for block in blocks for row in block.rows())
    return [(*row[:2], round(row[2] * 1e6), *row[3:]) for row in takewhile(lambda row: row[2] < seconds, rows)]


def blocks_without_end(block_samples: int) -> Iterator[Block]:
    return measure(RIG, load_profile("turntable"), 1, block_samples=block_samples)


def spoken(protocol: str, seconds: float, *faults: str, seed: int = 1) -> list[Frame]:
    chosen = [parse_fault(text) for text in faults]
    frames = ENCODERS[protocol].frames(faulty_blocks(blocks_without_end(300), chosen), RIG.base)
    return list(takewhile(lambda frame: frame.t_s < seconds, faulty_frames(frames, chosen, seed)))


def content_of(frames: list[Frame], from_s: float = 0.0, to_s: float = float("inf")) -> bytes:
    return b"".join(frame.content for frame in frames if from_s <= frame.t_s < to_s)


# All of them.


@cache
def spoken_without(protocol: str, seconds: float) -> list[Frame]:
    """The stream that no fault is in."""
    return spoken(protocol, seconds)


@pytest.mark.parametrize("protocol", ENCODERS)
def test_before_a_fault_begins_all_is_as_it_was(protocol: str) -> None:
    without = content_of(spoken_without(protocol, 3.0))
    assert [name for name in FAULTS if content_of(spoken(protocol, 3.0, f"{name}:from_s=3")) != without] == []


@pytest.mark.parametrize("protocol", ENCODERS)
@pytest.mark.parametrize("name", LASTING)
def test_after_it_has_ended_all_is_as_it_was(name: str, protocol: str) -> None:
    without, faulty = spoken_without(protocol, 7.0), spoken(protocol, 7.0, f"{name}:from_s=2,to_s=5")
    is_counted = name == "double_rate" and protocol in COUNTED
    if is_counted or (name in FALSE_RATES and protocol in SUMMED):
        assert [(f.t_s, f.rows) for f in faulty if f.t_s > 5.1] == [(f.t_s, f.rows) for f in without if f.t_s > 5.1]
    else:
        assert content_of(faulty, 5.1) == content_of(without, 5.1)


@pytest.mark.parametrize("protocol", ENCODERS)
def test_the_same_seed_is_the_same_stream(protocol: str) -> None:
    assert [name for name in FAULTS if spoken(protocol, 8.0, name) != spoken(protocol, 8.0, name)] == []


@pytest.mark.parametrize("name", ["bit_flips", "dropped_bytes", "duplicated_bytes", "merged_frames", "zeros"])
def test_another_seed_is_other_damage(name: str) -> None:
    assert content_of(spoken("csv", 20.0, name)) != content_of(spoken("csv", 20.0, name, seed=2))


def test_a_second_fault_leaves_the_realisation_of_the_first_alone_and_twins_have_their_own() -> None:
    """A banner in the stream does not change which bits turn."""
    flips = "bit_flips:per_kilobyte=20"
    alone, banner, twins = (
        [frame for frame in spoken("native", 20.0, flips, *extra) if frame.content != BANNER]
        for extra in ([], ["boot_banner"], [flips])
    )
    assert alone == banner
    assert content_of(twins) != content_of(spoken("native", 20.0))


@pytest.mark.parametrize("protocol", ENCODERS)
def test_all_of_them_at_once_is_still_a_stream(protocol: str) -> None:
    """Times never go back, and it goes on."""
    frames = spoken(protocol, 30.0, *FAULTS)
    assert all(a.t_s <= b.t_s for a, b in pairwise(frames))
    assert frames[-1].t_s > 29.0


@pytest.mark.parametrize("block_samples", [1, 7, 4096])
def test_measurements_do_not_depend_on_how_they_are_cut_into_blocks(block_samples: int) -> None:
    """Faults carry their state from block to block."""
    names = [
        "double_rate:to_s=4",
        "stuck_value:from_s=3,to_s=5",
        "clock_step:from_s=1",
        "reset:from_s=6",
        "rate_change",
    ]
    assert measured(9.0, *names, block_samples=block_samples) == measured(9.0, *names)


# Bytes.


def test_bits_turn_as_often_as_asked_for() -> None:
    good, bad = (content_of(spoken("native", LONG_S, *f), 2.0) for f in ([], ["bit_flips:per_kilobyte=5"]))
    assert len(good) == len(bad)
    turn = sum((a ^ b).bit_count() for a, b in zip(good, bad, strict=True))
    expected = len(good) * 0.005
    assert abs(turn - expected) < 4.0 * expected**0.5


@pytest.mark.parametrize(("name", "sign"), [("dropped_bytes", -1), ("duplicated_bytes", 1)])
def test_bytes_are_lost_or_doubled_as_often_as_asked_for(name: str, sign: int) -> None:
    good, bad = (spoken("csv", LONG_S, *f) for f in ([], [f"{name}:per_kilobyte=5"]))
    for a, b in zip(good, bad, strict=True):
        shorter, longer = (b.content, a.content) if sign < 0 else (a.content, b.content)
        rest = iter(longer)
        assert all(byte in rest for byte in shorter)
    expected = len(content_of(good, 2.0)) * 0.005
    assert abs(sign * (len(content_of(bad)) - len(content_of(good))) - expected) < 4.0 * expected**0.5


@pytest.mark.parametrize(("protocol", "end"), [("native", b"\0"), ("csv", b"\r\n"), ("witmotion", b"")])
@pytest.mark.parametrize("name", ["merged_frames", "truncated_frames"])
def test_frames_lose_their_end_or_their_tail(name: str, protocol: str, end: bytes) -> None:
    good, bad = (spoken(protocol, LONG_S, *f) for f in ([], [f"{name}:share_percent=20"]))
    hurt = [(a.content, b.content) for a, b in zip(good, bad, strict=True) if a != b]
    count = sum(frame.t_s >= 2.0 for frame in good)
    assert abs(len(hurt) - 0.2 * count) < 4.0 * (0.16 * count) ** 0.5
    for a, b in hurt:
        if name == "merged_frames":
            assert b == a[: -len(end) or -1]
        else:
            assert len(b) < len(a)
            assert b.endswith(end)
            assert a.startswith(b[: len(b) - len(end)])


@pytest.mark.parametrize("protocol", ENCODERS)
def test_zeros_cut_one_frame_in_each_interval(protocol: str) -> None:
    """A run of the length asked for, and nothing lost."""
    good, bad = (spoken(protocol, 10.0, *f) for f in ([], ["zeros:length_bytes=40,every_s=0.5,to_s=6"]))
    cut = [b.t_s for a, b in zip(good, bad, strict=True) if a != b]
    assert np.allclose(cut, np.arange(2.0, 6.0, 0.5), atol=0.0121)
    assert all(b.content.replace(bytes(40), b"", 1) == a.content for a, b in zip(good, bad, strict=True) if a != b)


@pytest.mark.parametrize("protocol", ENCODERS)
def test_the_banner_is_printed_once(protocol: str) -> None:
    frames = spoken(protocol, 6.0, "boot_banner:from_s=3")
    assert [frame.t_s for frame in frames if frame.content == BANNER] == [3.0]
    assert [frame for frame in frames if frame.content != BANNER] == spoken(protocol, 6.0)


@pytest.mark.parametrize("protocol", ENCODERS)
def test_a_stall_holds_and_then_lets_all_go_at_once(protocol: str) -> None:
    good, bad = (spoken(protocol, 12.0, *f) for f in ([], ["stall:seconds=0.5,every_s=2,to_s=7"]))
    assert content_of(good) == content_of(bad)
    for a, b in zip(good, bad, strict=True):
        kept = next((s for s in (2.0, 4.0, 6.0) if s <= a.t_s < s + 0.5), None)
        assert b.t_s == (a.t_s if kept is None else kept + 0.5)


def test_a_stall_without_a_period_happens_once() -> None:
    bad = spoken("csv", 12.0, "stall:seconds=1.5")
    assert {b.t_s - a.t_s > 1.4 for a, b in pairwise(bad)} == {True, False}
    assert sum(b.t_s - a.t_s > 1.4 for a, b in pairwise(bad)) == 1
    assert sum(frame.t_s == 3.5 for frame in bad) == 150


# Measurements.


def test_a_reset_begins_again_from_zero_after_a_silence() -> None:
    """Counter, clock and encoder; the rate goes on where the table is."""
    good, bad = measured(20.0), measured(20.0, "reset:from_s=9,silent_s=0.7")
    assert bad[:900] == good[:900]
    zero = good[970]
    for a, b in zip(good[970:], bad[900:], strict=True):
        assert b == (a[0] - zero[0], a[1] - zero[1], *a[2:6], a[6] - zero[6], a[7])
    assert zero[6] != 0


def test_hello_comes_first_after_a_reset_and_once_a_second_from_then_on() -> None:
    frames = spoken("native", 6.0, "reset:from_s=2.35,silent_s=0.5")
    after = [frame for frame in frames if frame.t_s > 2.5]
    assert after[0].content == HELLO
    at_s = [frame.t_s for frame in after if not frame.rows]
    assert at_s == pytest.approx([2.852, 3.852, 4.852, 5.852])


@pytest.mark.parametrize("step_s", [30.0, -30.0])
def test_the_clock_steps_and_hello_does_not_wait_for_it(step_s: float) -> None:
    good, bad = measured(5.0), measured(5.0, f"clock_step:step_s={step_s}")
    moved = [(b[1] - a[1], a[2] >= 2_000_000, a[0] == b[0], a[2:] == b[2:]) for a, b in zip(good, bad, strict=True)]
    assert set(moved) == {(0, False, True, True), (round(step_s * 1e6), True, True, True)}
    hellos = [frame.t_s for frame in spoken("native", 5.0, f"clock_step:step_s={step_s}") if not frame.rows]
    assert max(b - a for a, b in pairwise(hellos)) < 1.01


def test_a_clock_of_milliseconds_counts_whole_ones() -> None:
    good, bad = measured(3.0), measured(3.0, "millisecond_clock")
    assert [(row[0], row[1] // 1000, *row[2:]) for row in good] == bad


def test_a_stuck_value_is_the_last_one_before() -> None:
    good, bad = measured(15.0), measured(15.0, "stuck_value:from_s=8,to_s=11")
    assert {b[3] for b in bad[800:1100]} == {good[799][3]}
    assert [(*a[:3], *a[5:]) for a in good] == [(*b[:3], *b[5:]) for b in bad]


@pytest.mark.parametrize("sign", [1, -1])
def test_full_scale_is_at_the_rail_and_says_so(sign: int) -> None:
    bad = measured(5.0, f"full_scale:to_s=3,sign={sign}")
    assert {(row[3], row[4]) for row in bad[200:300]} == {(sign * COUNTS_MAX, True)}
    assert not any(row[4] for row in bad[:200] + bad[300:])


def test_a_rate_change_takes_fewer_measurements_and_counts_them() -> None:
    good, bad = measured(9.0), measured(9.0, "rate_change:divide=5")
    assert [row[0] for row in bad] == list(range(len(bad)))
    assert [row[1:] for row in bad] == [row[1:] for row in good[:200] + good[200::5]]


def test_the_double_rate_measures_twice_as_often_as_hello_tells() -> None:
    """The counter has no holes, the old measurements are still there, and HELLO is what it was."""
    good, bad = measured(9.0), measured(9.0, "double_rate:from_s=2,to_s=5")
    assert [row[0] for row in bad] == list(range(len(good) + 300))
    assert {row[1:] for row in good} < {row[1:] for row in bad}
    steps_us = [b[1] - a[1] for a, b in pairwise(bad)]
    assert (steps_us.count(5000), steps_us.count(10_000)) == (600, len(good) - 301)
    assert {f.content for f in spoken("native", 9.0, "double_rate") if not f.rows} == {HELLO}


# The cable.


def test_a_receiver_at_the_right_rate_hears_every_byte() -> None:
    """The line model is right where nothing is wrong."""
    assert received_at(bytes(range(256)), 9600, 9600) == bytes(range(256))


@pytest.mark.parametrize("read_baud", [4800, 19200, 115200])
def test_a_receiver_at_another_rate_hears_garbage(read_baud: int) -> None:
    """About as many bytes as its rate has room for, and none of the frames."""
    sent = content_of(spoken("csv", 2.0))
    heard = received_at(sent, 9600, read_baud)
    assert b"," not in heard or heard.count(b",") != sent.count(b",")
    assert 0.3 * len(sent) * min(1.0, read_baud / 9600) < len(heard) < 10 * len(sent)


@pytest.fixture
def link(tmp_path: Path) -> Path:
    return tmp_path / "gyro"


def test_the_line_rate_of_the_reader_decides_what_it_gets(link: Path) -> None:
    cable = FaultyCable([parse_fault("wrong_baud:baud=250000")])
    with closing(PtyDevice(link, HELLO, cable)) as device, serial.Serial(str(link), 115200, timeout=PATIENCE_S) as port:
        device.wait_for_reader(never)
        assert device.send(b"sixteen bytes!!\n")
        assert port.read(1) != HELLO[:1]
        port.baudrate = 250_000
        port.reset_input_buffer()
        device.wait_for_reader(never)
        assert device.send(b"sixteen bytes!!\n")
        assert port.read(len(HELLO) + 16) == HELLO + b"sixteen bytes!!\n"


def names_over_time(link: Path, *faults: str) -> Callable[[float], list[str]]:
    device = PtyDevice(link, b"", FaultyCable([parse_fault(text) for text in faults]))

    def names_at(t_s: float) -> list[str]:
        if t_s == float("inf"):
            device.close()
        else:
            device.live_until(t_s)
        return [path.name for path in link.parent.iterdir()]

    return names_at


@pytest.mark.parametrize(("name", "after"), [("same", ["gyro", "gyro"]), ("other", ["gyro-1", "gyro-2"])])
def test_a_plug_that_is_pulled_takes_the_name_away_and_brings_one_back(link: Path, name: str, after: list[str]) -> None:
    """It stays or moves on, and at the end there is none."""
    names_at = names_over_time(link, *(f"unplug:from_s={index},seconds=1,name={name}" for index in (2, 5)))
    times_s = (0.0, 1.99, 2.0, 2.99, 3.0, 4.99, 5.0, 6.0, float("inf"))
    observed = [names_at(t_s) for t_s in times_s]
    assert observed == [["gyro"], ["gyro"], [], [], [after[0]], [after[0]], [], [after[1]], []]


def test_a_pulled_plug_hangs_up_and_what_is_sent_meanwhile_is_lost(link: Path) -> None:
    """The reader is told, and gets what was sent before; a port that is gone takes nothing."""
    cable = FaultyCable([parse_fault("unplug:from_s=0.5,seconds=0.25,power_lost=0")])
    frames = [Frame(t_s, b"%.2f\n" % t_s, 1) for t_s in np.arange(0.0, 0.75, 0.05)]
    with closing(PtyDevice(link, b"", cable)) as device, serial.Serial(str(link), timeout=PATIENCE_S) as port:
        device.wait_for_reader(never)
        assert play(iter(frames), device, 20.0) == (10, 5)
        assert not device.is_plugged
        with pytest.raises(OSError, match="Input/output error"):
            os.write(port.fileno(), b"x")


@pytest.mark.parametrize(("power_lost", "first_us"), [(1, 0), (0, 3_000_000)])
def test_a_device_without_power_begins_anew(power_lost: int, first_us: int) -> None:
    rows = measured(6.0, f"unplug:from_s=2,seconds=1,power_lost={power_lost}")
    assert next(row[1] for row in rows if row[2] >= 3_000_000) == first_us
    assert any(2_000_000 < row[2] < 3_000_000 for row in rows) is not bool(power_lost)


# The command line.


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("bit_flip", "there is no fault 'bit_flip'; did you mean bit_flips?"),
        ("gremlins", "there is no fault 'gremlins'; there are double_rate, stuck_value,"),
        ("reset:silence=3", "silence is not known here (parameters: from_s, silent_s)"),
        ("bit_flips:per_kilobyte=-1", "per_kilobyte is -1; input should be greater than or equal to 0"),
        ("bit_flips:per_kilobyte=x", "per_kilobyte is 'x'; expected a number"),
        ("stall:from_s=5,to_s=4", "to_s is 4; expected more than from_s, which is 5.0"),
        ("stall:every_s=0.5", "every_s is 0.5; expected more than seconds, which is 1.0"),
        ("unplug:name=third", "name is 'third'; input should be 'same' or 'other'"),
    ],
)
def test_a_mistake_is_one_line_that_names_what_is_known(text: str, words: str) -> None:
    with pytest.raises(FileError) as caught:
        parse_fault(text)
    assert str(caught.value).startswith(f"--fault {text}: ")
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", FAULTS)
def test_every_fault_runs_with_nothing_said(name: str) -> None:
    fault: Any = parse_fault(name)
    assert fault.fault == name
    assert fault.from_s == (0.0 if name in {"wrong_baud", "millisecond_clock"} else 2.0)
    assert fault.__doc__


def test_a_wrong_fault_is_wrong_usage_and_help_names_the_right_ones(link: Path) -> None:
    with Command("--link", link, "--fault", "gremlins", module="firmware_sim") as command:
        assert command.end() == 2
        assert command.log.startswith("firmware_sim: --fault gremlins: ")
        assert command.log.count("\n") == 1
    with Command("--help", module="firmware_sim") as command:
        assert command.end() == 0
        assert set(FAULTS) <= set(command.out.replace(",", " ").split())


@pytest.mark.parametrize("speed", ["10", "max"])
def test_the_device_ends_well_however_fast_it_is_and_whatever_its_faults(link: Path, speed: str) -> None:
    faults = [
        word for text in ("unplug:from_s=0.5,seconds=9", "reset:from_s=0.1,silent_s=0.1") for word in ("--fault", text)
    ]
    with Command("--link", link, "--speed", speed, "--duration", "1", *faults, module="firmware_sim") as command:
        if speed == "max":
            command.until(lambda _: link.is_symlink(), "link")
            with serial.Serial(str(link), timeout=10.0) as port, suppress(serial.SerialException):
                while port.read(256):  # until the cable is pulled: at this speed the device waits for its reader
                    pass
        assert command.end() == 0
        assert not link.is_symlink()
