"""Control a running service through the socket that its --control names.

zero makes yaw 0; heading DEG gives the compass heading, clockwise from north; rest 1 says that the device stands still,
rest 0 that it moves, and rest auto takes that back; rate HZ thins the lines on stdout (0: every sample); status tells
everything; reload reads the config again; stop ends the service. The answer is one JSON object on stdout.
"""

import argparse
import json
import sys
from pathlib import Path

from gyrodrift.errors import UsageError

COMMANDS = ("zero", "heading", "rest", "rate", "status", "reload", "stop")
PATIENCE_S, RELOAD_PATIENCE_S = 5.0, 45.0
"""A reload takes as long as two readings of a config at most: the one under way, and its own."""

EXAMPLES = """\
gyrodrift ctl /run/user/1000/gyro status
gyrodrift ctl /run/user/1000/gyro zero
gyrodrift ctl /run/user/1000/gyro heading 270
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("socket", type=Path, metavar="PATH", help="the socket of serve --control PATH")
    parser.add_argument("command", choices=COMMANDS, help="what to do")
    parser.add_argument("value", nargs="?", help="for heading, rest and rate")


def run(arguments: argparse.Namespace) -> int:
    """Ask, print the answer; 0 where it was done."""
    words = [arguments.command, *([arguments.value] if arguments.value is not None else [])]
    from gyrodrift.service.control_client import ControlClient

    patience_s = RELOAD_PATIENCE_S if arguments.command == "reload" else PATIENCE_S
    with ControlClient(arguments.socket, patience_s) as service:
        answer = service.ask(" ".join(words))
    json.dump(answer, sys.stdout)
    print()
    if not answer["ok"]:
        raise UsageError(f"{' '.join(words)}: {answer['error']}")
    return 0
