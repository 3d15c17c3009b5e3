"""Parts that `serve` builds for every gyro: recording, filter, memory, outputs, control and log."""

import argparse
import secrets
import socket
import sys
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from gyrodrift.cli import configs, numbers, options
from gyrodrift.filters.filter import Filter, FilterState
from gyrodrift.filters.registry import DEFAULT, FILTERS
from gyrodrift.io.log import open_log
from gyrodrift.io.logger import FilteringBoundLogger
from gyrodrift.link.events import LinkEvents
from gyrodrift.link.link import Link
from gyrodrift.service.config_follower import ConfigFollower
from gyrodrift.service.history import History
from gyrodrift.service.listener import SampleListener, Sink
from gyrodrift.service.live_line import ServiceLine
from gyrodrift.service.loop import Service, Statements
from gyrodrift.service.notify import SystemdNotify
from gyrodrift.service.pipeline import Pipeline
from gyrodrift.service.recording_switch import RecordingSwitch
from gyrodrift.service.signals import StopSignal
from gyrodrift.service.source_lines import SourceLines
from gyrodrift.service.stdout import STDOUT, JsonLines
from gyrodrift.values.errors import UsageError

if TYPE_CHECKING:
    from gyrodrift.config.watch import ConfigWatch
    from gyrodrift.outputs.options import OutputSpec
    from gyrodrift.recording.resilient import ResilientRecorder
    from gyrodrift.service.control import Control
    from gyrodrift.service.memory_keeper import MemoryKeeper
    from gyrodrift.service.reporting import Reporting

DEFAULT_FOLDER = Path("sessions")
"""Folder of `ctl record start` without --record, in the working directory of the service."""


@dataclass(frozen=True, slots=True)
class ServiceParts:
    """Parts of the service of a gyro, made before it.

    sinks
        Sink of stdout, and the same one if it writes JSON lines, whose rate `ctl` sets.
    source
        Name of the source; empty if there is one gyro.
    """

    link: Link
    events: LinkEvents
    log: FilteringBoundLogger
    watch: "ConfigWatch | None"
    sinks: tuple[Sink, JsonLines | SourceLines | None]
    stop: StopSignal
    closing: ExitStack
    source: str = ""


def serve(
    arguments: argparse.Namespace,
    baud: int | None,
    watch: "ConfigWatch | None",
    specs: "list[OutputSpec]",
    *,
    has_person: bool,
) -> None:
    """Serve the one gyro of `--port` until a signal comes."""
    check_system(arguments, has_outputs=bool(specs or (watch is not None and watch.config.outputs)))
    log = open_log(options.log_level(arguments), arguments.log_format)
    events = LinkEvents(log)
    from_config = (watch.config.columns, watch.config.send) if watch else ()
    target, port = configs.link_target(arguments, baud, events, *from_config)
    with StopSignal() as stop, ExitStack() as closing:
        with stop.at_once():
            link = Link(target, events, port=port)
        stdout = None if has_person else JsonLines(STDOUT, arguments.rate)
        sinks = (stdout or ServiceLine(link, STDOUT), stdout)
        service = service_of(arguments, ServiceParts(link, events, log, watch, sinks, stop, closing), specs)
        service.notify, service.is_watched = SystemdNotify(), has_person
        closing.callback(service.notify.stopping)
        service.run()


def service_of(arguments: argparse.Namespace, parts: ServiceParts, specs: "list[OutputSpec]") -> Service:
    """The service of a gyro: recording, filter, memory, outputs and control, as the options and its config say."""
    link, events, log, watch = parts.link, parts.events, parts.log, parts.watch
    sink, stdout = parts.sinks
    chosen = FILTERS[arguments.filter or DEFAULT.name]
    config, source = (None, "defaults") if watch is None else (watch.config, str(watch.path))
    pipeline = Pipeline(link, [sink], log, config, source, chosen, arguments.axes)
    pipeline.history = None if watch is None else History()
    follower = ConfigFollower(pipeline, watch)
    events.listeners.append(pipeline.hear)
    recording = _recording(arguments, follower, events, log)
    listeners: list[SampleListener] = [recording, pipeline, *([] if watch is None else [follower])]
    _follow_config(arguments, follower)
    keeper = _memory(arguments.memory, pipeline, listeners)
    statements, control = Statements(), None
    if specs or watch is not None or arguments.control is not None:
        reporting = _reporting(arguments, specs, follower, listeners, events, parts.source)
        reporting.memory, reporting.recording = keeper, recording
        if arguments.control is not None:
            control = _control(arguments.control, listeners, reporting, stdout, parts.stop, statements)
            parts.closing.callback(control.close)
        reporting.feed.want([*specs, *(watch.config.outputs if watch else ())])
    return Service(link, listeners, log, events, parts.stop, pipeline.sinks, control, statements=statements)


def check_system(arguments: argparse.Namespace, *, has_outputs: bool) -> None:
    """Refuse outputs and control on a system without unix sockets."""
    if has_outputs and not (sys.platform == "linux" and hasattr(socket, "AF_UNIX")):
        raise UsageError("outputs need Linux: their process is reached through a unix socket that keeps messages whole")
    if arguments.control is not None and not hasattr(socket, "AF_UNIX"):
        raise UsageError("--control needs Linux or macOS: this system has no unix sockets")


def _follow_config(arguments: argparse.Namespace, follower: ConfigFollower) -> None:
    """Let a new config change the link, unless an option fixes it."""
    link = follower.pipeline.link
    if configs.reads_columns_of_config(arguments):
        follower.listeners.append(lambda new: link.follow_columns(new.columns))
    if not arguments.send:
        follower.listeners.append(lambda new: link.send_at_opening(new.send))


def _control(
    path: Path,
    listeners: list[SampleListener],
    reporting: "Reporting",
    stdout: JsonLines | SourceLines | None,
    stop: StopSignal,
    statements: Statements,
) -> "Control":
    """The socket of `--control`; the live page reaches it with a token."""
    from gyrodrift.outputs.output import ControlAccess
    from gyrodrift.service.commands import ServiceCommands
    from gyrodrift.service.control import Control
    from gyrodrift.service.guided import GuidedCalibration

    follower, recording = reporting.follower, reporting.recording
    assert recording is not None  # noqa: S101 - `run` has set it
    calibration = GuidedCalibration(follower.pipeline, follower.watch)
    listeners.append(calibration)
    access = reporting.feed.access = ControlAccess(str(path.absolute()), secrets.token_urlsafe(32))
    commands = ServiceCommands(follower, stdout, reporting, stop, statements, recording, calibration, access)
    return Control(path, commands.all(), follower.pipeline.log)


def _reporting(
    arguments: argparse.Namespace,
    specs: "list[OutputSpec]",
    follower: ConfigFollower,
    listeners: list[SampleListener],
    events: LinkEvents,
    source: str,
) -> "Reporting":
    """State of the service and the feed of the outputs; both hear samples and events."""
    from gyrodrift.service.output_feed import OutputFeed
    from gyrodrift.service.reporting import LinkMeter, Reporting

    pipeline = follower.pipeline
    meter = LinkMeter(pipeline.link)
    feed = OutputFeed(pipeline.log, options.log_level(arguments), arguments.log_format, source=source)
    reporting = Reporting(meter, follower, feed)
    pipeline.sinks.append(feed)
    pipeline.event_listeners.append(feed.hear)
    follower.listeners.append(lambda new: feed.want([*specs, *new.outputs]))
    feed.state = reporting.status
    events.listeners.append(feed.hear)
    listeners.insert(0, meter)
    return reporting


def _recording(
    arguments: argparse.Namespace, follower: ConfigFollower, events: LinkEvents, log: FilteringBoundLogger
) -> RecordingSwitch:
    """The recorder of `--record`, on from the start; without that option `ctl record start` begins one."""
    rotate_bytes, rotate_s = numbers.rotation(arguments.rotate)
    pipeline, watch = follower.pipeline, follower.watch
    folder = DEFAULT_FOLDER if arguments.record is None else arguments.record
    words = (folder, arguments.profile, arguments.note, rotate_bytes, rotate_s, arguments.raw)

    def make() -> "ResilientRecorder":
        from gyrodrift.filters.beginning import beginning_table as beginning
        from gyrodrift.recording.recorder import RecordOptions
        from gyrodrift.recording.resilient import ResilientRecorder

        config = None if watch is None else watch.config
        about, mode = ({}, 0o666) if config is None else (configs.config_tables(arguments.config, config), config.mode)
        return ResilientRecorder(
            RecordOptions(*words, about, lambda: beginning(pipeline.run), mode), pipeline.link, log
        )

    recording = RecordingSwitch(make)
    if arguments.record is not None:
        from gyrodrift.recording.resilient import repair_interrupted

        recording.start()
        repair_interrupted(folder, log)
    events.listeners.append(recording.on_event)
    pipeline.event_listeners.append(recording.on_event)
    follower.listeners.append(lambda new: recording.set_about(configs.config_tables(arguments.config, new), new.mode))
    return recording


def _memory(path: Path | None, pipeline: Pipeline, listeners: list[SampleListener]) -> "MemoryKeeper | None":
    """The keeper of `--memory`. It acts before the first sample reaches filter and recording."""
    if path is None:
        return None
    if path.suffix == ".mcap":
        pipeline.begin_with(_recorded_beginning(path, pipeline.filter))
        return None
    from gyrodrift.service.memory_keeper import MemoryKeeper

    keeper = MemoryKeeper(path, pipeline, pipeline.log)
    listeners.insert(0, keeper)
    return keeper


def _recorded_beginning(path: Path, kind: Filter) -> FilterState:
    """Initial state of this filter in a recording."""
    from gyrodrift.filters.beginning import beginning_of
    from gyrodrift.session.files import load_session

    state = beginning_of(kind, load_session(path).metadata, str(path))
    if state is None:
        raise UsageError(f"--memory {path}: holds no initial state of the filter {kind.name}")
    return state
