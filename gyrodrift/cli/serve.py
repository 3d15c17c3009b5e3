"""Read a gyro on a serial port, correct its drift, and emit yaw as JSON lines on stdout until SIGINT or SIGTERM.

Each line has seq, t_s (device clock, s), rate_dps (as measured), corrected_dps, yaw_deg, bias_dps, with the filter
restlevel yaw_sigma_deg and confidence, and encoder_deg and temp_c where the device sends them. The log goes to stderr.
"""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from gyrodrift.cli import options

if TYPE_CHECKING:
    from gyrodrift.config.watch import ConfigWatch


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    options.add_link_options(parser)
    options.add_filter_options(parser, "YAML with a filter and its parameters; followed while serve runs")
    parser.add_argument("--rate", type=float, metavar="HZ", help="at most HZ lines a second of device time")
    parser.add_argument("--record", type=Path, metavar="DIR", help="write what the device sends into this folder too")
    options.add_recording_options(parser)
    options.add_log_options(parser)


def run(arguments: argparse.Namespace) -> int:
    """Run until a signal comes; 0 then."""
    rate_hz = options.positive("--rate", arguments.rate)
    rotate_bytes, rotate_s = options.rotation(arguments.rotate)
    baud = options.baud(arguments.baud)
    watch = None
    if arguments.config is not None:
        from gyrodrift.config.watch import ConfigWatch

        watch = ConfigWatch(arguments.config)

    from gyrodrift.filters.registry import DEFAULT, FILTERS
    from gyrodrift.link.events import LinkEvents
    from gyrodrift.link.link import Link, LinkOptions
    from gyrodrift.log import open_log
    from gyrodrift.service.filtering import Filtering
    from gyrodrift.service.listener import SampleListener
    from gyrodrift.service.loop import Service
    from gyrodrift.service.outputs.registry import open_output
    from gyrodrift.service.signals import StopSignal

    log = open_log(arguments.log_level, arguments.log_format)
    events = LinkEvents(log)
    with StopSignal() as stop:
        link = Link(LinkOptions(arguments.port, baud, arguments.protocol, arguments.timeout), events)
        outputs = [open_output("stdout", {"rate_hz": rate_hz})]
        filtering = Filtering(link, outputs, log, watch, FILTERS[arguments.filter or DEFAULT.name])
        listeners: list[SampleListener] = [filtering]
        if arguments.record is not None:
            from gyrodrift.recording.recorder import RecordOptions
            from gyrodrift.recording.resilient import ResilientRecorder, repair_interrupted

            what = (arguments.record, arguments.profile, arguments.note, rotate_bytes, rotate_s, arguments.raw)
            recording = ResilientRecorder(RecordOptions(*what, _about(watch)), link, log)
            repair_interrupted(arguments.record, log)
            events.listener = recording.on_event
            listeners = [recording, filtering]
        Service(link, listeners, log, events, stop, outputs).run()
    return 0


def _about(watch: "ConfigWatch | None") -> dict[str, dict[str, str]]:
    """What a recording keeps of the config."""
    return {} if watch is None else {"config": {"file": str(watch.path), "text": watch.path.read_text()}}
