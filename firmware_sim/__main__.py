"""Simulate a gyro on a pty that looks like a serial port.

It sends until SIGINT or SIGTERM, or for --duration seconds of device time. Samples without a reader are lost, as on
a real device. At --speed max it waits for a reader and loses nothing.
"""

import argparse
import sys

from firmware_sim.command import add_arguments, run
from firmware_sim.pty import LinkInUseError
from firmware_sim.yaml_file import FileError

USAGE_STATUS, LINK_STATUS = 2, 3


def main(argv: list[str] | None = None) -> int:
    """Run the device and return the exit status."""
    parser = argparse.ArgumentParser(prog="python -m firmware_sim", description=__doc__, allow_abbrev=False)
    add_arguments(parser)
    parser.add_argument("--quiet", action="store_true", help="print errors only")
    arguments = parser.parse_args(argv)
    try:
        run(arguments, _silent if arguments.quiet else _print)
    except FileError as error:
        for line in str(error).splitlines():
            _print(line)
        return USAGE_STATUS
    except LinkInUseError as error:
        _print(str(error))
        return LINK_STATUS
    return 0


def _print(message: str) -> None:
    print(f"firmware_sim: {message}", file=sys.stderr)


def _silent(_: str) -> None:
    """Print nothing."""


if __name__ == "__main__":
    sys.exit(main())
