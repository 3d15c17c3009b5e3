"""Protocols by name: one that somebody adds at both ends, read through a real pty."""

import argparse
import subprocess
import sys
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Any

import pytest
from support import never, python_in, speaking_on

from firmware_sim import __main__ as device_command
from firmware_sim.measure import measure
from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import Base, Rig
from firmware_sim.wire import registry as spoken
from gyrodrift.cli import options, replay
from gyrodrift.link.clocks.arrival import ArrivalClock
from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.protocols import registry as read
from gyrodrift.values.errors import UsageError

RIG = Rig(base=Base(bias_dps=0.5, noise_dps_rthz=0.0))


DECODER, ENCODER = python_in("extending-protocol.md")
"""The two modules of the how-to."""


def made(source: str, name: str) -> Any:
    module: dict[str, Any] = {}
    exec(source, module)
    return module[name]


@pytest.fixture
def toy() -> Iterator[str]:
    """A protocol more at both ends, for the time of a test."""
    read.register(made(DECODER, "PROTOCOL"))
    spoken.register(made(ENCODER, "ENCODER"))
    yield "milli"
    spoken.unregister("milli")
    read.unregister("milli")


@pytest.mark.parametrize("asked_for", ["auto", "milli"])
def test_a_protocol_that_is_added_is_read_from_a_port(toy: str, tmp_path: Path, asked_for: str) -> None:
    port, now_s, events, samples = tmp_path / "gyro", 1000.0, [], []
    blocks = measure(RIG, load_profile("turntable"), 1)
    with speaking_on(port) as device:
        link = Link(LinkOptions(str(port), protocol=asked_for), lambda event, **_: events.append(event), lambda: now_s)
        for frame in islice(spoken.ENCODERS[toy].frames(blocks, RIG.base), 200):
            device.send_all(frame.content, never)
            now_s += 0.01
            samples += link.read()
        link.close()
    assert len(samples) == 200
    assert samples[0].rate_dps == pytest.approx(0.5, abs=0.005)  # at rest: the bias, to a count of 0.00763 deg/s
    assert isinstance(link.clock, ArrivalClock)
    assert "no_device_clock" in events


def test_commands_know_a_protocol_that_is_added(toy: str, capsys: pytest.CaptureFixture[str]) -> None:
    host, player = argparse.ArgumentParser(), argparse.ArgumentParser()
    options.add_link_options(host)
    replay.add_arguments(player)
    assert "milli (rates in thousandths of a deg/s)" in " ".join(host.format_help().split())
    assert player.parse_args(["a.csv", "--link", "gyro", "--protocol", toy]).protocol == toy
    with pytest.raises(SystemExit):
        device_command.main(["--help"])
    assert "milli" in capsys.readouterr().out


def test_a_protocol_that_is_taken_away_is_unknown(toy: str) -> None:
    protocol, encoder = read.PROTOCOLS[toy], spoken.ENCODERS[toy]
    names = ", ".join(name for name in read.PROTOCOLS if name != toy)
    with pytest.raises(ValueError, match="there is a protocol 'milli' already"):
        read.register(protocol)
    with pytest.raises(ValueError, match="there is an encoder 'milli' already"):
        spoken.register(encoder)
    read.unregister(toy)
    with pytest.raises(UsageError, match=f"unknown protocol 'milli'; there are auto, {names}$"):
        read.protocol_named(toy)
    read.register(protocol)


def test_a_module_in_the_folder_is_all_that_an_end_needs(tmp_path: Path) -> None:
    """The files of the how-to are found, by a process that knows nothing of them."""
    host, device = tmp_path / "host", tmp_path / "device"
    for folder, source in ((host, DECODER), (device, ENCODER)):
        folder.mkdir()
        (folder / "milli.py").write_text(source)
    code = f"""
import firmware_sim.wire, gyrodrift.link.protocols
gyrodrift.link.protocols.__path__.append({str(host)!r})
firmware_sim.wire.__path__.append({str(device)!r})
from firmware_sim.wire.registry import ENCODERS
from gyrodrift.link.protocols.registry import PROTOCOLS
print("milli" in PROTOCOLS, "milli" in ENCODERS)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "True True\n"


def test_both_ends_know_the_same_protocols() -> None:
    assert set(read.PROTOCOLS) == set(spoken.ENCODERS)


def test_detection_asks_the_strongest_checksum_first(toy: str) -> None:
    """Sixteen bits, then the form of a line, then eight bits, and last what has none."""
    ranked = list(read.PROTOCOLS)
    assert [name for name in ranked if name in ("native", "csv", "witmotion", toy)] == [
        "native",
        "csv",
        "witmotion",
        toy,
    ]
