"""Calibrate a gyro: bias and noise at rest, then scale and sign from whole turns against a mark.

On a terminal it guides you: press Enter at every stop at the mark; u removes the last turn, q ends. Without a terminal,
or with --yes, it recognizes the stops by itself: let the device rest, then turn it counter-clockwise and clockwise in
turn. Each direction needs at least three turns, and more until the standard error of the scale is small enough.

--positions calibrates a device with three axes instead: lay it down on each of its six sides, in any order, for offset
and scale of the accelerometer and the biases of the gyro. With --axis-turns also turn it with each axis upright, for
scale and misalignment of the gyro. Rests and turns are recognized without keys.

The result goes to stdout, and into the block calibration: of --config, which serve, record and filter apply. The rest
of that file does not change.
"""

import argparse
import json
import sys
from collections.abc import Callable
from contextlib import ExitStack
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from gyrodrift.calibrate.guide import CalibrationPlan, Guide
from gyrodrift.calibrate.scale import REPEATS_MIN
from gyrodrift.cli import INTERRUPTED, configs, numbers, options
from gyrodrift.config.calibration import block_text, checked, has_block, with_block
from gyrodrift.config.model import load_config
from gyrodrift.io.files import check_writable, write_whole
from gyrodrift.io.log import open_log
from gyrodrift.link.events import LinkEvents
from gyrodrift.link.link import Link
from gyrodrift.values.calibration import Calibration, device_identity
from gyrodrift.values.errors import CalibrationError, UsageError

if TYPE_CHECKING:
    from gyrodrift.calibrate.positions.guide import PositionGuide, PositionPlan

    AnyGuide = Guide | PositionGuide

NEW_FILE = (
    "# Created by gyrodrift calibrate. serve --config applies changes of this file while it runs.\nfilter: restlevel\n"
)


def check_config(path: Path, *, force: bool) -> Calibration | None:
    """Check before the calibration that its result can be written; the calibration that it replaces."""
    if path.suffix not in (".yaml", ".yml"):
        raise UsageError(f"--config {path}: the name of a config ends in .yaml")
    if not path.parent.is_dir():
        raise UsageError(f"--config {path}: there is no folder {path.parent}")
    check_writable(path.parent)
    if not path.exists():
        return None
    old = load_config(path).calibration
    try:
        has_one = has_block(path.read_text(encoding="utf-8-sig"))
    except UsageError as error:
        raise UsageError(f"{path}: {error}") from error
    if has_one and not force:
        raise UsageError(f"{path}: has a calibration already; --force replaces it and keeps the rest")
    return old


def write_result(arguments: argparse.Namespace, calibration: Calibration, guide: "AnyGuide") -> None:
    """Print the calibration, and write it into the config."""
    block = block_text(calibration)
    if arguments.json:
        content = {"calibration": calibration.values(), **guide.measured()}
        print(json.dumps(content, allow_nan=False, ensure_ascii=False))
    else:
        print(block, end="")
    sys.stdout.flush()
    if not calibration.device_id:
        print("gyrodrift: note: the device has no id, so the calibration applies to any device", file=sys.stderr)
    worst = max(calibration.scale_ccw_se or 0.0, calibration.scale_cw_se or 0.0)
    if not arguments.positions and worst > arguments.spread / 100.0:
        print(
            f"gyrodrift: note: the standard error of the scale is {worst:.2%}; more turns at a time reduce it",
            file=sys.stderr,
        )
    if arguments.config is not None:
        path = arguments.config
        text = path.read_text(encoding="utf-8-sig") if path.exists() else _new_file(arguments)
        write_whole(path, [checked(with_block(text, block), path, load_config)])
        print(f"gyrodrift: {path} written: the calibration", file=sys.stderr)


def _new_file(arguments: argparse.Namespace) -> str:
    """Text of a new config, with the columns that --turn found."""
    return NEW_FILE + (f'columns: "{arguments.columns}"\n' if arguments.turn and arguments.columns else "")


REST_S, SIDE_REST_S = 10.0, 2.0
REPEATS, SPREAD_PERCENT = 10, 0.1

EXAMPLES = """\
gyrodrift calibrate --port auto --config my.yaml
gyrodrift calibrate --port /dev/ttyUSB0 --config my.yaml --turns 5 --temperature 20 --force
gyrodrift calibrate --port auto --config my.yaml --positions --axis-turns
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
        "--repeats",
        type=numbers.whole(1000),
        default=REPEATS,
        metavar="N",
        help="largest number of turns per direction",
    )
    parser.add_argument(
        "--spread",
        type=numbers.number(100.0),
        default=SPREAD_PERCENT,
        metavar="PERCENT",
        help="end when the standard error of the scale is below this",
    )
    parser.add_argument(
        "--rest",
        type=numbers.duration,
        metavar="TIME",
        help=f"length of a rest, such as 10 (s) (default 10; {SIDE_REST_S:g} on a side)",
    )
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
    parser.add_argument(
        "--positions",
        action="store_true",
        help="three axes: measure the accelerometer and the biases of the gyro on six sides",
    )
    parser.add_argument(
        "--axis-turns",
        action="store_true",
        help="with --positions: also turn it with each axis upright, for scale and misalignment of the gyro",
    )
    parser.add_argument("--yes", action="store_true", help="recognize stops without keys, also on a terminal")
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of the block")
    parser.add_argument("--force", action="store_true", help="replace the calibration in --config")
    options.add_log_options(parser)


def run(arguments: argparse.Namespace) -> int:
    """Calibrate; 0 if everything is written."""
    baud = numbers.baud(arguments.baud)
    guide_of = _guide_of(arguments)
    old = None if arguments.config is None else check_config(arguments.config, force=arguments.force)
    if arguments.turn:
        from gyrodrift.cli.turning import columns_by_turn

        arguments.columns = columns_by_turn(arguments)
    from gyrodrift.calibrate.terminal import GuideScreen, Keys, guided, without_echo
    from gyrodrift.service.signals import StopSignal

    screen = GuideScreen(sys.stderr, sys.stderr.isatty() and not arguments.quiet)
    events = LinkEvents(open_log(arguments.log_level or "warning", arguments.log_format))
    target, port = configs.link_target(arguments, baud, events)
    is_by_hand = _is_by_hand(arguments)
    guide = guide_of((lambda _: None) if arguments.quiet and not is_by_hand else screen.say)
    with StopSignal() as stop, ExitStack() as closing:
        link = Link(target, events, port=port)
        closing.callback(link.close)
        closing.callback(screen.clear)
        keys = None
        if is_by_hand:
            keys = Keys(sys.stdin.fileno())
            closing.enter_context(without_echo(keys.fd))
        if not guided(link, guide, screen, keys, stop.fd):
            screen.say("gyrodrift: interrupted; nothing is written")
            return INTERRUPTED
        measured = _result(guide, link)
    write_result(arguments, guide.merged(measured, old), guide)
    return 0


def _is_by_hand(arguments: argparse.Namespace) -> bool:
    return sys.stdin.isatty() and sys.stderr.isatty() and not arguments.yes


def _guide_of(arguments: argparse.Namespace) -> "Callable[[Callable[[str], object]], AnyGuide]":
    """Guide for the requested calibration, from what it says with."""
    if arguments.positions:
        from gyrodrift.calibrate.positions.guide import PositionGuide

        return partial(PositionGuide, _position_plan(arguments))
    if arguments.axis_turns:
        raise UsageError("--axis-turns: needs --positions, which measures the direction of gravity")
    return partial(Guide, _plan(arguments))


def _position_plan(arguments: argparse.Namespace) -> "PositionPlan":
    from gyrodrift.calibrate.positions.guide import PositionPlan

    given = {
        "--temperature": arguments.temperature > 0.0,
        "--repeats": arguments.repeats != REPEATS,
        "--spread": arguments.spread != SPREAD_PERCENT,
        "--turns": arguments.turns > 1 and not arguments.axis_turns,
    }
    unused = [name for name, is_given in given.items() if is_given]
    if unused:
        raise UsageError(f"--positions and {unused[0]}: use one of them; six positions have no {unused[0][2:]}")
    return PositionPlan(
        has_turns=arguments.axis_turns,
        turns=arguments.turns,
        rest_s=arguments.rest or SIDE_REST_S,
        is_by_hand=_is_by_hand(arguments),
    )


def _plan(arguments: argparse.Namespace) -> CalibrationPlan:
    if arguments.repeats < REPEATS_MIN:
        raise UsageError(f"--repeats {arguments.repeats}: at least {REPEATS_MIN} are needed for a standard error")
    return CalibrationPlan(
        turns=arguments.turns,
        repeats_max=arguments.repeats,
        spread=arguments.spread / 100.0,
        rest_s=arguments.rest or REST_S,
        warming_s=60.0 * arguments.temperature,
        is_by_hand=_is_by_hand(arguments),
    )


def _result(guide: "AnyGuide", link: Link) -> Calibration:
    device_id = device_identity(link.device.device_id, link.name)
    try:
        return guide.result(datetime.now(UTC), device_id, link.device.dps_per_lsb)
    except CalibrationError as error:
        raise CalibrationError(f"{link.name}: {error}; nothing is written") from error
