"""Calibrate a gyro: bias and noise at rest, then whole turns against a mark, counter-clockwise and clockwise.

On a terminal it is guided: each stop at the mark is told by Enter; u takes the last turn back, q ends with what is
there. Without one, or with --yes, no key is waited for: the device rests first and is then turned to and fro, and each
stop is told by its standing still. Each direction is turned at least three times, until the standard error of the scale
is small enough.

The block calibration: goes to stdout, and into --config, where serve, record and filter take it from; all else in that
file stays as it is.
"""

import argparse
import json
import sys
from contextlib import ExitStack
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from gyrodrift.cli import INTERRUPTED, numbers, options
from gyrodrift.errors import CalibrationError, UsageError

if TYPE_CHECKING:
    from gyrodrift.calibrate.guide import CalibrationPlan, Guide
    from gyrodrift.calibration import Calibration
    from gyrodrift.link.link import Link

NEW_FILE = "# Begun by gyrodrift calibrate. serve --config follows this file while it runs.\nfilter: restlevel\n"

EXAMPLES = """\
gyrodrift calibrate --port auto --config my.yaml
gyrodrift calibrate --port /dev/ttyUSB0 --config my.yaml --turns 5 --temperature 20 --force
gyrodrift calibrate --port /dev/ttyUSB0 --yes --json > calibration.json
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    options.add_link_options(parser)
    parser.add_argument(
        "--config", type=Path, metavar="FILE", help="config that the calibration is put into (default: none)"
    )
    parser.add_argument("--turns", type=numbers.whole(1000), default=1, metavar="N", help="whole turns at a time")
    parser.add_argument(
        "--repeats", type=numbers.whole(1000), default=10, metavar="N", help="turn each direction N times at most"
    )
    parser.add_argument(
        "--spread",
        type=numbers.number(100.0),
        default=0.1,
        metavar="PERCENT",
        help="standard error of the scale that is small enough",
    )
    parser.add_argument(
        "--rest", type=numbers.seconds, default=10.0, metavar="S", help="length of the rest, s of device time"
    )
    parser.add_argument(
        "--temperature",
        type=numbers.number(1e5, "minutes, or 0 for none", least=0.0),
        default=0.0,
        metavar="MIN",
        help="let it warm for MIN minutes at rest, for the slope of the bias (default: none)",
    )
    parser.add_argument(
        "--turn",
        action="store_true",
        help="ask for a quarter turn to the left first, which tells the columns of a text, their unit and sign; a "
        "config that is begun keeps them",
    )
    parser.add_argument("--yes", action="store_true", help="wait for no key, also on a terminal")
    parser.add_argument("--json", action="store_true", help="one JSON object on stdout instead of the block")
    parser.add_argument("--force", action="store_true", help="replace a calibration that --config has already")
    options.add_log_options(parser)


def run(arguments: argparse.Namespace) -> int:
    """Calibrate; 0 when everything is written."""
    baud = numbers.baud(arguments.baud)
    plan = _plan(arguments)
    if arguments.config is not None:
        _check_place(arguments.config, force=arguments.force)

    if arguments.turn:
        from gyrodrift.cli.turning import columns_by_turn

        arguments.columns = columns_by_turn(arguments)

    from gyrodrift.calibrate.guide import Guide
    from gyrodrift.calibrate.terminal import GuideScreen, Keys, guided, without_echo
    from gyrodrift.link.events import LinkEvents
    from gyrodrift.link.link import Link
    from gyrodrift.log import open_log
    from gyrodrift.recording.live_line import AboveLine
    from gyrodrift.service.signals import StopSignal

    screen = GuideScreen(sys.stderr, sys.stderr.isatty() and not arguments.quiet)
    log_to = AboveLine(sys.stderr) if screen.is_terminal else None
    events = LinkEvents(open_log(arguments.log_level or "warning", arguments.log_format, log_to))
    target, port = options.link_target(arguments, baud, events)
    guide = Guide(plan, (lambda _: None) if arguments.quiet and not plan.is_by_hand else screen.say)
    with StopSignal() as stop, ExitStack() as closing:
        link = Link(target, events, port=port)
        closing.callback(link.close)
        closing.callback(screen.clear)
        keys = None
        if plan.is_by_hand:
            keys = Keys(sys.stdin.fileno())
            closing.enter_context(without_echo(keys.fd))
        if not guided(link, guide, screen, keys, stop.fd):
            screen.say("gyrodrift: interrupted; nothing is written")
            return INTERRUPTED
        found = _result(guide, link)
    _write(arguments, found, guide)
    return 0


def _new_file(arguments: argparse.Namespace) -> str:
    """A config that is begun, with the columns that a turn has told: they are asked for once."""
    return NEW_FILE + (f'columns: "{arguments.columns}"\n' if arguments.turn and arguments.columns else "")


def _plan(arguments: argparse.Namespace) -> "CalibrationPlan":
    from gyrodrift.calibrate.guide import CalibrationPlan
    from gyrodrift.calibrate.scale import LEAST

    if arguments.repeats < LEAST:
        raise UsageError(f"--repeats {arguments.repeats}: fewer than {LEAST} tell nothing of how exact they are")
    return CalibrationPlan(
        turns=arguments.turns,
        most=arguments.repeats,
        spread=arguments.spread / 100.0,
        rest_s=arguments.rest,
        warming_s=60.0 * arguments.temperature,
        is_by_hand=sys.stdin.isatty() and sys.stderr.isatty() and not arguments.yes,
    )


def _check_place(path: Path, *, force: bool) -> None:
    """Before the work, not after."""
    from gyrodrift.config.calibration import has_block
    from gyrodrift.config.model import load_config
    from gyrodrift.files import check_writable

    if path.suffix not in (".yaml", ".yml"):
        raise UsageError(f"--config {path}: a config ends in .yaml")
    if not path.parent.is_dir():
        raise UsageError(f"--config {path}: there is no folder {path.parent}")
    check_writable(path.parent)
    if not path.exists():
        return
    load_config(path)
    try:
        has_one = has_block(path.read_text(encoding="utf-8-sig"))
    except UsageError as error:
        raise UsageError(f"{path}: {error}") from error
    if has_one and not force:
        raise UsageError(f"{path}: has a calibration already; --force replaces it and leaves the rest as it is")


def _result(guide: "Guide", link: "Link") -> "Calibration":
    from gyrodrift.calibration import device_identity

    device_id = device_identity(link.device.device_id, link.name)
    try:
        return guide.result(datetime.now(UTC), device_id, link.device.dps_per_lsb)
    except CalibrationError as error:
        raise CalibrationError(f"{link.name}: {error}; nothing is written") from error


def _write(arguments: argparse.Namespace, found: "Calibration", guide: "Guide") -> None:
    from gyrodrift.config.calibration import block_text, checked, with_block
    from gyrodrift.config.model import load_config
    from gyrodrift.files import write_whole

    block = block_text(found)
    if arguments.json:
        turns = [one._asdict() for one in guide.turns]
        print(json.dumps({"calibration": asdict(found), "turns": turns}, allow_nan=False, ensure_ascii=False))
    else:
        print(block, end="")
    sys.stdout.flush()
    if not found.device_id:
        print("gyrodrift: note: the device has no id, so the calibration fits any device", file=sys.stderr)
    worst = max(found.scale_ccw_se or 0.0, found.scale_cw_se or 0.0)
    if worst > arguments.spread / 100.0:
        print(f"gyrodrift: note: the scale is known to {worst:.2%}; more turns at a time help", file=sys.stderr)
    if arguments.config is not None:
        path = arguments.config
        text = path.read_text(encoding="utf-8-sig") if path.exists() else _new_file(arguments)
        write_whole(path, [checked(with_block(text, block), path, load_config)])
        print(f"gyrodrift: {path}: has this calibration now", file=sys.stderr)
