"""Calibrate a gyro: bias and noise at rest, then scale and sign from whole turns against a mark.

On a terminal it guides you: press Enter at every stop at the mark; u removes the last turn, q ends. Without a terminal,
or with --yes, it recognizes the stops by itself: let the device rest, then turn it counter-clockwise and clockwise in
turn. Each direction needs at least three turns, and more until the standard error of the scale is small enough.

The result goes to stdout, and into the block calibration: of --config, which serve, record and filter apply. The rest
of that file does not change.
"""

import argparse
import json
import sys
from contextlib import ExitStack
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from gyrodrift.cli import INTERRUPTED, configs, numbers, options
from gyrodrift.errors import CalibrationError, UsageError

if TYPE_CHECKING:
    from gyrodrift.calibrate.guide import CalibrationPlan, Guide
    from gyrodrift.calibration import Calibration
    from gyrodrift.link.link import Link

NEW_FILE = (
    "# Created by gyrodrift calibrate. serve --config applies changes of this file while it runs.\nfilter: restlevel\n"
)

EXAMPLES = """\
gyrodrift calibrate --port auto --config my.yaml
gyrodrift calibrate --port /dev/ttyUSB0 --config my.yaml --turns 5 --temperature 20 --force
gyrodrift calibrate --port /dev/ttyUSB0 --yes --json > calibration.json
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    options.add_link_options(parser)
    parser.add_argument(
        "--config", type=Path, metavar="FILE", help="config file to write the calibration into (default: none)"
    )
    parser.add_argument(
        "--turns", type=numbers.whole(1000), default=1, metavar="N", help="whole turns between two stops"
    )
    parser.add_argument(
        "--repeats", type=numbers.whole(1000), default=10, metavar="N", help="largest number of turns per direction"
    )
    parser.add_argument(
        "--spread",
        type=numbers.number(100.0),
        default=0.1,
        metavar="PERCENT",
        help="end when the standard error of the scale is below this",
    )
    parser.add_argument("--rest", type=numbers.seconds, default=10.0, metavar="S", help="length of the rest")
    parser.add_argument(
        "--temperature",
        type=numbers.number(1e5, "minutes, or 0 for none", least=0.0),
        default=0.0,
        metavar="MIN",
        help="measure the bias against temperature while the device warms up for MIN minutes (default: no)",
    )
    parser.add_argument(
        "--turn",
        action="store_true",
        help="find the columns of a text by a quarter turn to the left first, with unit and sign; a new config keeps "
        "them",
    )
    parser.add_argument("--yes", action="store_true", help="recognize stops without keys, also on a terminal")
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of the block")
    parser.add_argument("--force", action="store_true", help="replace the calibration in --config")
    options.add_log_options(parser)


def run(arguments: argparse.Namespace) -> int:
    """Calibrate; 0 if everything is written."""
    baud = numbers.baud(arguments.baud)
    plan = _plan(arguments)
    if arguments.config is not None:
        _check_config(arguments.config, force=arguments.force)

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
    target, port = configs.link_target(arguments, baud, events)
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
        calibration = _result(guide, link)
    _write(arguments, calibration, guide)
    return 0


def _new_file(arguments: argparse.Namespace) -> str:
    """Text of a new config, with the columns that --turn found."""
    return NEW_FILE + (f'columns: "{arguments.columns}"\n' if arguments.turn and arguments.columns else "")


def _plan(arguments: argparse.Namespace) -> "CalibrationPlan":
    from gyrodrift.calibrate.guide import CalibrationPlan
    from gyrodrift.calibrate.scale import REPEATS_MIN

    if arguments.repeats < REPEATS_MIN:
        raise UsageError(f"--repeats {arguments.repeats}: at least {REPEATS_MIN} are needed for a standard error")
    return CalibrationPlan(
        turns=arguments.turns,
        repeats_max=arguments.repeats,
        spread=arguments.spread / 100.0,
        rest_s=arguments.rest,
        warming_s=60.0 * arguments.temperature,
        is_by_hand=sys.stdin.isatty() and sys.stderr.isatty() and not arguments.yes,
    )


def _check_config(path: Path, *, force: bool) -> None:
    """Check before the calibration that its result can be written."""
    from gyrodrift.config.calibration import has_block
    from gyrodrift.config.model import load_config
    from gyrodrift.files import check_writable

    if path.suffix not in (".yaml", ".yml"):
        raise UsageError(f"--config {path}: the name of a config ends in .yaml")
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
        raise UsageError(f"{path}: has a calibration already; --force replaces it and keeps the rest")


def _result(guide: "Guide", link: "Link") -> "Calibration":
    from gyrodrift.calibration import device_identity

    device_id = device_identity(link.device.device_id, link.name)
    try:
        return guide.result(datetime.now(UTC), device_id, link.device.dps_per_lsb)
    except CalibrationError as error:
        raise CalibrationError(f"{link.name}: {error}; nothing is written") from error


def _write(arguments: argparse.Namespace, calibration: "Calibration", guide: "Guide") -> None:
    from gyrodrift.config.calibration import block_text, checked, with_block
    from gyrodrift.config.model import load_config
    from gyrodrift.files import write_whole

    block = block_text(calibration)
    if arguments.json:
        turns = [move._asdict() for move in guide.turns]
        print(json.dumps({"calibration": asdict(calibration), "turns": turns}, allow_nan=False, ensure_ascii=False))
    else:
        print(block, end="")
    sys.stdout.flush()
    if not calibration.device_id:
        print("gyrodrift: note: the device has no id, so the calibration applies to any device", file=sys.stderr)
    worst = max(calibration.scale_ccw_se or 0.0, calibration.scale_cw_se or 0.0)
    if worst > arguments.spread / 100.0:
        print(
            f"gyrodrift: note: the standard error of the scale is {worst:.2%}; more turns at a time reduce it",
            file=sys.stderr,
        )
    if arguments.config is not None:
        path = arguments.config
        text = path.read_text(encoding="utf-8-sig") if path.exists() else _new_file(arguments)
        write_whole(path, [checked(with_block(text, block), path, load_config)])
        print(f"gyrodrift: wrote the calibration into {path}", file=sys.stderr)
