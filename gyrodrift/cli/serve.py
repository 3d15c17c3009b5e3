"""Read a gyro on a serial port, correct its drift, and emit yaw as JSON lines on stdout until SIGINT or SIGTERM.

Each line has seq, t_s (device clock, s), rate_dps (as measured), corrected_dps, yaw_deg, bias_dps, with the filter
restlevel yaw_sigma_deg and confidence, and encoder_deg and temp_c where the device sends them. The log goes to stderr.
"""

import argparse
import os
import sys
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO, cast

from gyrodrift.cli import numbers, options
from gyrodrift.errors import UsageError

if TYPE_CHECKING:
    from gyrodrift.filters.filter import Filter, FilterState
    from gyrodrift.link.events import LinkEvents
    from gyrodrift.logger import FilteringBoundLogger
    from gyrodrift.outputs.options import OutputSpec
    from gyrodrift.service.commands import ServiceCommands
    from gyrodrift.service.control import Control
    from gyrodrift.service.filtering import Filtering
    from gyrodrift.service.listener import SampleListener
    from gyrodrift.service.memory_keeper import MemoryKeeper
    from gyrodrift.service.reporting import Reporting


class ListOutputs(argparse.Action):
    """Tells every output and every option, as `--help` tells the rest."""

    def __init__(self, option_strings: Sequence[str], dest: str, **words: Any) -> None:
        super().__init__(option_strings, dest, nargs=0, **words)

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        """Print and end."""
        from gyrodrift.config.outputs import options_help
        from gyrodrift.installation import extra_command
        from gyrodrift.outputs.registry import OUTPUTS

        for name, kind in OUTPUTS.items():
            needs = f" (needs {extra_command(kind.extra)})" if kind.extra else ""
            print(f"{name}: {kind.help}{needs}")
            for option, default, meaning in options_help(name):
                print(f"  {option}={default}: {meaning}")
        parser.exit()


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
        help="print JSON lines on a terminal too, where one line shows the state otherwise (default: in a pipe only)",
    )
    parser.add_argument(
        "--rate", type=numbers.number(1e6), metavar="HZ", help="at most HZ lines a second of device time (default: all)"
    )
    parser.add_argument(
        "--record", type=Path, metavar="DIR", help="write what the device sends into this folder too (default: none)"
    )
    parser.add_argument(
        "--output",
        action="append",
        default=[],
        metavar="NAME[:KEY=VALUE,...]",
        help="send samples there too; repeatable. --list-outputs tells names and keys (default: none)",
    )
    parser.add_argument("--list-outputs", action=ListOutputs, help="print the outputs with their options, and end")
    parser.add_argument(
        "--control",
        type=Path,
        metavar="PATH",
        help="let this user control the service through a unix socket: gyrodrift ctl (default: none)",
    )
    parser.add_argument(
        "--memory",
        type=Path,
        metavar="FILE",
        help="keep what the filter knows of the device in this file across restarts; a recording (.mcap) is read only: "
        "the filter begins as it began there (default: none)",
    )
    options.add_recording_options(parser)
    options.add_log_options(parser)


def run(arguments: argparse.Namespace) -> int:
    """Run until a signal comes; 0 then."""
    rate_hz = arguments.rate
    numbers.rotation(arguments.rotate)
    baud = numbers.baud(arguments.baud)
    asked = _outputs(arguments.output)
    watch = None
    if arguments.config is not None:
        from gyrodrift.config.watch import ConfigWatch

        watch = ConfigWatch(arguments.config)

    from gyrodrift.filters.registry import DEFAULT, FILTERS
    from gyrodrift.link.events import LinkEvents
    from gyrodrift.link.link import Link
    from gyrodrift.log import open_log, unwaiting_stderr
    from gyrodrift.recording.live_line import AboveLine
    from gyrodrift.service.filtering import Filtering
    from gyrodrift.service.live_line import ServiceLine
    from gyrodrift.service.loop import Service
    from gyrodrift.service.notify import SystemdNotify
    from gyrodrift.service.rest_word import RestWord
    from gyrodrift.service.signals import StopSignal
    from gyrodrift.service.stdout import STDOUT, JsonLines

    is_shown = _has_reader(arguments)
    above = (
        AboveLine(cast("TextIO", unwaiting_stderr(arguments.log_format))) if is_shown and sys.stderr.isatty() else None
    )
    log = open_log(options.log_level(arguments), arguments.log_format, above)
    events = LinkEvents(log)
    given = (watch.config.columns, watch.config.send) if watch else ()
    target, port = options.link_target(arguments, baud, events, *given)
    with StopSignal() as stop, ExitStack() as closing:
        link = Link(target, events, port=port)
        stdout = None if is_shown else JsonLines(STDOUT, rate_hz)
        filtering = Filtering(
            link, [stdout or ServiceLine(link, STDOUT)], log, watch, chosen=FILTERS[arguments.filter or DEFAULT.name]
        )
        recording = [] if arguments.record is None else [_recording(arguments, filtering, events, log)]
        listeners: list[SampleListener] = [*recording, filtering]
        if options.reads_columns_of_config(arguments):
            filtering.config_listeners.append(lambda new: link.follow_columns(new.columns))
        if not arguments.send:
            filtering.config_listeners.append(lambda new: link.send_at_opening(new.send))
        keeper = _remembered(arguments.memory, filtering, listeners)
        word, control = RestWord(), None
        if asked or watch is not None or arguments.control is not None:
            from gyrodrift.service.commands import ServiceCommands

            reporting = _reporting(arguments, asked, filtering, listeners, events)
            reporting.memory = keeper
            if arguments.control is not None:
                control = _control(arguments.control, ServiceCommands(filtering, stdout, reporting, stop, word), log)
                closing.callback(control.close)
            reporting.feed.want([*asked, *(watch.config.outputs if watch else ())])
        notify = SystemdNotify()
        closing.callback(notify.stopping)
        Service(link, listeners, log, events, stop, filtering.sinks, control, notify, word, is_watched=is_shown).run()
    return 0


def _has_reader(arguments: argparse.Namespace) -> bool:
    """Whether a person reads stdout, and not a program."""
    return sys.stdout.isatty() and not arguments.json and os.environ.get("TERM") != "dumb"


def _control(path: Path, commands: "ServiceCommands", log: "FilteringBoundLogger") -> "Control":
    """The socket of `--control`."""
    from gyrodrift.service.control import Control

    return Control(path, commands.all(), log)


def _reporting(
    arguments: argparse.Namespace,
    asked: "list[OutputSpec]",
    filtering: "Filtering",
    listeners: "list[SampleListener]",
    events: "LinkEvents",
) -> "Reporting":
    """What tells of the service, and the way to the outputs: both hear the samples and what happens."""
    from gyrodrift.service.link_meter import LinkMeter
    from gyrodrift.service.output_feed import OutputFeed
    from gyrodrift.service.reporting import Reporting

    meter = LinkMeter(filtering.link)
    feed = OutputFeed(filtering.log, options.log_level(arguments), arguments.log_format)
    reporting = Reporting(meter, filtering, feed)
    filtering.sinks.append(feed)
    filtering.event_listeners.append(feed.hear)
    filtering.config_listeners.append(lambda new: feed.want([*asked, *new.outputs]))
    feed.state = reporting.status
    events.listeners.append(feed.hear)
    listeners.insert(0, meter)
    return reporting


def _recording(
    arguments: argparse.Namespace, filtering: "Filtering", events: "LinkEvents", log: "FilteringBoundLogger"
) -> "SampleListener":
    """The recorder of `--record`, which hears what happens to link, filter and config too."""
    from gyrodrift.filters.beginning import table_of
    from gyrodrift.recording.recorder import RecordOptions
    from gyrodrift.recording.resilient import ResilientRecorder, repair_interrupted

    rotate_bytes, rotate_s = numbers.rotation(arguments.rotate)
    what = (arguments.record, arguments.profile, arguments.note, rotate_bytes, rotate_s, arguments.raw)
    config = None if filtering.watch is None else filtering.watch.config
    about, mode = ({}, 0o666) if config is None else (options.config_tables(arguments.config, config), config.mode)
    asked = RecordOptions(*what, about, lambda: table_of(filtering.filter, filtering.state), mode)
    recording = ResilientRecorder(asked, filtering.link, log)
    repair_interrupted(arguments.record, log)
    events.listeners.append(recording.on_event)
    filtering.event_listeners.append(recording.on_event)
    filtering.config_listeners.append(
        lambda new: recording.set_about(options.config_tables(arguments.config, new), new.mode)
    )
    return recording


def _remembered(path: Path | None, filtering: "Filtering", listeners: "list[SampleListener]") -> "MemoryKeeper | None":
    """What is remembered is there before the first sample, for the filter and for the recording."""
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
    """The state that this filter began with in a recording."""
    from gyrodrift.filters.beginning import beginning_of
    from gyrodrift.session.files import load_session

    state = beginning_of(kind, load_session(path).metadata, str(path))
    if state is None:
        raise UsageError(f"--memory {path}: does not say what a filter {kind.name} began with: it began anew")
    return state


def _outputs(asked: list[str]) -> "list[OutputSpec]":
    """Of `--output`; what checks them is loaded where there are any."""
    if not asked:
        return []
    from gyrodrift.config.outputs import output_of

    return [output_of(each) for each in asked]
