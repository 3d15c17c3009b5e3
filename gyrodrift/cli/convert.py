"""Convert a recorded session between .mcap and .csv, by the endings of the two paths; every digit is kept."""

import argparse
from pathlib import Path


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("source", type=Path, metavar="IN", help="recorded session (.mcap or .csv)")
    parser.add_argument("target", type=Path, metavar="OUT", help="where to write it (.mcap or .csv)")


def run(arguments: argparse.Namespace) -> int:
    """Convert; 0 when it is written."""
    from gyrodrift.session.session import load_session
    from gyrodrift.session.write import write_session

    write_session(arguments.target, [load_session(arguments.source)])
    return 0
