"""Simulate a gyro on a serial port (a pty), to try every command without hardware.

It sends until Ctrl-C, or for --duration seconds of device time. Samples without a reader are lost, as on a real
device. At --speed max it waits for a reader and loses nothing. The same rig, profile and seed give the same samples
as gyrodrift simulate.
"""

import argparse
import sys

from gyrodrift.values.errors import LinkError, UsageError

EXAMPLES = """\
gyrodrift simulated-device --link /tmp/gyro
gyrodrift simulated-device --link /tmp/gyro --profile whole-turns --reset
gyrodrift simulated-device --link /tmp/gyro --effect warmup --fault unplug
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    from firmware_sim import command
    from gyrodrift.cli.options import load_effects, load_encoders

    load_effects()
    load_encoders()
    command.add_arguments(parser)


def run(arguments: argparse.Namespace) -> int:
    """Run the device until it is stopped; 0 then."""
    from firmware_sim import command
    from firmware_sim.pty import LinkInUseError
    from firmware_sim.yaml_file import FileError

    def tell(message: str) -> None:
        if not arguments.quiet:
            print(f"gyrodrift: {message}", file=sys.stderr)

    try:
        command.run(arguments, tell)
    except FileError as error:
        raise UsageError(str(error)) from error
    except LinkInUseError as error:
        raise LinkError(str(error)) from error
    return 0
