"""Result of `calibrate`: on stdout, and in the block `calibration:` of a config."""

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from gyrodrift.values.errors import UsageError

if TYPE_CHECKING:
    from gyrodrift.calibrate.guide import Guide
    from gyrodrift.calibrate.positions.guide import PositionGuide
    from gyrodrift.values.calibration import Calibration

NEW_FILE = (
    "# Created by gyrodrift calibrate. serve --config applies changes of this file while it runs.\nfilter: restlevel\n"
)


def check_config(path: Path, *, force: bool) -> "Calibration | None":
    """Check before the calibration that its result can be written; the calibration that it replaces."""
    from gyrodrift.config.calibration import has_block
    from gyrodrift.config.model import load_config
    from gyrodrift.io.files import check_writable

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


def write_result(arguments: argparse.Namespace, calibration: "Calibration", guide: "Guide | PositionGuide") -> None:
    """Print the calibration, and write it into the config."""
    from gyrodrift.config.calibration import block_text, checked, with_block
    from gyrodrift.config.model import load_config
    from gyrodrift.io.files import write_whole

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
        print(f"gyrodrift: wrote the calibration into {path}", file=sys.stderr)


def _new_file(arguments: argparse.Namespace) -> str:
    """Text of a new config, with the columns that --turn found."""
    return NEW_FILE + (f'columns: "{arguments.columns}"\n' if arguments.turn and arguments.columns else "")
