"""The simulated device alone, on a pty that looks like a serial port.

It speaks until SIGINT or SIGTERM, or for --duration seconds of its own time. Without a reader it goes on, as a
real device does; at --speed max it waits for one instead and loses nothing.
"""

import argparse
import sys
from collections.abc import Callable, Iterator
from contextlib import closing
from itertools import takewhile
from pathlib import Path

from firmware_sim.faults.catalogue import FAULTS, FaultyCable, faulty_blocks, faulty_frames, parse_fault
from firmware_sim.measure import StillWord, measure
from firmware_sim.motion.profile import load_profile
from firmware_sim.player import play, stopped_by_signals
from firmware_sim.pty import LinkInUseError, PtyDevice
from firmware_sim.rig import load_rig, parse_effect, with_effects
from firmware_sim.wire.encoder import Frame
from firmware_sim.wire.registry import ENCODERS
from firmware_sim.yaml_file import FileError

WRONG_USAGE, LINK_FAILED = 2, 3


def main(argv: list[str] | None = None) -> int:
    """Run the device; the exit status."""
    arguments = _parser().parse_args(argv)
    try:
        return run(arguments)
    except FileError as error:
        for line in str(error).splitlines():
            print(f"firmware_sim: {line}", file=sys.stderr)
        return WRONG_USAGE
    except LinkInUseError as error:
        print(f"firmware_sim: {error}", file=sys.stderr)
        return LINK_FAILED


def run(arguments: argparse.Namespace) -> int:
    """Play the rig on a pty until a signal comes or the time is over."""
    rig = with_effects(load_rig(arguments.rig), [parse_effect(text) for text in arguments.effect])
    faults = [parse_fault(text) for text in arguments.fault]
    profile = load_profile(arguments.profile)
    blocks = faulty_blocks(measure(rig, profile, arguments.seed, still=StillWord(arguments.still)), faults)
    encoder = ENCODERS[arguments.protocol]
    frames = faulty_frames(encoder.frames(blocks, rig.base), faults, arguments.seed)
    cable = FaultyCable(faults)
    with stopped_by_signals() as is_over, closing(PtyDevice(arguments.link, encoder.hello(rig.base), cable)) as device:
        _tell(arguments, f"{arguments.protocol} on {arguments.link} ({device.slave_name})")
        frames = _for(frames, arguments.duration)
        if arguments.wait:
            device.wait_for_reader(is_over)
        sent, lost = play(frames, device, arguments.speed, is_over)
        if not is_over():
            device.drain()
    _tell(arguments, f"{sent} samples sent, {lost} without a reader")
    return 0


def _tell(arguments: argparse.Namespace, message: str) -> None:
    if not arguments.quiet:
        print(f"firmware_sim: {message}", file=sys.stderr)


def _for(frames: Iterator[Frame], duration_s: float | None) -> Iterator[Frame]:
    return frames if duration_s is None else takewhile(lambda frame: frame.t_s < duration_s, frames)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m firmware_sim", description=__doc__, allow_abbrev=False)
    parser.add_argument("--link", type=Path, required=True, help="name that the pty is linked at")
    parser.add_argument("--rig", type=Path, help="rig file (default: the shipped config/rig.yaml)")
    parser.add_argument(
        "--effect",
        action="append",
        default=[],
        metavar="NAME[:param=value,...]",
        help="an effect more than the rig has, of typical size where nothing is said (may be given again)",
    )
    parser.add_argument(
        "--fault",
        action="append",
        default=[],
        metavar="NAME[:param=value,...]",
        help="something that goes wrong on the link, from from_s (2 s of device time where nothing is said) to to_s "
        f"(may be given again): {', '.join(FAULTS)}",
    )
    parser.add_argument("--profile", default="turntable", help="name of a shipped profile, or a file")
    parser.add_argument("--protocol", default="native", choices=sorted(ENCODERS))
    parser.add_argument("--seed", type=_seed, default=0, help="of everything random (default 0)")
    parser.add_argument(
        "--still",
        default=StillWord.NONE.value,
        choices=[word.value for word in StillWord],
        help="say with each measurement whether the table stands still: what is so (true), or always 1 or 0; "
        "native and csv (default none)",
    )
    parser.add_argument(
        "--speed",
        type=_speed,
        default=1.0,
        help="device seconds in a second, or max for as fast as it is read",
    )
    parser.add_argument(
        "--wait",
        action="store_true",
        help="power on when the first reader opens the port, as boards do that DTR resets",
    )
    parser.add_argument("--quiet", action="store_true", help="say nothing but errors")
    parser.add_argument(
        "--duration", type=_number(0.0, "seconds from 0 on"), metavar="S", help="stop after S seconds of device time"
    )
    return parser


def _number(least: float, what: str) -> Callable[[str], float]:
    """A reader of numbers from `least` on."""

    def read(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = float("nan")
        if not least <= value < float("inf"):
            raise argparse.ArgumentTypeError(f"{text}: expected {what}")
        return value

    return read


def _seed(text: str) -> int:
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"{text}: expected a whole number from 0")
    return int(text)


def _speed(text: str) -> float | None:
    return None if text == "max" else _number(1e-6, "a number above 0, or max")(text)


if __name__ == "__main__":
    sys.exit(main())
