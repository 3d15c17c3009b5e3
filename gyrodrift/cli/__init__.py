"""The command line: `gyrodrift COMMAND ...`. Each command is a file of its own, imported when it is asked for."""

import argparse
import os
import sys
from difflib import get_close_matches
from importlib import import_module

from gyrodrift.errors import GyrodriftError, UsageError

COMMANDS = {
    "serve": "read a device, correct its drift, emit yaw as JSON lines",
    "record": "read a device and write what it sends into session files",
    "tune": "find the filter's parameters from recorded sessions",
    "diagnose": "say where simulator and recordings part, which effect it is, and how far adding it closes the gap",
    "compare": "this filter beside Euler and the drift reducers people use instead, on the same sessions",
    "filter": "run the same filter over a recorded session",
    "info": "what a recorded session holds: rate, gaps, clocks, temperature, rest, noise",
    "simulate": "write sessions of the simulated rig, without waiting for real time",
    "replay": "play a recorded session through a pty that looks like the device",
    "convert": "a session from .mcap to .csv or back, or for other programs",
    "repair": "close session files whose recording was cut off",
    "demo": "simulated turntable, live view, yaw error raw and corrected; no hardware",
}

INTERRUPTED = 130
EPILOG = """\
exit status: 0 done, 2 wrong usage or config, 3 the link, 4 the data, 130 interrupted.
angles are degrees, rates deg/s, times s, temperatures °C; counter-clockwise is positive.
"""


def main(argv: list[str] | None = None) -> int:
    """Run one command and give its exit status; a person's mistake is one line on stderr, never a traceback."""
    arguments = sys.argv[1:] if argv is None else argv
    name = next((word for word in arguments if not word.startswith("-")), "")
    try:
        if name in COMMANDS and arguments[0] == name:
            return _run(name, arguments[1:])
        return _outside_of_commands(arguments, name)
    except GyrodriftError as error:
        for line in str(error).splitlines():
            print(f"gyrodrift: {line}", file=sys.stderr)
        return error.exit_status
    except KeyboardInterrupt:
        print("gyrodrift: interrupted", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        _forget_stdout()  # nobody reads
        return 0
    except OSError as error:  # what no command foresaw: a full disk, a device that fails
        print(f"gyrodrift: {error.filename or 'output'}: {error.strerror}", file=sys.stderr)
        _forget_stdout()
        return UsageError.exit_status


def _forget_stdout() -> None:
    """Nothing is left to be flushed at exit, where it would fail again."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _run(name: str, arguments: list[str]) -> int:
    command = import_module(f"gyrodrift.cli.{name}")
    parser = argparse.ArgumentParser(
        prog=f"gyrodrift {name}",
        description=command.__doc__,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    command.add_arguments(parser)
    parsed = parser.parse_args(arguments)
    parsed.command_line = ["gyrodrift", name, *arguments]
    status: int = command.run(parsed)
    return status


def _outside_of_commands(arguments: list[str], name: str) -> int:
    from gyrodrift.installation import version_line

    width = max(map(len, COMMANDS))
    listing = "\n".join(f"  {command:{width}}  {what}" for command, what in COMMANDS.items())
    parser = argparse.ArgumentParser(
        prog="gyrodrift",
        usage="gyrodrift COMMAND ... (gyrodrift COMMAND --help for its options)",
        description=f"Yaw from a low-cost gyro, with the drift taken out as it streams.\n\ncommands:\n{listing}",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=version_line())
    if name in COMMANDS:
        raise UsageError(f"{name!r} stands behind options; write gyrodrift {name} first")
    if name:
        nearest = get_close_matches(name, COMMANDS, n=1)
        meant = f"did you mean {nearest[0]}?" if nearest else f"commands are {', '.join(COMMANDS)}"
        raise UsageError(f"{name!r} is not a command; {meant}")
    parser.parse_args(arguments)
    parser.print_help(sys.stderr)
    return UsageError.exit_status
