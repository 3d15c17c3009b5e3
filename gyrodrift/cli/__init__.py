"""The command line `gyrodrift COMMAND ...`: one file for each command, imported when it runs.

Other packages add commands (`plug_ins.py`); they are looked for where a name is none of ours, and for a list of all.
"""

import os
import select
import sys
from importlib import import_module
from textwrap import indent
from types import ModuleType

from gyrodrift.cli.parser import Parser
from gyrodrift.cli.process import accept_all_characters, open_standard_streams
from gyrodrift.io.deprecation import told_deprecations
from gyrodrift.io.plug_ins import failure_in_plug_in
from gyrodrift.values.errors import GyrodriftError, UsageError, visible
from gyrodrift.values.secret import mentions_secret, shown_words

GROUPS = {
    "live": {
        "serve": "read a gyro, correct its drift, print yaw",
        "ctl": "control a running service: zero, heading, rest, rate, status, reload, stop",
        "record": "record a device into session files",
        "top": "watch a running service in the terminal",
    },
    "device": {
        "devices": "list serial ports: stable name, maker, process that holds the port, device",
        "doctor": "find problems of a device or a recording, with remedies and the expected drift",
        "calibrate": "measure scale, sign, bias and noise by whole turns against a mark, for the config",
        "firmware": "write the filter as a library for a microcontroller: C, Arduino, ESPHome, MicroPython and others",
        "install-service": "run serve under systemd: unit, udev rule, start",
    },
    "recordings": {
        "info": "describe recorded sessions: rate, gaps, clocks, temperature, rest, noise",
        "filter": "run the filter of serve over a recorded session",
        "convert": "convert a session to .mcap, .csv, .json, .jsonl or .parquet",
        "repair": "repair interrupted and damaged session files",
        "replay": "play a recorded session through a pty that looks like the device",
    },
    "analysis": {
        "tune": "find filter parameters from recorded sessions",
        "compare": "compare the filters with plain integration, x-io Fusion, VQF and others on your sessions",
        "diagnose": "name the effect that explains the gap between a simulator and recordings",
    },
    "without hardware": {
        "demo": "show a simulated turntable live, with raw and corrected yaw error; no hardware",
        "simulate": "write sessions of the simulated rig, without waiting for real time",
        "simulated-device": "simulate a gyro on a serial port, to try every command without hardware",
    },
    "this program": {
        "completion": "print the script for shell completion",
        "help": "show the help of a command, or of the columns of text and tables",
    },
}
"""Commands with their summaries, by what they are for."""

COMMANDS = {name: summary for commands in GROUPS.values() for name, summary in commands.items()}

INTERRUPTED = 130
POSIX_MODULES = frozenset({"fcntl", "grp", "pty", "pwd", "resource", "termios", "tty"})
"""Windows has none of them."""

LINUX_COMMANDS = frozenset({"demo", "install-service", "replay", "simulated-device"})
"""Commands that need a pty in packet mode or systemd."""

ASKED_BY_A_SHELL = "_ARGCOMPLETE"
EXAMPLES = """\
gyrodrift demo                         a minute without hardware
gyrodrift serve --port /dev/ttyUSB0    yaw from a gyro on a cable
gyrodrift help tune                    options of tune
"""
EPILOG = """\
exit status: 0 done, 2 wrong usage or config, 3 the link, 4 the data, 130 interrupted.
angles are degrees, rates deg/s, times s, temperatures °C; counter-clockwise is positive.
"""


def main(argv: list[str] | None = None) -> int:  # noqa: PLR0911 - one for each kind of end
    """Run a command and return its exit status; a wrong input is one line on stderr, never a traceback."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # matrices are small here, and threads slow their products down
    open_standard_streams()
    accept_all_characters()
    if ASKED_BY_A_SHELL in os.environ:
        import_module("gyrodrift.cli.completion").complete()
    arguments = sys.argv[1:] if argv is None else argv
    name = next((word for word in arguments if not word.startswith("-")), "")
    try:
        if name and arguments[0] == name:
            return _run(name, arguments[1:])
        return _outside_of_commands(arguments, name)
    except GyrodriftError as error:
        for line in _on_one_line(str(error), arguments).splitlines():
            print(f"gyrodrift: {line}", file=sys.stderr)
        return error.exit_status
    except KeyboardInterrupt:
        print("gyrodrift: interrupted", file=sys.stderr)
        return INTERRUPTED
    except OSError as error:  # a full disk, or a device that fails
        if isinstance(error, BrokenPipeError) and _is_stdout_closed():
            _forget_stdout()
            return 0
        print(f"gyrodrift: {error.filename or 'output'}: {error.strerror}", file=sys.stderr)
        _forget_stdout()
        return UsageError.exit_status
    except Exception as error:
        line = failure_in_plug_in(error)
        if not line:
            raise
        print(f"gyrodrift: {line}", file=sys.stderr)
        return UsageError.exit_status


def _on_one_line(message: str, arguments: list[str]) -> str:
    r"""Message with the line feeds of quoted arguments as `\x0a`, so that a mistake stays one line."""
    for word in arguments:
        for quoted in (word, word.partition("=")[2]):
            if "\n" in quoted:
                message = message.replace(visible(quoted), visible(quoted).replace("\n", "\\x0a"))
    return message


def _is_stdout_closed() -> bool:
    """Whether the reader of stdout has closed it, as `head` does; any other broken pipe is a failure."""
    if not hasattr(select, "poll"):  # Windows, which cannot ask
        return True
    poller = select.poll()
    poller.register(sys.stdout.fileno(), select.POLLOUT)
    return any(events & (select.POLLERR | select.POLLHUP) for _, events in poller.poll(0))


def _forget_stdout() -> None:
    """Discard unwritten output, which would fail again at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _run(name: str, arguments: list[str]) -> int:
    if any(map(mentions_secret, arguments)):
        from gyrodrift.cli.process import hide_secrets

        hide_secrets()
    try:
        with told_deprecations():
            parsed = parser_of(name).read(arguments)
        _check_system(name)
        parsed.command_line = shown_words(["gyrodrift", name, *arguments])
        status: int = command_of(name).run(parsed)
    except ModuleNotFoundError as error:
        if error.name not in POSIX_MODULES:
            raise
        raise UsageError(f"{name} needs Linux or macOS: this Python has no module {error.name}") from error
    return status


def _check_system(name: str) -> None:
    """Refuse a command that cannot run on this system.

    Raises
    ------
    UsageError
        With the systems on which it runs.
    """
    if name in LINUX_COMMANDS and not (sys.platform == "linux" and hasattr(os, "openpty")):
        raise UsageError(f"{name} needs Linux")
    if name == "ctl":
        import socket

        if not hasattr(socket, "AF_UNIX"):
            raise UsageError("ctl needs Linux or macOS: this system has no unix sockets")


def command_of(name: str) -> ModuleType:
    """Module of a command, ours or that of another package.

    Raises
    ------
    UsageError
        There is no such command, or the package that adds it is broken.
    """
    if name in COMMANDS:
        return import_module(f"gyrodrift.cli.{name.replace('-', '_')}")
    from gyrodrift.cli.plug_ins import command_named

    return command_named(name, COMMANDS)


def parser_of(name: str) -> Parser:
    """Parser of a command, with its help."""
    command = command_of(name)
    parser = Parser(name, description=command.__doc__, epilog=f"examples:\n{indent(command.EXAMPLES, '  ')}\n{EPILOG}")
    command.add_arguments(parser)
    parser.add_argument("--quiet", action="store_true", help="no progress and no log but warnings and errors")
    parser.show_only(getattr(command, "COMMON", None))
    return parser


def program_parser() -> Parser:
    """Parser of the options without a command."""
    from gyrodrift.cli.plug_ins import listing, summaries
    from gyrodrift.io.installation import version_line

    groups = GROUPS | {"of other packages": dict(summaries(COMMANDS))}
    width = max(len(command) for commands in groups.values() for command in commands)
    names = "\n\n".join(
        "\n".join([f"{group}:", *(f"  {command:{width}}  {what}" for command, what in commands.items())])
        for group, commands in groups.items()
        if commands
    )
    lines = "".join(f"\n  {line}" for line in listing())
    added = f"\n\nplug-ins of other packages:{lines}" if lines else ""
    parser = Parser(
        usage="gyrodrift COMMAND ... (gyrodrift help COMMAND for its options)",
        description=f"Correct the yaw drift of a low-cost gyro in real time.\n\n{names}{added}",
        epilog=f"examples:\n{indent(EXAMPLES, '  ')}\n{EPILOG}",
    )
    parser.add_argument("--version", action="version", version=version_line())
    return parser


def _outside_of_commands(arguments: list[str], name: str) -> int:
    if name:
        command_of(name)
        raise UsageError(f"{name!r} stands behind options; write gyrodrift {name} first")
    parser = program_parser()
    parser.read(arguments)
    parser.print_help(sys.stderr)
    return UsageError.exit_status
