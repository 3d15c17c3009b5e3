"""Watch a running service in the terminal, through the socket of serve --control.

Keys: z sets yaw to 0, p pauses the view, q quits. Without a terminal the state is printed once.
"""

import argparse
from pathlib import Path

EXAMPLES = """\
gyrodrift top /run/user/1000/gyro
gyrodrift top /run/gyrodrift/control | head
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("socket", type=Path, metavar="PATH", help="the socket of serve --control PATH")


def run(arguments: argparse.Namespace) -> int:
    """Show the service until a key ends the view; exit status 0."""
    from gyrodrift.top.watch import show

    show(arguments.socket)
    return 0
