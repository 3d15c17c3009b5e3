"""Record a gyro on a serial port into session files until SIGINT or SIGTERM.

The file name has the date (UTC), the device and --profile. A kill loses at most the last second, a power cut at most
the last five seconds. Files that an earlier recording in the folder left open are closed first. Paths of the files go
to stdout, the log to stderr. On a terminal a line shows the progress and the corrected yaw; the file has the samples as
measured.
"""

import argparse
import os
import sys
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, TextIO, cast

from gyrodrift.cli import configs, numbers, options
from gyrodrift.io.waiting import send_within

if TYPE_CHECKING:
    from gyrodrift.link.link import Link
    from gyrodrift.recording.live_line import LiveYaw
    from gyrodrift.recording.recorder import Recorder
    from gyrodrift.service.listener import SampleListener
    from gyrodrift.service.signals import StopSignal

READ_INTERVAL_S = 0.002
"""Pause between two reads of a fast stream, s: nobody waits for the samples, and fewer reads cost less."""

LAST_S = 1.0
"""Longest wait for a reader of the paths, s."""

EXAMPLES = """\
gyrodrift record --port /dev/ttyUSB0 --out sessions --note "new bearing"
gyrodrift record --port /dev/ttyUSB0 --out sessions --duration 600 --profile identify
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    options.add_link_options(parser)
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for the sessions")
    stop = "stop after TIME of the device clock, such as 90 (s), 30min or 1h (default: at Ctrl-C)"
    options.add_duration_option(parser, None, stop)
    options.add_filter_options(
        parser,
        "YAML with a filter and its parameters, for the yaw on the terminal; the file keeps its calibration",
    )
    options.add_recording_options(parser)
    options.add_log_options(parser)


def run(arguments: argparse.Namespace) -> int:
    """Record until a signal comes or the time is over; exit status 0."""
    rotate_bytes, rotate_s = numbers.rotation(arguments.rotate)
    baud = numbers.baud(arguments.baud)

    from gyrodrift.filters.run import FilterRun
    from gyrodrift.io.files import check_writable
    from gyrodrift.io.log import open_log, unwaiting_stderr
    from gyrodrift.link.events import LinkEvents
    from gyrodrift.link.link import Link
    from gyrodrift.recording.live_line import LiveYaw
    from gyrodrift.recording.recorder import Recorder, RecordOptions
    from gyrodrift.recording.resilient import repair_interrupted
    from gyrodrift.service.loop import Service
    from gyrodrift.service.signals import StopSignal

    config = configs.chosen_config(arguments)
    yaw = LiveYaw(
        FilterRun(config.chosen, config.params, arguments.axes or config.axes, config.mount), config.calibration
    )
    stderr = cast("TextIO", unwaiting_stderr(arguments.log_format))
    is_shown = sys.stderr.isatty() and not arguments.quiet
    log = open_log(options.log_level(arguments), arguments.log_format)
    events = LinkEvents(log)
    target, port = configs.link_target(arguments, baud, events, send=config.send)
    with StopSignal() as stop:
        with stop.at_once():
            link = Link(replace(target, keeps_on=True), events, port=port)
        fields = (arguments.out, arguments.profile, arguments.note, rotate_bytes, rotate_s, arguments.raw)
        about = configs.config_tables(arguments.config, config) if arguments.config else {}
        check_writable(arguments.out)
        recorder = Recorder(RecordOptions(*fields, about, mode=config.mode), link)
        repair_interrupted(arguments.out, log)
        events.listeners.append(recorder.on_event)
        try:
            listeners = _listeners(link, recorder, stop, arguments.duration, yaw, stderr if is_shown else None)
            service = Service(link, listeners, log, events, stop, read_interval_s=READ_INTERVAL_S)
            service.end_event, service.is_watched = "record_end", is_shown
            service.run()
        finally:
            _print_paths(filter(Path.exists, recorder.paths))  # a full disk may have no file
    return 0


def _print_paths(paths: Iterable[Path]) -> None:
    """Print the paths; a closed stdout does not change the exit status."""
    with suppress(OSError):
        send_within(sys.stdout.fileno(), b"".join(os.fsencode(path) + b"\n" for path in paths), LAST_S)


def _listeners(
    link: "Link",
    recorder: "Recorder",
    stop: "StopSignal",
    duration_s: float | None,
    yaw: "LiveYaw",
    terminal: TextIO | None,
) -> "list[SampleListener]":
    from gyrodrift.recording.duration import Duration
    from gyrodrift.recording.live_line import LiveLine

    listeners: list[SampleListener] = [recorder if duration_s is None else Duration(recorder, duration_s, stop)]
    if terminal is not None:
        listeners.append(LiveLine(link, recorder, yaw, terminal))
    return listeners
