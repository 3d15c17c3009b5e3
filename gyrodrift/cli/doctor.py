"""Say in plain sentences what is wrong with a device, or a recording of one, and what to do.

It looks at the port from outside, listens like serve, and compares what comes with what should: port, line, stream,
sensor, and the drift that each filter will leave. Leave the device still meanwhile. The checks stand in docs/doctor.md.

With --turn it asks for one quarter turn to the left instead, and tells from it which column of a text is the yaw rate,
in which unit and with which sign: the --columns to paste, and the same for a config.

exit status: 0 no error among the findings (of --fail-on), 3 at least one or a turn that told nothing, 2 wrong usage,
4 a recording that cannot be read.
"""

import argparse
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from gyrodrift.cli import numbers, options
from gyrodrift.errors import LinkError, PortMissingError, UsageError

if TYPE_CHECKING:
    from gyrodrift.doctor.evidence import DeviceEvidence
    from gyrodrift.doctor.sensors import Sensor
    from gyrodrift.progress import Progress

SEVERITIES = ("note", "warning", "error")

EXAMPLES = """\
gyrodrift doctor --port /dev/ttyUSB0 --sensor mpu6050
gyrodrift doctor session.mcap --json
gyrodrift doctor --port /dev/ttyUSB0 --turn
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "sessions", type=Path, nargs="*", metavar="SESSION", help="a recording to look at instead of a port"
    )
    options.add_link_options(parser, default_port=options.AUTO_PORT)
    parser.add_argument(
        "--seconds",
        type=numbers.seconds,
        default=30.0,
        metavar="S",
        help="listen for S seconds; noise wants 30 of them",
    )
    parser.add_argument(
        "--sensor", metavar="NAME", help="compare with the data sheet of this sensor (default: as named)"
    )
    parser.add_argument(
        "--turn",
        action="store_true",
        help="ask for a quarter turn to the left, and tell by it which column is the yaw rate, its unit and its sign",
    )
    parser.add_argument(
        "--turn-at",
        type=numbers.number(numbers.MOST_SECONDS, "seconds, 0 or more", least=0.0),
        metavar="S",
        help="the same of a turn that begins S seconds after the beginning of a file: of a session that was recorded "
        "with --raw, or of a text (default: none)",
    )
    parser.add_argument("--json", action="store_true", help="one JSON object a line instead, for each port or session")
    options.add_damage_option(parser)
    options.add_unit_options(parser)
    parser.add_argument(
        "--fail-on", choices=SEVERITIES, default="error", help="the least severity that ends with status 3"
    )


def run(arguments: argparse.Namespace) -> int:
    """Look, listen, tell; 3 where something is as severe as --fail-on."""
    if arguments.turn or arguments.turn_at is not None:
        from gyrodrift.cli import turning

        return turning.run(arguments)
    seconds = arguments.seconds
    baud = numbers.baud(arguments.baud)
    options.hold_product_threads()
    from gyrodrift.doctor.checks.registry import examine
    from gyrodrift.doctor.finding import Severity, worst
    from gyrodrift.doctor.recorded import recorded
    from gyrodrift.doctor.sensors import sensor_named
    from gyrodrift.doctor.show import as_json, show

    asked = _sensor(arguments.sensor)
    if arguments.sessions:
        from gyrodrift.session.files import session_paths

        paths = session_paths(arguments.sessions)
        options.check_damage(paths, allow_damage=arguments.allow_damage)
        seen = [recorded(path, options.reading(arguments)) for path in paths]
        for path, evidence in zip(paths, seen, strict=True):
            if evidence.session is not None:
                options.tell_remarks(path, evidence.session)
    else:
        with options.progress_of(arguments) as progress:
            seen = [_heard(arguments, baud, seconds, progress)]
    found = Severity.OK
    for evidence in seen:
        sensor = asked or sensor_named(evidence.device.device_id or "")
        findings = examine(replace(evidence, sensor=sensor))
        found = max(found, worst(findings), key=lambda each: each.rank)
        if arguments.json:
            print(as_json(evidence.source, findings))
        else:
            show(evidence.source, findings, sys.stdout, is_quiet=arguments.quiet)
    return LinkError.exit_status if found.rank >= Severity(arguments.fail_on).rank else 0


def _heard(arguments: argparse.Namespace, baud: int | None, seconds: float, progress: "Progress") -> "DeviceEvidence":
    """What is seen at the port, the one there is where none is named."""
    from gyrodrift.doctor.evidence import DeviceEvidence
    from gyrodrift.doctor.listen import listen
    from gyrodrift.link.link import LinkOptions
    from gyrodrift.link.port import serial_ports
    from gyrodrift.link.search import find_gyro

    asked = LinkOptions(
        arguments.port, baud, arguments.protocol, arguments.timeout, arguments.columns, arguments.send or b""
    )
    if asked.port != options.AUTO_PORT:
        return listen(asked, seconds, progress.evaluated)
    ports = serial_ports()
    if len(ports) == 1:  # it is told what is wrong with it, whatever it is
        return listen(replace(asked, port=ports[0].name), seconds, progress.evaluated)
    try:
        target, port = find_gyro(ports, asked, lambda *_, **__: None)
    except (UsageError, PortMissingError) as error:
        if not str(error).startswith("--port auto"):
            raise
        return DeviceEvidence(options.AUTO_PORT, search=str(error))
    return listen(target, seconds, progress.evaluated, port)


def _sensor(name: str | None) -> "Sensor | None":
    from gyrodrift.cli.parser import unknown
    from gyrodrift.doctor.sensors import SENSORS, sensor_named

    found = sensor_named(name) if name is not None else None
    if name is not None and found is None:
        raise unknown("sensor", f"--sensor {name}", [each.name for each in SENSORS])
    return found
