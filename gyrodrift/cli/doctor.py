"""Check a device or a recording: report problems, what to do, and the drift to expect.

It checks the port from outside, listens as serve does, and compares port, line, stream and sensor with the expected
state. Leave the device still meanwhile. It shows problems and the expected drift; --verbose shows all findings. The
checks are listed in docs/doctor.md.

With --turn it asks for one quarter turn to the left instead. From the turn it determines which column of a text is
the yaw rate, its unit and its sign, and prints the --columns to paste.

With --config it listens to all gyros of the block sources: at once. With --one-body it compares gyros on one body, live
or in recordings of the same time, and says which of them drifts.

With --report FILE it also writes a file for the maintainers, with the same checks.

exit status: 0 no error (or no finding of --fail-on), 3 at least one, or an unclear turn, 2 wrong usage, 4 a recording
cannot be read.
"""

import argparse
import sys
from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from threading import Thread

from gyrodrift.cli import inputs, numbers, options, turning
from gyrodrift.cli.configs import simulated_ports
from gyrodrift.cli.parser import unknown
from gyrodrift.cli.plug_ins import listing
from gyrodrift.config.model import load_config
from gyrodrift.config.sources import load_sources
from gyrodrift.doctor.body import compare
from gyrodrift.doctor.checks.registry import examine
from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.doctor.finding import DeviceFinding, Severity, as_json, worst
from gyrodrift.doctor.listen import listen, recorded
from gyrodrift.doctor.report import report
from gyrodrift.doctor.sensors import SENSORS, Sensor, sensor_named
from gyrodrift.doctor.show import Detail, show
from gyrodrift.io.files import check_inputs_kept, check_writable, write_whole
from gyrodrift.io.progress import OnProgress, Progress
from gyrodrift.link.holder import is_console
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.port import serial_ports
from gyrodrift.link.search import find_gyro
from gyrodrift.link.sources.registry import source_devices
from gyrodrift.session.files import session_paths
from gyrodrift.values.errors import LinkError, PortMissingError, UsageError, visible

SEVERITIES = ("note", "warning", "error")

EXAMPLES = """\
gyrodrift doctor --port /dev/ttyUSB0 --sensor mpu6050
gyrodrift doctor session.mcap --json
gyrodrift doctor --port /dev/ttyUSB0 --turn
"""

COMMON = (
    "--port",
    "--duration",
    "--sensor",
    "--turn",
    "--config",
    "--one-body",
    "--json",
    "--verbose",
    "--columns",
    "--fail-on",
    "--report",
)
"""Options in the short help."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "sessions", type=Path, nargs="*", metavar="SESSION", help="recording to check instead of a port"
    )
    options.add_link_options(parser, default_port=options.AUTO_PORT)
    listen = "listen for TIME, such as 30 (s) or 10min; noise needs 30 s (default 30)"
    options.add_duration_option(parser, 30.0, listen, older="seconds")
    parser.add_argument(
        "--sensor", metavar="NAME", help="compare with the data sheet of this sensor (default: the name it sends)"
    )
    parser.add_argument(
        "--turn",
        action="store_true",
        help="ask for a quarter turn to the left, and find the column of the yaw rate, its unit and its sign",
    )
    parser.add_argument(
        "--turn-at",
        type=numbers.number(numbers.MOST_SECONDS, "seconds, 0 or more", least=0.0),
        metavar="S",
        help="the same for a turn in a file, S seconds after its beginning: a text, or a session recorded with --raw "
        "(default: none)",
    )
    parser.add_argument(
        "--config", type=Path, metavar="FILE", help="check all gyros of sources: in this config at once (default: none)"
    )
    parser.add_argument(
        "--one-body", action="store_true", help="the gyros are on one body: also say which of them drifts"
    )
    parser.add_argument(
        "--report",
        type=Path,
        metavar="FILE",
        help="also write a report for other people: device, versions, ten seconds of data and all checks, without "
        "secrets (default: none)",
    )
    parser.add_argument("--json", action="store_true", help="one JSON object a line instead, for each port or session")
    parser.add_argument("--verbose", action="store_true", help="show all findings, not only problems and drift")
    options.add_damage_option(parser)
    options.add_unit_options(parser)
    parser.add_argument(
        "--fail-on", choices=SEVERITIES, default="error", help="lowest severity that ends with status 3"
    )


def run(arguments: argparse.Namespace) -> int:
    """Check, and return 3 if a finding is as severe as --fail-on."""
    if arguments.turn or arguments.turn_at is not None:
        return turning.run(arguments)
    chosen_sensor = _sensor(arguments.sensor)
    severity = Severity.OK
    if arguments.report is not None:
        check_inputs_kept([arguments.report], arguments.sessions)
        check_writable(arguments.report.parent)
    evidences = _evidence(arguments)
    examined = []
    if arguments.one_body and len(evidences) < 2:
        raise UsageError("--one-body: needs two gyros: --config with sources:, or two recordings")
    for evidence in evidences:
        sensor = chosen_sensor or sensor_named(evidence.device.device_id or "")
        findings = examine(replace(evidence, sensor=sensor))
        examined.append((replace(evidence, sensor=sensor), findings))
        severity = max(severity, worst(findings), key=lambda severity: severity.rank)
        _print(arguments, evidence.source, findings)
    for source, findings in _comparisons(evidences) if arguments.one_body else ():
        severity = max(severity, worst(findings), key=lambda severity: severity.rank)
        _print(arguments, source, findings)
    if arguments.report is not None:
        write_whole(arguments.report, [report(examined, list(listing()))])
        print(visible(f"gyrodrift: wrote {arguments.report}; read it before you send it"), file=sys.stderr)
    return LinkError.exit_status if severity.rank >= Severity(arguments.fail_on).rank else 0


def _comparisons(evidences: list[DeviceEvidence]) -> Iterator[tuple[str, list[DeviceFinding]]]:
    """Findings about each two of the gyros."""
    for first, second in combinations(evidences, 2):
        yield f"{first.source} and {second.source}", compare(first, second)


def _print(arguments: argparse.Namespace, source: str, findings: list[DeviceFinding]) -> None:
    if arguments.json:
        print(as_json(source, findings))
        return

    detail = Detail.PROBLEMS if arguments.quiet else Detail.ALL if arguments.verbose else Detail.SUMMARY
    show(source, findings, sys.stdout, detail)


def _evidence(arguments: argparse.Namespace) -> list[DeviceEvidence]:
    """Evidence from the recordings, or from the port."""
    if arguments.config is not None:
        return _all_sources(arguments)
    if not arguments.sessions:
        with options.progress_of(arguments) as progress:
            return [_at_port(arguments, numbers.baud(arguments.baud), progress)]
    paths = session_paths(arguments.sessions)
    inputs.check_damage(paths, arguments)
    recordings = [recorded(path, inputs.reading(arguments)) for path in paths]
    for path, evidence in zip(paths, recordings, strict=True):
        if evidence.facts is not None:
            inputs.print_remarks(path, evidence.facts.session)
    return recordings


def _all_sources(arguments: argparse.Namespace) -> list[DeviceEvidence]:
    """Evidence from all gyros of the config, heard at once."""
    settings = [source for source in load_sources(arguments.config) if not source.aids]
    if not settings or arguments.sessions:
        raise UsageError("--config: needs a config with sources:, and no recording beside it")
    evidences = [DeviceEvidence(source.name) for source in settings]

    def hear(index: int, progress: OnProgress) -> None:
        source, config = settings[index], load_config(arguments.config, settings[index].name)
        timeout_s = source.timeout_s or arguments.timeout
        target = LinkOptions(source.port, source.baud, source.protocol, timeout_s, config.columns, config.send)
        evidences[index] = replace(listen(target, arguments.seconds, progress), source=source.name)

    def silent(_task: str, _done: int, _total: int) -> None:
        """Show nothing: one of the gyros shows the progress of all."""

    threads = [Thread(target=hear, args=(index, silent), daemon=True) for index in range(1, len(settings))]
    for thread in threads:
        thread.start()
    with options.progress_of(arguments) as progress:
        hear(0, progress.report)
    for thread in threads:
        thread.join()
    return evidences


def _at_port(arguments: argparse.Namespace, baud: int | None, progress: Progress) -> DeviceEvidence:
    """Evidence from the named port, or from the port of the gyro that is plugged in."""
    link_options = LinkOptions(
        arguments.port, baud, arguments.protocol, arguments.timeout, arguments.columns, arguments.send or b""
    )
    if link_options.port != options.AUTO_PORT:
        return listen(link_options, arguments.seconds, progress.report)
    ports = serial_ports()
    if len(ports) == 1 and not is_console(ports[0].device):  # a single port is checked even if no gyro speaks there
        return listen(replace(link_options, port=ports[0].name), arguments.seconds, progress.report)
    try:
        target, port = find_gyro(ports, link_options, lambda *_, **__: None, simulated_ports(), source_devices())
    except (UsageError, PortMissingError) as error:
        if not str(error).startswith("--port auto"):
            raise
        return DeviceEvidence(options.AUTO_PORT, search=str(error))
    return listen(target, arguments.seconds, progress.report, port)


def _sensor(name: str | None) -> Sensor | None:
    if name is None:
        return None
    sensor = sensor_named(name)
    if sensor is None:
        raise unknown("sensor", f"--sensor {name}", [sensor.name for sensor in SENSORS])
    return sensor
