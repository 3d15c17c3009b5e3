"""Play a recorded session through a pty that looks like the device.

--raw plays the original bytes of the link, damage included, if the recording has them. Without it the samples are
encoded again. csv (default) carries every digit of the recording. native rounds the rate to --lsb. witmotion rounds it
to the steps of a WT901 and has no clock. Only --raw plays the device's own yaw.

Playing starts when a reader opens the port. At --speed max the reader sets the pace and no sample is lost. At other
speeds samples are lost while nobody reads, as from a real device.
"""

import argparse
import sys
from collections.abc import Iterator
from itertools import chain
from pathlib import Path

from firmware_sim.wire.encoder import Frame
from firmware_sim.wire.registry import ENCODERS
from gyrodrift.cli import INTERRUPTED, inputs, numbers, options
from gyrodrift.session.mcap.raw import read_raw
from gyrodrift.simulation.replay import PlayedSession, base_of, raw_frames
from gyrodrift.values.errors import LinkError, UsageError

EXAMPLES = """\
gyrodrift replay session.mcap --link /tmp/gyro
gyrodrift replay session.mcap --link /tmp/gyro --speed max --protocol native
gyrodrift replay session.mcap --link /tmp/gyro --loop
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    options.load_encoders()
    parser.add_argument("session", type=Path, metavar="SESSION", help="recorded session (.mcap or .csv)")
    parser.add_argument("--link", type=Path, required=True, metavar="PATH", help="path of the link to the pty")
    parser.add_argument("--protocol", default="csv", choices=sorted(ENCODERS), help="protocol of the device")
    parser.add_argument("--raw", action="store_true", help="play the original bytes of a recording made with --raw")
    parser.add_argument("--speed", type=_speed, default="1", metavar="X", help="times real time, or max (default 1)")
    parser.add_argument("--loop", action="store_true", help="start again at the end; device time goes on")
    parser.add_argument(
        "--lsb",
        type=numbers.number(10.0, "deg/s per count, above 0 and up to 10"),
        default=0.01,
        metavar="DPS",
        help="native: deg/s per count (default 0.01)",
    )
    options.add_damage_option(parser)


def run(arguments: argparse.Namespace) -> int:
    """Play until the end, or until a signal."""
    from firmware_sim.player import play, stopped_by_signals
    from firmware_sim.pty import LinkInUseError, PtyDevice

    speed: float | None = arguments.speed
    frames, hello = _raw(arguments) if arguments.raw else _encoded(arguments)
    try:
        device = PtyDevice(arguments.link, hello)
    except LinkInUseError as error:
        raise LinkError(str(error)) from error
    try:
        print(f"gyrodrift: {arguments.session.stem} on {arguments.link}, waiting for a reader", file=sys.stderr)
        with stopped_by_signals() as is_over:
            device.wait_for_reader(is_over)
            sent, lost = play(frames, device, speed, is_over)
            if not is_over():
                device.drain(is_over if speed is None else None)
            was_stopped = is_over()
    finally:
        device.close()
    unit = "reads" if arguments.raw else "samples"
    print(f"gyrodrift: {sent} {unit} sent, {lost} without a reader", file=sys.stderr)
    return INTERRUPTED if was_stopped else 0


def _raw(arguments: argparse.Namespace) -> tuple[Iterator[Frame], bytes]:
    """The original bytes; mistakes in the file show before a reader is waited for."""
    if arguments.loop:
        raise UsageError("--raw --loop: raw bytes can be played only once, because their clock cannot go on")
    inputs.check_damage([arguments.session], arguments)
    reads = read_raw(arguments.session, allow_damage=arguments.allow_damage)
    first = next(reads, None)
    return raw_frames(reads if first is None else chain([first], reads)), b""


def _encoded(arguments: argparse.Namespace) -> tuple[Iterator[Frame], bytes]:
    """Frames of the session in the chosen protocol, and the frame that greets a reader."""
    session = inputs.read_session(arguments.session, allow_damage=arguments.allow_damage)
    if session.device_yaw_deg is not None and not arguments.quiet:
        note = "left out: the device's own yaw; --raw plays it, if it was recorded with --raw"
        print(f"gyrodrift: {session.name}: {note}", file=sys.stderr)
    recording = PlayedSession(session, is_looping=arguments.loop)
    encoder, base = ENCODERS[arguments.protocol], base_of(recording, arguments.lsb)
    return encoder.recorded(recording, base), encoder.hello(base)


def _speed(text: str) -> float | None:
    if text == "max":
        return None
    return numbers.number(1e6, "a number above 0, or max")(text)
