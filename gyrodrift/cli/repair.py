"""Close session files (.mcap) that an interrupted recording left open, and repair damaged ones.

After that every MCAP reader opens them. `record` into a folder closes the files in it, too. Samples never change. An
incomplete record at the end is removed; more than one incomplete record is saved in a .tail file, with passwords
replaced by stars. From a damaged file everything that can be recovered is written to a new file. A line names the
samples and seconds that are lost, and the damaged file stays with the ending .damaged.
"""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

from gyrodrift.cli.written import samples_text, size_text
from gyrodrift.session.mcap.repair import Repaired, repair
from gyrodrift.values.errors import DataError, visible

EXAMPLES = """\
gyrodrift repair sessions
gyrodrift repair session.mcap
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("paths", type=Path, nargs="+", metavar="PATH", help="session file, or folder of session files")


def run(arguments: argparse.Namespace) -> int:
    """Repair; 0 if every file is whole at the end."""
    status = 0
    for path in _files(arguments.paths):
        try:
            repaired = repair(path)
        except DataError as error:  # the remaining files are still repaired
            print(f"gyrodrift: {error}", file=sys.stderr)
            status = DataError.exit_status
            continue
        if repaired is None:
            print(visible(f"{path}: is whole"))
        else:
            print(visible(f"{path}: {_repaired_words(repaired)}"))
    return status


def _repaired_words(repaired: Repaired) -> str:
    size = f"{samples_text(repaired.samples)}, {size_text(repaired.path.stat().st_size)}"
    if repaired.damage is not None:
        return f"repaired, {size}; {repaired.damage}; the damaged file is {repaired.kept}"
    saved = f", saved in {repaired.tail}" if repaired.tail else ""
    return f"closed, {size}; {repaired.cut_bytes} bytes of an incomplete record removed{saved}"


def _files(paths: list[Path]) -> Iterator[Path]:
    for path in paths:
        if path.is_dir():
            yield from sorted(inside for inside in path.glob("*.mcap") if inside.is_file())
        elif path.exists():
            yield path
        else:
            raise DataError(f"{path}: there is no such file or folder")
