"""Close session files (.mcap) whose recording was cut off, so that every program can open them, and mend damaged ones.

Recording into a folder closes the files in it, too. Samples are never touched; bytes at the end that are no whole
record are cut off, and kept in a file ending in .tail where they are more than one torn record; text that mentions a
password is covered with stars there. Of a damaged file a whole one is written of all that can be recovered, and the
samples and seconds that cannot are told; the damaged one is kept beside it with the ending .damaged.
"""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

from gyrodrift.errors import DataError, visible

EXAMPLES = """\
gyrodrift repair sessions
gyrodrift repair session.mcap
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("paths", type=Path, nargs="+", metavar="PATH", help="session file, or folder of them")


def run(arguments: argparse.Namespace) -> int:
    """Repair; 0 when every file is closed."""
    from gyrodrift.session.mcap.repair import repair

    status = 0
    for path in _files(arguments.paths):
        try:
            repaired = repair(path)
        except DataError as error:  # the others are repaired all the same
            print(f"gyrodrift: {error}", file=sys.stderr)
            status = DataError.exit_status
            continue
        if repaired is None:
            print(visible(f"{path}: is whole"))
        elif repaired.damage is not None:
            print(visible(f"{path}: mended; {repaired.damage}; as it was it is kept in {repaired.kept}"))
        else:
            saved = f", kept in {repaired.tail}" if repaired.tail else ""
            cut = f"{repaired.cut_bytes} torn bytes cut off{saved}"
            print(visible(f"{path}: closed, {repaired.samples} samples; {cut}"))
    return status


def _files(paths: list[Path]) -> Iterator[Path]:
    for path in paths:
        if path.is_dir():
            yield from sorted(inside for inside in path.glob("*.mcap") if inside.is_file())
        elif path.exists():
            yield path
        else:
            raise DataError(f"{path}: there is no such file or folder")
