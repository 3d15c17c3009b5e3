"""Quarter turn of `doctor --turn` and `calibrate --turn`: port or file, instructions and output."""

import argparse
import sys
from dataclasses import replace

from gyrodrift.cli import numbers, options
from gyrodrift.doctor.finding import Severity, as_json, worst
from gyrodrift.doctor.show import Detail, show
from gyrodrift.doctor.turn.heard import TurnResult
from gyrodrift.doctor.turn.listen import TurnListener
from gyrodrift.doctor.turn.recorded import recorded_turn
from gyrodrift.doctor.turn.tell import config_lines, findings_of, paste, turn_json
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.port import serial_ports
from gyrodrift.values.errors import LinkError, UsageError


def run(arguments: argparse.Namespace) -> int:
    """Ask for a turn, or read it from files; 3 if a result is not clear."""
    _check(arguments)
    results = [recorded_turn(path, arguments.turn_at) for path in arguments.sessions] or [heard_turn(arguments)]
    for result in results:
        _print(arguments, result)
    return 0 if all(_is_good(result) for result in results) else LinkError.exit_status


def heard_turn(arguments: argparse.Namespace) -> TurnResult:
    """Ask for the turn at the port of a command, on stderr."""
    return TurnListener(_target(arguments), _say).listen()


def columns_by_turn(arguments: argparse.Namespace) -> str | None:
    """Columns found by a turn; None for a protocol without columns.

    Raises
    ------
    LinkError
        The turn is not clear.
    """
    if arguments.columns is not None:
        raise UsageError("--columns and --turn: use one of them; --turn finds the columns")
    result = heard_turn(arguments)
    if not result.is_found:
        raise LinkError(f"{result.heard.source}: {result.question}")
    for finding in findings_of(result):
        _say(f"{finding.says} {finding.do}".rstrip())
    return result.spec or None


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def _check(arguments: argparse.Namespace) -> None:
    if arguments.columns is not None:
        raise UsageError("--columns and --turn: use one of them; --turn finds the columns")
    if arguments.sessions and arguments.turn_at is None:
        raise UsageError("--turn: a file needs --turn-at S, the beginning of the turn in s after the first sample")
    if arguments.turn_at is not None and not arguments.sessions:
        raise UsageError("--turn-at is for a file; at a port use gyrodrift doctor --port PORT --turn")


def _target(arguments: argparse.Namespace) -> LinkOptions:
    """Named port, or the only port of this machine."""
    protocol = "auto" if arguments.protocol == "text" else arguments.protocol
    target = LinkOptions(
        arguments.port, numbers.baud(arguments.baud), protocol, arguments.timeout, None, arguments.send or b""
    )
    if target.port != options.AUTO_PORT:
        return target
    ports = serial_ports()
    if len(ports) != 1:
        there = ", ".join(port.name for port in ports) or "none"
        raise UsageError(f"--turn: name the port with --port; ports on this machine: {there}")
    return replace(target, port=ports[0].name)


def _print(arguments: argparse.Namespace, result: TurnResult) -> None:
    findings, source = findings_of(result), result.heard.source
    if arguments.json:
        print(as_json(source, findings, turn_json(result)))
        return

    show(source, findings, sys.stdout, Detail.ALL)
    if result.spec:
        print(f"\nOn the command line:\n  {paste(result)}\nor in the config:\n  {config_lines(result)}", end="")


def _is_good(result: TurnResult) -> bool:
    return worst(findings_of(result)) is not Severity.ERROR
