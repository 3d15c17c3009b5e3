"""The simulated device as a command: its options, and its run on a pty until a signal or the end of its time."""

import argparse
import re
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path

from firmware_sim.faults.catalogue import FAULTS, FaultyCable, faulty_blocks, faulty_frames, parse_fault
from firmware_sim.measure import StillWord, measure
from firmware_sim.motion.profile import load_motion, shipped_profiles
from firmware_sim.player import play, play_after_each_opening, stopped_by_signals
from firmware_sim.pty import Cable, PtyDevice
from firmware_sim.rig import (
    AIDS,
    OWN_YAWS,
    Rig,
    load_rig,
    parse_aid,
    parse_effect,
    with_aids,
    with_axes,
    with_effects,
    with_own_yaw,
)
from firmware_sim.second_source import aid_streams, lines_between
from firmware_sim.wire.encoder import Frame
from firmware_sim.wire.registry import ENCODERS
from firmware_sim.yaml_file import FileError

DECIMAL = re.compile(r"(?:[0-9]{1,18}\.?[0-9]{0,18}|\.[0-9]{1,18})(?:[eE][-+]?[0-9]{1,3})?")
WHOLE = re.compile(r"[0-9]{1,18}")
"""Plain decimal digits: `float` and `int` also take other scripts, underscores and blanks."""

CARRIES_OWN_YAW = "native"
"""The only protocol with a frame for the device's own yaw."""

CARRIES_AIDS = "text"
"""The only protocol with lines for second sources."""

LONGEST_QUOTE = 40
"""Longest quote of a wrong value, characters."""


@dataclass(frozen=True, slots=True)
class Device:
    """Device as the options describe it: frames from power-on, first bytes for each reader, cable."""

    frames: Callable[[], Iterator[Frame]]
    greeting: bytes
    cable: Cable


def device_of(arguments: argparse.Namespace) -> Device:
    """Device of the options.

    Raises
    ------
    FileError
        The rig, the profile, an effect or a fault has a mistake.
    """
    rig = _rig(arguments)
    faults = [parse_fault(text) for text in arguments.fault]
    profile = load_motion(arguments.profile)
    encoder = ENCODERS[arguments.protocol]

    def frames() -> Iterator[Frame]:
        blocks = faulty_blocks(measure(rig, profile, arguments.seed, still=StillWord(arguments.still)), faults)
        lines = encoder.frames(blocks, rig.base)
        if rig.aids:
            lines = lines_between(lines, aid_streams(rig.aids, profile, arguments.seed))
        endless = faulty_frames(lines, faults, arguments.seed)
        return endless if arguments.duration is None else takewhile(lambda f: f.t_s < arguments.duration, endless)

    return Device(frames, encoder.hello(rig.base), FaultyCable(faults))


def run(arguments: argparse.Namespace, tell: Callable[[str], None]) -> None:
    """Play the rig on a pty until a signal comes or the time is over; `tell` gets a sentence at both ends.

    Raises
    ------
    FileError
        The rig, the profile, an effect or a fault has a mistake.
    LinkInUseError
        The link cannot be made, or belongs to something else.
    """
    made = device_of(arguments)
    with stopped_by_signals() as is_over, closing(PtyDevice(arguments.link, made.greeting, made.cable)) as device:
        tell(f"{arguments.protocol} on {arguments.link} ({device.slave_name})")
        if arguments.reset:
            sent, lost = play_after_each_opening(made.frames, device, arguments.speed, is_over)
        else:
            if arguments.wait:
                device.wait_for_reader(is_over)
            sent, lost = play(made.frames(), device, arguments.speed, is_over)
        if not is_over():
            device.drain(is_over if arguments.speed is None else None)
    tell(f"{sent} samples sent, {lost} without a reader")


def _rig(arguments: argparse.Namespace) -> Rig:
    effects = [parse_effect(text) for text in arguments.effect]
    axes = int(arguments.axes) if arguments.axes else None
    aids = [parse_aid(text) for text in arguments.aid]
    rig = with_own_yaw(with_effects(with_axes(load_rig(arguments.rig), axes), effects), arguments.own_yaw)
    rig = with_aids(rig, aids)
    if rig.aids and arguments.protocol != CARRIES_AIDS:
        raise FileError(f"--aid: only labeled lines carry second sources; use --protocol {CARRIES_AIDS}")
    if rig.base.own_yaw is not None and arguments.protocol != CARRIES_OWN_YAW:
        raise FileError(
            f"--protocol {arguments.protocol}: does not carry the device's own yaw; use --protocol {CARRIES_OWN_YAW}, "
            "or leave out --own-yaw and own_yaw of the rig"
        )
    return rig


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--link", type=Path, required=True, metavar="PATH", help="name of the port, a link to the pty")
    parser.add_argument("--rig", type=Path, metavar="FILE", help="rig file (default: the shipped one)")
    parser.add_argument(
        "--effect",
        action="append",
        default=[],
        metavar="NAME[:param=value,...]",
        help="add an effect to the rig, at its typical size without parameters (repeatable; default: none)",
    )
    parser.add_argument(
        "--aid",
        action="append",
        default=[],
        metavar="NAME[:param=value,...]",
        help=f"a second source, in lines of --protocol text (repeatable; default: none): {', '.join(AIDS)}",
    )
    parser.add_argument(
        "--fault",
        action="append",
        default=[],
        metavar="FAULT[:param=value,...]",
        help="a fault of the link, from from_s to to_s of device time; it begins at 2 s by default "
        f"(repeatable): {', '.join(FAULTS)}",
    )
    parser.add_argument(
        "--profile",
        default="turntable",
        metavar="PROFILE",
        help=f"motion: {', '.join(shipped_profiles())}, or a file (default turntable)",
    )
    parser.add_argument(
        "--axes",
        choices=("1", "3"),
        help="gyro axes: 1, or 3 with an accelerometer (default: as the rig file says)",
    )
    parser.add_argument(
        "--own-yaw",
        choices=OWN_YAWS,
        help="run this filter in the device too, and send its yaw, sigma and drift (attitude: restlevel on three axes; "
        "default: as the rig file says)",
    )
    parser.add_argument(
        "--protocol", default="native", choices=sorted(ENCODERS), help="protocol that it sends (default native)"
    )
    parser.add_argument("--seed", type=_seed, default=0, metavar="S", help="seed of all random numbers (default 0)")
    parser.add_argument(
        "--still",
        default=StillWord.NONE.value,
        choices=[word.value for word in StillWord],
        help="send with each sample whether the table stands still: the truth (true), or always 1 or 0; "
        "native and csv only (default none)",
    )
    parser.add_argument(
        "--speed", type=_speed, default=1.0, metavar="X", help="times real time, or max: as fast as it is read"
    )
    parser.add_argument(
        "--wait", action="store_true", help="power on when the first reader opens the port (default: at once)"
    )
    parser.add_argument(
        "--reset",
        action="store_true",
        help="power on again each time a reader opens the port, as boards do that are reset by DTR (default: no)",
    )
    parser.add_argument(
        "--duration",
        type=_number(0.0, "seconds, 0 or more"),
        metavar="S",
        help="stop after S seconds of device time (default: never)",
    )


def _number(minimum: float, expected: str) -> Callable[[str], float]:
    """Parser of finite numbers of at least `minimum`."""

    def read(text: str) -> float:
        value = float(text) if DECIMAL.fullmatch(text) else float("nan")
        if not minimum <= value < float("inf"):
            raise argparse.ArgumentTypeError(f"{text[:LONGEST_QUOTE]}: expected {expected}")
        return value

    return read


def _seed(text: str) -> int:
    if not WHOLE.fullmatch(text):
        raise argparse.ArgumentTypeError(f"{text[:LONGEST_QUOTE]}: expected a whole number, 0 or more")
    return int(text)


def _speed(text: str) -> float | None:
    return None if text == "max" else _number(1e-6, "a number above 0, or max")(text)
