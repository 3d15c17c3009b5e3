"""Read a gyro on a serial port, correct its drift, and print yaw until SIGINT or SIGTERM.

On a terminal one line shows yaw, bias, rest and link. In a pipe, or with --json, stdout gets a JSON line per sample:
seq, t_s (device clock, s), rate_dps (as measured), corrected_dps, yaw_deg, bias_dps. The filter restlevel adds
yaw_sigma_deg and confidence; encoder_deg and temp_c are there when the device sends them. The log goes to stderr.
"""

import argparse
import os
import secrets
import socket
import sys
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO, cast

from gyrodrift.cli import configs, numbers, options
from gyrodrift.errors import UsageError

if TYPE_CHECKING:
    from gyrodrift.config.watch import ConfigWatch
    from gyrodrift.filters.filter import Filter, FilterState
    from gyrodrift.link.events import LinkEvents
    from gyrodrift.logger import FilteringBoundLogger
    from gyrodrift.outputs.options import OutputSpec
    from gyrodrift.recording.resilient import ResilientRecorder
    from gyrodrift.service.control import Control
    from gyrodrift.service.filtering import Filtering
    from gyrodrift.service.listener import SampleListener
    from gyrodrift.service.memory_keeper import MemoryKeeper
    from gyrodrift.service.recording_switch import RecordingSwitch
    from gyrodrift.service.reporting import Reporting
    from gyrodrift.service.rest_word import RestWord
    from gyrodrift.service.signals import StopSignal
    from gyrodrift.service.stdout import JsonLines


class ListOutputs(argparse.Action):
    """Print every output with its options, and end."""

    def __init__(self, option_strings: Sequence[str], dest: str, **words: Any) -> None:
        super().__init__(option_strings, dest, nargs=0, **words)

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        """Print the list."""
        from gyrodrift.config.outputs import options_help
        from gyrodrift.installation import extra_command
        from gyrodrift.outputs.registry import OUTPUTS

        for name, kind in OUTPUTS.items():
            needs = f" (needs {extra_command(kind.extra)})" if kind.extra else ""
            print(f"{name}: {kind.help}{needs}")
            for option, default, meaning in options_help(name):
                print(f"  {option}={default}: {meaning}")
        parser.exit()


DEFAULT_FOLDER = Path("sessions")
"""Folder of `ctl record start` without --record, in the working directory of the service."""

EXAMPLES = """\
gyrodrift serve --port auto
gyrodrift serve --port /dev/ttyUSB0 --config my.yaml --rate 10
gyrodrift serve --port /dev/ttyUSB0 --record sessions --rotate 1h > yaw.jsonl
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    options.add_link_options(parser)
    options.add_filter_options(parser, "YAML with a filter and its parameters; followed while serve runs")
    parser.add_argument(
        "--json",
        action="store_true",
        help="print JSON lines on a terminal, too, in place of one line with the state (default: only in a pipe)",
    )
    parser.add_argument(
        "--rate", type=numbers.number(1e6), metavar="HZ", help="at most HZ lines a second of device time (default: all)"
    )
    parser.add_argument(
        "--record", type=Path, metavar="DIR", help="record the device into this folder too (default: none)"
    )
    parser.add_argument(
        "--output",
        action="append",
        default=[],
        metavar="NAME[:KEY=VALUE,...]",
        help="send samples to this output too; repeatable; --list-outputs prints names and keys (default: none)",
    )
    parser.add_argument("--list-outputs", action=ListOutputs, help="print the outputs with their options, and end")
    parser.add_argument(
        "--control",
        type=Path,
        metavar="PATH",
        help="unix socket through which this user controls the service: gyrodrift ctl, top, and the buttons of the "
        "live page (default: none)",
    )
    parser.add_argument(
        "--memory",
        type=Path,
        metavar="FILE",
        help="keep what the filter learned about the device in this file across restarts; from a recording (.mcap) the "
        "filter takes its initial state, and the file stays as it is (default: none)",
    )
    options.add_recording_options(parser)
    options.add_log_options(parser)


def run(arguments: argparse.Namespace) -> int:
    """Run until a signal comes; exit status 0."""
    numbers.rotation(arguments.rotate)
    baud = numbers.baud(arguments.baud)
    specs = _outputs(arguments.output)
    watch = _watch(arguments.config)
    _check_system(arguments, has_outputs=bool(specs or (watch is not None and watch.config.outputs)))

    from gyrodrift.filters.registry import DEFAULT, FILTERS
    from gyrodrift.link.events import LinkEvents
    from gyrodrift.link.link import Link
    from gyrodrift.service.filtering import Filtering
    from gyrodrift.service.live_line import ServiceLine
    from gyrodrift.service.loop import Service
    from gyrodrift.service.notify import SystemdNotify
    from gyrodrift.service.rest_word import RestWord
    from gyrodrift.service.signals import StopSignal
    from gyrodrift.service.stdout import STDOUT, JsonLines

    has_person = _has_person(arguments)
    log = _log(arguments, has_person=has_person)
    events = LinkEvents(log)
    from_config = (watch.config.columns, watch.config.send) if watch else ()
    target, port = configs.link_target(arguments, baud, events, *from_config)
    with StopSignal() as stop, ExitStack() as closing:
        link = Link(target, events, port=port)
        stdout = None if has_person else JsonLines(STDOUT, arguments.rate)
        sink = stdout or ServiceLine(link, STDOUT)
        filtering = Filtering(
            link, [sink], log, watch, chosen=FILTERS[arguments.filter or DEFAULT.name], axes=arguments.axes
        )
        events.listeners.append(filtering.hear)
        recording = _recording(arguments, filtering, events, log)
        listeners: list[SampleListener] = [recording, filtering]
        _follow_config(arguments, filtering)
        keeper = _memory(arguments.memory, filtering, listeners)
        word, control = RestWord(), None
        if specs or watch is not None or arguments.control is not None:
            reporting = _reporting(arguments, specs, filtering, listeners, events)
            reporting.memory, reporting.recording = keeper, recording
            if arguments.control is not None:
                control = _control(arguments.control, listeners, reporting, stdout, stop, word)
                closing.callback(control.close)
            reporting.feed.want([*specs, *(watch.config.outputs if watch else ())])
        notify = SystemdNotify()
        closing.callback(notify.stopping)
        Service(link, listeners, log, events, stop, filtering.sinks, control, notify, word, is_watched=has_person).run()
    return 0


def _check_system(arguments: argparse.Namespace, *, has_outputs: bool) -> None:
    """Refuse outputs and control on a system without unix sockets."""
    if has_outputs and not (sys.platform == "linux" and hasattr(socket, "AF_UNIX")):
        raise UsageError("outputs need Linux: their process is reached through a unix socket that keeps messages whole")
    if arguments.control is not None and not hasattr(socket, "AF_UNIX"):
        raise UsageError("--control needs Linux or macOS: this system has no unix sockets")


def _watch(path: Path | None) -> "ConfigWatch | None":
    """The config of `--config`, followed from now on."""
    if path is None:
        return None
    from gyrodrift.config.watch import ConfigWatch

    return ConfigWatch(path)


def _has_person(arguments: argparse.Namespace) -> bool:
    """Whether a person reads stdout, and not a program."""
    return sys.stdout.isatty() and not arguments.json and os.environ.get("TERM") != "dumb"


def _log(arguments: argparse.Namespace, *, has_person: bool) -> "FilteringBoundLogger":
    """Logger on stderr; its lines stand above the line on stdout if both are the terminal."""
    from gyrodrift.log import open_log, unwaiting_stderr
    from gyrodrift.recording.live_line import AboveLine

    above = None
    if has_person and sys.stderr.isatty():
        above = AboveLine(cast("TextIO", unwaiting_stderr(arguments.log_format)))
    return open_log(options.log_level(arguments), arguments.log_format, above)


def _follow_config(arguments: argparse.Namespace, filtering: "Filtering") -> None:
    """Let a new config change the link, unless an option fixes it."""
    link = filtering.link
    if configs.reads_columns_of_config(arguments):
        filtering.config_listeners.append(lambda new: link.follow_columns(new.columns))
    if not arguments.send:
        filtering.config_listeners.append(lambda new: link.send_at_opening(new.send))


def _control(
    path: Path,
    listeners: "list[SampleListener]",
    reporting: "Reporting",
    stdout: "JsonLines | None",
    stop: "StopSignal",
    word: "RestWord",
) -> "Control":
    """The socket of `--control`; the live page reaches it with a token."""
    from gyrodrift.outputs.output import ControlAccess
    from gyrodrift.service.commands import ServiceCommands
    from gyrodrift.service.control import Control
    from gyrodrift.service.guided import GuidedCalibration

    filtering, recording = reporting.filtering, reporting.recording
    assert recording is not None  # noqa: S101 - `run` has set it
    calibration = GuidedCalibration(filtering)
    listeners.append(calibration)
    access = reporting.feed.access = ControlAccess(str(path.absolute()), secrets.token_urlsafe(32))
    commands = ServiceCommands(filtering, stdout, reporting, stop, word, recording, calibration, access)
    return Control(path, commands.all(), filtering.log)


def _reporting(
    arguments: argparse.Namespace,
    specs: "list[OutputSpec]",
    filtering: "Filtering",
    listeners: "list[SampleListener]",
    events: "LinkEvents",
) -> "Reporting":
    """State of the service and the feed of the outputs; both hear samples and events."""
    from gyrodrift.service.link_meter import LinkMeter
    from gyrodrift.service.output_feed import OutputFeed
    from gyrodrift.service.reporting import Reporting

    meter = LinkMeter(filtering.link)
    feed = OutputFeed(filtering.log, options.log_level(arguments), arguments.log_format)
    reporting = Reporting(meter, filtering, feed)
    filtering.sinks.append(feed)
    filtering.event_listeners.append(feed.hear)
    filtering.config_listeners.append(lambda new: feed.want([*specs, *new.outputs]))
    feed.state = reporting.status
    events.listeners.append(feed.hear)
    listeners.insert(0, meter)
    return reporting


def _recording(
    arguments: argparse.Namespace, filtering: "Filtering", events: "LinkEvents", log: "FilteringBoundLogger"
) -> "RecordingSwitch":
    """The recorder of `--record`, on from the start; without that option `ctl record start` begins one."""
    from gyrodrift.service.recording_switch import RecordingSwitch

    rotate_bytes, rotate_s = numbers.rotation(arguments.rotate)
    folder = DEFAULT_FOLDER if arguments.record is None else arguments.record
    words = (folder, arguments.profile, arguments.note, rotate_bytes, rotate_s, arguments.raw)

    def make() -> "ResilientRecorder":
        from gyrodrift.filters.beginning import beginning_table as beginning
        from gyrodrift.recording.recorder import RecordOptions
        from gyrodrift.recording.resilient import ResilientRecorder

        config = None if filtering.watch is None else filtering.watch.config
        about, mode = ({}, 0o666) if config is None else (configs.config_tables(arguments.config, config), config.mode)
        return ResilientRecorder(
            RecordOptions(*words, about, lambda: beginning(filtering.run), mode), filtering.link, log
        )

    recording = RecordingSwitch(make)
    if arguments.record is not None:
        from gyrodrift.recording.resilient import repair_interrupted

        recording.start()
        repair_interrupted(folder, log)
    events.listeners.append(recording.on_event)
    filtering.event_listeners.append(recording.on_event)
    filtering.config_listeners.append(
        lambda new: recording.set_about(configs.config_tables(arguments.config, new), new.mode)
    )
    return recording


def _memory(path: Path | None, filtering: "Filtering", listeners: "list[SampleListener]") -> "MemoryKeeper | None":
    """The keeper of `--memory`. It acts before the first sample reaches filter and recording."""
    if path is None:
        return None
    if path.suffix == ".mcap":
        filtering.begin_with(_recorded_beginning(path, filtering.filter))
        return None
    from gyrodrift.service.memory_keeper import MemoryKeeper

    keeper = MemoryKeeper(path, filtering, filtering.log)
    listeners.insert(0, keeper)
    return keeper


def _recorded_beginning(path: Path, kind: "Filter") -> "FilterState":
    """Initial state of this filter in a recording."""
    from gyrodrift.filters.beginning import beginning_of
    from gyrodrift.session.files import load_session

    state = beginning_of(kind, load_session(path).metadata, str(path))
    if state is None:
        raise UsageError(f"--memory {path}: holds no initial state of the filter {kind.name}")
    return state


def _outputs(texts: list[str]) -> "list[OutputSpec]":
    """Outputs of `--output`; their checker is loaded only if there are any."""
    if not texts:
        return []
    from gyrodrift.config.outputs import output_of

    return [output_of(text) for text in texts]
