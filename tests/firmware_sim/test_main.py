"""The command `python -m firmware_sim`, as a process and through its pty."""

import signal
import subprocess
import sys
from contextlib import redirect_stderr
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
import serial
from golden_frames import HELLO
from support import PATIENCE_S, Command

from firmware_sim.__main__ import main
from firmware_sim.motion.profile import load_profile
from firmware_sim.reservation import reserve

A_MINUTE_OF_CSV = ("--speed", "max", "--protocol", "csv", "--duration", "60")

SIGNAL_AT_THE_LINK = """
import os, signal, sys
from firmware_sim import __main__, command

class Device(command.PtyDevice):
    def __init__(self, *arguments):
        super().__init__(*arguments)
        os.kill(os.getpid(), signal.SIGTERM)

command.PtyDevice = Device
sys.exit(__main__.main())
"""


@pytest.fixture
def link(tmp_path: Path) -> Path:
    return tmp_path / "gyro"


def simulator(*arguments: str | Path) -> Command:
    return Command(*arguments, module="firmware_sim")


def ended(*arguments: str | Path) -> tuple[int, list[str]]:
    """The exit status and the lines of the log of a command that ends by itself, in this process."""
    with redirect_stderr(StringIO()) as log:
        try:
            status = main([str(word) for word in arguments])
        except SystemExit as exit_:
            status = int(exit_.code or 0)
    return status, log.getvalue().splitlines()


def wait_for(link: Path, command: Command) -> None:
    """Wait, without a pause, so that the next line runs in the moment that the link stands."""
    while not link.is_symlink():
        assert command.process.poll() is None, "it ended without a link"


def reserve_is_free(link: Path) -> bool:
    reservation = reserve(link)
    if reservation is not None:
        reservation.close()
    return reservation is not None


def port_on(command: Command, link: Path) -> serial.Serial:
    wait_for(link, command)
    return serial.Serial(str(link), timeout=PATIENCE_S)


def test_help_names_every_option_with_its_unit() -> None:
    """Asking for help is no mistake, and its text goes to stdout."""
    with simulator("--help") as command:
        assert command.end() == 0
        for option in ("--link", "--rig", "--profile", "--protocol", "--seed", "--speed", "--duration", "seconds"):
            assert option in command.out
        assert not command.log


def test_a_link_is_required() -> None:
    status, log = ended()
    assert status == 2
    assert "--link" in log[-1]


def test_an_unknown_profile_is_one_clear_line(link: Path) -> None:
    status, log = ended("--link", link, "--profile", "loop-the-loop")
    assert (status, len(log)) == (2, 1)
    assert log[0].startswith("firmware_sim: ")
    assert "loop-the-loop" in log[0]
    assert not link.is_symlink()


def test_an_unknown_profile_is_answered_with_the_shipped_ones(link: Path) -> None:
    _, log = ended("--link", link, "--profile", "turntabel")
    assert "turntable" in log[0]


def test_every_mistake_in_a_rig_is_a_line(link: Path, tmp_path: Path) -> None:
    """Two mistakes are two lines with their places, and no link is made."""
    rig = tmp_path / "rig.yaml"
    rig.write_text("base:\n  bias_dps: 99\n  noise: 0\n")
    status, log = ended("--link", link, "--rig", rig)
    assert status == 2
    assert [line.split(": ")[:2] for line in log] == [
        ["firmware_sim", f"{rig}:2:3 base.bias_dps"],
        ["firmware_sim", f"{rig}:3:3 base.noise"],
    ]
    assert not link.is_symlink()


@pytest.mark.parametrize(
    ("option", "value", "words"),
    [
        ("--protocol", "morse", "invalid choice"),
        ("--speed", "0", "expected a number above 0, or max"),
        ("--speed", "nan", "expected a number above 0, or max"),
        ("--duration", "long", "--duration"),
        pytest.param("--speed", "fast", "or max"),
        pytest.param("--seed", "-1", "--seed"),
        pytest.param("--duration", "nan", "--duration"),
        pytest.param("--duration", "-1", "--duration"),
    ],
)
def test_a_value_that_makes_no_sense_is_wrong_usage(
    link: Path, option: str, value: str, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """The last line says which option, and what it expects."""
    with pytest.raises(SystemExit, match="2"):
        main(["--link", str(link), "--speed", "max", "--duration", "0", option, value])
    assert words in capsys.readouterr().err.splitlines()[-1]


def test_a_file_at_the_link_is_left_alone(link: Path) -> None:
    """A name that is taken by a file is a failure of the link, told in one line."""
    link.write_text("precious")
    status, log = ended("--link", link)
    assert (status, log) == (3, [f"firmware_sim: {link} exists and is not a link to a pty; choose another name"])
    assert link.read_text() == "precious"


def test_a_name_too_long_is_a_failure_of_the_link(link: Path) -> None:
    """A name that the file system refuses is told in one line, too."""
    status, log = ended("--link", link.with_name("y" * 300))
    assert (status, len(log)) == (3, 1)


def test_it_ends_by_itself_after_its_duration(link: Path) -> None:
    status, log = ended("--link", link, "--duration", "0.095")
    assert status == 0
    assert log[-1] == "firmware_sim: 0 samples sent, 10 without a reader"
    assert log[0].startswith(f"firmware_sim: native on {link} (/dev/pts/")
    assert not link.is_symlink()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_it_well(link: Path, number: int) -> None:
    with simulator("--link", link) as command:
        with port_on(command, link) as port:
            assert port.read(1)
        assert command.stop(number) == 0
        assert not link.is_symlink()
        assert "samples sent" in command.log


def test_a_signal_right_after_the_link_ends_it_well(link: Path) -> None:
    ending = subprocess.run([sys.executable, "-c", SIGNAL_AT_THE_LINK, "--link", str(link)], check=False)
    assert ending.returncode == 0
    assert not link.is_symlink()


def test_a_reader_hears_hello_first(link: Path) -> None:
    with simulator("--link", link, "--wait") as command, port_on(command, link) as port:
        assert port.read_until(b"\0") == HELLO


@pytest.mark.parametrize(("protocol", "start"), [("csv", b"#0123456789"), ("witmotion", b"\x55")])
def test_it_speaks_the_protocol_asked_for(link: Path, protocol: str, start: bytes) -> None:
    """The first byte that a reader gets is one that the protocol begins with."""
    with simulator("--link", link, "--protocol", protocol) as command, port_on(command, link) as port:
        assert port.read(1) in [bytes([byte]) for byte in start]


def test_at_full_speed_nothing_is_missing_between_the_first_and_the_last(link: Path) -> None:
    """A minute arrives without a gap up to its last line, and the device ends when that is read."""
    with simulator("--link", link, *A_MINUTE_OF_CSV) as command:
        with port_on(command, link) as port:
            port.readline()  # begun, perhaps, before the port was open
            times_us = [int(port.readline().split(b",")[0])]
            while times_us[-1] < 59_990_000:
                times_us.append(int(port.readline().split(b",")[0]))
            assert command.end() == 0
        assert times_us == list(range(times_us[0], 60_000_000, 10_000))
        assert "6000 samples sent, 0 without a reader" in command.log


def test_at_full_speed_nothing_is_missing_at_the_start(link: Path) -> None:
    """A reader that opens the port as soon as it is there gets the very first line."""
    with simulator("--link", link, *A_MINUTE_OF_CSV) as command, port_on(command, link) as port:
        assert port.readline().startswith(b"#")
        assert port.readline().startswith(b"0,")


def test_quiet_says_nothing_but_errors(link: Path) -> None:
    assert ended("--link", link, "--duration", "0", "--quiet") == (0, [])


def test_two_readers_one_after_the_other_are_both_served(link: Path) -> None:
    with simulator("--link", link) as command:
        for _ in range(2):
            with port_on(command, link) as port:
                assert HELLO in (port.read_until(b"\0"), port.read_until(b"\0"))
        assert command.stop() == 0


@pytest.mark.promise("Configs and commands")
def test_a_second_device_on_a_link_is_refused_and_the_first_goes_on(link: Path) -> None:
    """A second simulated device on a link is refused, and the first continues."""
    with simulator("--link", link, "--protocol", "csv") as first:
        wait_for(link, first)
        slave = link.readlink()
        status, log = ended("--link", link)
        assert (status, len(log)) == (3, 1)
        assert f"{link} belongs to a simulated device that is running" in log[0]
        assert link.readlink() == slave
        with port_on(first, link) as port:
            assert port.read(1)
    assert reserve_is_free(link)


def test_a_link_of_a_killed_device_is_free(link: Path) -> None:
    """A kill leaves the link behind; the next device replaces it."""
    with simulator("--link", link) as killed:
        wait_for(link, killed)
    assert link.is_symlink()
    status, _ = ended("--link", link, "--duration", "0")
    assert status == 0
    assert not link.is_symlink()


def test_with_reset_the_device_is_off_until_a_reader_opens_the_port(link: Path) -> None:
    """The first reader gets the device from power-on."""
    with simulator("--link", link, "--protocol", "csv", "--reset") as command:
        with port_on(command, link) as port:
            lines = [port.readline() for _ in range(4)]
        assert command.stop() == 0
    assert [line.split(b",")[0] for line in lines if not line.startswith(b"#")][:2] == [b"0", b"10000"]


def test_whole_turns_are_whole() -> None:
    """Every stop of the profile is a multiple of 360 degrees, for three turns each way."""
    profile = load_profile("whole-turns")
    stops_deg = profile.motion_at(np.array([11.9, *(16.0 + 5.0 * index for index in range(6))]))[0]
    assert stops_deg == pytest.approx([0.0, 360.0, 0.0, 360.0, 0.0, 360.0, 0.0])
