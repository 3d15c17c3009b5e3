"""Write the filter as a library for a microcontroller: C, Arduino, PlatformIO, ESP-IDF, Zephyr, ESPHome, MicroPython.

The library has HDR, restlevel on one and on three axes, and the encoder of the native protocol. --config
adds the tuned parameters and the calibration of a gyro as my_gyro.h, for MicroPython as my_gyro.py.
"""

import argparse
import re
import shlex
from pathlib import Path

from gyrodrift.cli.configs import loaded_config
from gyrodrift.cli.written import size_text
from gyrodrift.firmware.library_folder import check_replaceable, write_library
from gyrodrift.firmware.my_gyro import TunedGyro
from gyrodrift.firmware.targets import TARGETS, files_of
from gyrodrift.io.files import check_writable
from gyrodrift.values.errors import UsageError, visible

EXAMPLES = """\
gyrodrift firmware --out gyrodrift-c
gyrodrift firmware --out ~/Arduino/libraries/gyrodrift --target arduino
gyrodrift firmware --out lib/gyrodrift --target platformio --config my.yaml
"""

FOLDER_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]*")
"""Names of libraries that the Arduino IDE loads (Arduino library specification, rev. 2.2)."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder of the library, made if needed")
    parser.add_argument("--target", choices=tuple(TARGETS), default=next(iter(TARGETS)), help="tool chain")
    parser.add_argument(
        "--config",
        type=Path,
        metavar="FILE",
        help="YAML with tuned parameters and calibration, for my_gyro.h (default: none)",
    )
    parser.add_argument(
        "--force", action="store_true", help="replace files that you changed or that are not from this command"
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the library; exit status 0."""
    out: Path = arguments.out.expanduser()
    if arguments.target == "arduino" and not FOLDER_NAME.fullmatch(out.resolve().name):
        raise UsageError(
            f"--out {out}: Arduino loads libraries from folders named with letters, digits, '_', '.' and '-'"
        )
    texts = files_of(TARGETS[arguments.target], _gyro(arguments.config))
    check_writable(out)
    check_replaceable(out, texts, force=arguments.force)
    write_library(out, texts)
    if not arguments.quiet:
        _report(arguments, out, texts)
    return 0


def _gyro(path: Path | None) -> TunedGyro | None:
    """Parameters and calibration of a config; None without one."""
    if path is None:
        return None

    return TunedGyro.of_config(loaded_config(path), path.name)


def _report(arguments: argparse.Namespace, out: Path, texts: dict[str, str]) -> None:
    """Say which files were written, and the next step."""
    target = TARGETS[arguments.target]
    size = size_text(sum(len(text.encode()) for text in texts.values()))
    print(visible(f"{out} written: {target.about}, {len(texts)} files, {size}"))
    for path in texts:
        print(f"  {path}")
    following = target.next_step.format(out=shlex.quote(str(out)), absolute=shlex.quote(str(out.resolve())))
    print(visible(f"next: {following}"))
