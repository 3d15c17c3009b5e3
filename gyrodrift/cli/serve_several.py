"""`serve` without --port: all gyros of the block `sources:` of the config, in one process."""

import argparse
from contextlib import ExitStack
from copy import copy
from pathlib import Path

from gyrodrift.cli import options, serving
from gyrodrift.cli.options import AUTO_PORT
from gyrodrift.config.sources import SourceSettings, load_sources
from gyrodrift.config.watch import ConfigWatch
from gyrodrift.io.log import open_log
from gyrodrift.io.logger import FilteringBoundLogger
from gyrodrift.link.events import LinkEvents
from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.service.aid_service import AidService
from gyrodrift.service.loop import Service
from gyrodrift.service.notify import SystemdNotify
from gyrodrift.service.several import SeveralServices
from gyrodrift.service.signals import StopSignal
from gyrodrift.service.source_lines import SharedLines, SourceLines
from gyrodrift.service.stdout import STDOUT
from gyrodrift.values.errors import UsageError

PER_SOURCE = ("baud", "protocol", "columns", "send", "filter", "axes")
"""Options that stand in the block of a source instead."""


def run(arguments: argparse.Namespace) -> int:
    """Run until a signal comes or all sources are over; 3 if a source has failed."""
    settings = _settings(arguments)
    serving.check_system(arguments, has_outputs=False)
    log, lines = open_log(options.log_level(arguments), arguments.log_format), SharedLines(STDOUT)
    with StopSignal() as stop, ExitStack() as closing:
        closing.callback(lines.close)
        with stop.at_once():
            gyros = {it.name: _service(arguments, it, lines, log, stop, closing) for it in settings if not it.aids}
            aids = [_second_source(arguments, source, gyros[source.aids], log) for source in settings if source.aids]
        notify = SystemdNotify()
        closing.callback(notify.stopping)
        return SeveralServices([*gyros.values(), *aids], log, stop, notify).run()
    return 0


def _settings(arguments: argparse.Namespace) -> tuple[SourceSettings, ...]:
    """Sources of the config; without any, --port is missing."""
    settings = () if arguments.config is None else load_sources(arguments.config)
    if not settings:
        raise UsageError("serve: the following arguments are required: --port, or --config with sources:")
    given = [f"--{name}" for name in PER_SOURCE if getattr(arguments, name) not in (None, "auto")]
    given += ["--output"] if arguments.output else []
    if given:
        raise UsageError(f"{given[0]}: with sources: in the config, set it in the block of a source")
    if any(source.port == AUTO_PORT for source in settings):
        raise UsageError(f"{arguments.config}: port: auto is for one gyro; name the port of each source")
    return settings


def _service(
    arguments: argparse.Namespace,
    source: SourceSettings,
    lines: SharedLines,
    log: FilteringBoundLogger,
    stop: StopSignal,
    closing: ExitStack,
) -> Service:
    own = _arguments_of(arguments, source)
    watch = ConfigWatch(arguments.config, source=source.name)
    own_log = log.bind(source=source.name)
    events = LinkEvents(own_log)
    options = LinkOptions(
        source.port,
        source.baud,
        source.protocol,
        source.timeout_s,
        watch.config.columns,
        watch.config.send,
        waits=True,
    )
    try:
        link = Link(options, events)
    except UsageError as error:  # it names --port, which nobody has written here
        raise UsageError(f"{arguments.config}: sources.{source.name}: {error}") from error
    closing.callback(link.close)
    sink = SourceLines(lines, source.name, arguments.rate)
    parts = serving.ServiceParts(link, events, own_log, watch, (sink, sink), stop, closing, source.name)
    return serving.service_of(own, parts, [])


def _second_source(
    arguments: argparse.Namespace, source: SourceSettings, gyro: Service, log: FilteringBoundLogger
) -> AidService:
    """A source that aids a gyro."""
    assert gyro.statements is not None  # noqa: S101 - every service of a gyro has them
    try:
        return AidService(source, gyro, gyro.statements, log.bind(source=source.name))
    except UsageError as error:  # it names --port, which nobody has written here
        raise UsageError(f"{arguments.config}: sources.{source.name}: {error}") from error


def _arguments_of(arguments: argparse.Namespace, source: SourceSettings) -> argparse.Namespace:
    """Options for one source: its own folder of recordings, memory file and control socket."""
    own = copy(arguments)
    own.port, own.protocol = source.port, source.protocol
    own.record = None if arguments.record is None else arguments.record / source.name
    own.memory, own.control = (_named(path, source.name) for path in (arguments.memory, arguments.control))
    return own


def _named(path: Path | None, source: str) -> Path | None:
    """`memory.json` becomes `memory-left.json`."""
    return None if path is None else path.with_name(f"{path.stem}-{source}{path.suffix}")
