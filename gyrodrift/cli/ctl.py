"""Control a running service through the socket of serve --control.

  zero             set yaw and its sigma to 0.
  heading DEG      set the compass heading, clockwise from north. With --sigma DEG it is a measurement that the filter
                   weighs, and the answer says how it agrees.
  turn-rate DPS    with --sigma DPS: the device turns at DPS, counter-clockwise positive, by another source.
  rest 1|0|auto    say that the device stands still or moves; auto ends it.
  rate HZ          at most HZ lines a second on stdout; 0 for every sample.
  record start     begin a recording in the folder of serve --record (default: sessions); record stop ends it.
  calibrate start  begin a calibration; then mark at each stop at the mark, undo, finish, cancel; state shows it.
                   calibrate positions begins one on six sides, calibrate axis-turns also with turns about each axis.
  page             print the address of the live page with the token for its buttons.
  status           print the state of the service.
  reload           read the config again.
  stop             end the service.

The answer is one JSON object on stdout.
"""

import argparse
import json
import sys
from pathlib import Path

from gyrodrift.service.control_client import ControlClient
from gyrodrift.values.errors import UsageError

COMMANDS = ("zero", "heading", "turn-rate", "rest", "rate", "record", "calibrate", "page", "status", "reload", "stop")
PATIENCE_S, RELOAD_PATIENCE_S = 5.0, 45.0
"""Longest wait for an answer, s. A reload takes at most two readings of a config: one in progress and its own."""

EXAMPLES = """\
gyrodrift ctl /run/user/1000/gyro status
gyrodrift ctl /run/user/1000/gyro zero
gyrodrift ctl /run/user/1000/gyro heading 87 --sigma 2
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("socket", type=Path, metavar="PATH", help="the socket of serve --control PATH")
    parser.add_argument("command", choices=COMMANDS, help="command of the list above")
    parser.add_argument("value", nargs="?", help="argument of heading, turn-rate, rest, rate, record and calibrate")
    parser.add_argument(
        "--sigma",
        metavar="SIGMA",
        help="standard deviation of heading (deg) or turn-rate (deg/s); default: heading sets the north",
    )


def run(arguments: argparse.Namespace) -> int:
    """Send the command and print the answer; exit status 0 if the service carried it out."""
    words = [arguments.command, *([arguments.value] if arguments.value is not None else [])]
    words += [] if arguments.sigma is None else ["--sigma", arguments.sigma]

    patience_s = RELOAD_PATIENCE_S if arguments.command == "reload" else PATIENCE_S
    with ControlClient(arguments.socket, patience_s) as service:
        answer = service.ask(" ".join(words))
    json.dump(answer, sys.stdout)
    print()
    if not answer["ok"]:
        raise UsageError(f"{' '.join(words)}: {answer['error']}")
    return 0
