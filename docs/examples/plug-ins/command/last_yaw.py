"""Print the last yaw of a session."""

import argparse
from pathlib import Path

GYRODRIFT_API = 1
EXAMPLES = "gyrodrift last-yaw session.mcap\n"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("session", type=Path, metavar="SESSION", help="recorded session")


def run(arguments: argparse.Namespace) -> int:
    """Run the filter over the session, and print its last yaw; 0 then."""
    from gyrodrift import Restlevel, load_session

    session = load_session(arguments.session)
    print(f"{Restlevel().update_batch(session.rate_dps, session.t_device_s).yaw_deg[-1]:.3f} deg")
    return 0
