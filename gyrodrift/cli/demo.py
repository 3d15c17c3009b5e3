"""Try gyrodrift without hardware: a simulated gyro on a turntable, serve reading it, and a live view of yaw.

At the end it prints the yaw error against the encoder of the table, for the integrated rate (raw) and for gyrodrift.
Without a terminal it prints only that.
"""

import argparse
import signal
from pathlib import Path

from gyrodrift.cli import numbers, options
from gyrodrift.io.files import check_inputs_kept, check_writable
from gyrodrift.values.errors import UsageError

EXAMPLES = """\
gyrodrift demo
gyrodrift demo --duration 20 --speed 4 --profile drive
gyrodrift demo --svg demo.svg
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    options.add_duration_option(parser, 60.0, "end after TIME, such as 60 (s) or 2min (default 60)")
    parser.add_argument("--config", type=Path, metavar="FILE", help="config of serve (default: the shipped one)")
    parser.add_argument("--rig", type=Path, metavar="FILE", help="rig of the simulator (default: the shipped one)")
    parser.add_argument(
        "--profile",
        type=options.profile,
        default="turntable",
        metavar="PROFILE",
        help="motion: a shipped profile or a file",
    )
    parser.add_argument(
        "--speed",
        type=numbers.number(1e6),
        default=1.0,
        metavar="X",
        help="multiple of real time (default 1)",
    )
    parser.add_argument("--seed", type=numbers.seed, default=1, help="seed of the simulated noise (default 1)")
    parser.add_argument(
        "--svg",
        type=Path,
        metavar="FILE",
        help="save the last view as an SVG of 100×24 characters (default: none)",
    )


def run(arguments: argparse.Namespace) -> int:
    """Run the demo; exit status 0."""
    if arguments.svg is not None:
        _check_picture(arguments)
    from gyrodrift.demo.show import run_demo

    for ending in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(ending, signal.default_int_handler)  # so that the child processes end too
    run_demo(
        duration_s=arguments.duration,
        config=arguments.config,
        rig=arguments.rig,
        profile=arguments.profile,
        speed=arguments.speed,
        seed=arguments.seed,
        svg=arguments.svg,
        is_quiet=arguments.quiet,
    )
    return 0


def _check_picture(arguments: argparse.Namespace) -> None:
    """Check the path of the picture before the demo runs."""
    if arguments.svg.suffix != ".svg":
        raise UsageError(f"--svg {arguments.svg}: a picture ends in .svg")
    if not arguments.svg.parent.is_dir():
        raise UsageError(f"--svg {arguments.svg}: there is no folder {arguments.svg.parent}")
    check_writable(arguments.svg.parent)
    read = [path for path in (arguments.config, arguments.rig) if path is not None]
    check_inputs_kept([arguments.svg], [*read, Path(arguments.profile)])
