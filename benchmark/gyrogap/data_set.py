"""A data set of the benchmark: made from a seed, and listed.

- `manifest.json`: names of the cases, with their axes and the digest of their files.
- `effects.json`: the words of an answer.
- `hashes.json`: salted hash of each label.
- `cases/CASE/`: `simulator.yaml` and `sessions/session-1.csv` to `session-3.csv`.
- `seals/CASE.json`: label and salt; or in another folder.
- `openings.log`: a line for each seal that was opened.
"""

import re
import shutil
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

import numpy as np
import scipy

from gyrodrift.values.errors import DataError, UsageError, shortened
from gyrogap.case import NAME, BenchmarkCase
from gyrogap.json_files import object_of, read_json, write_json
from gyrogap.rows import ROWS, draw_case
from gyrogap.seals import HASHES, seal_label
from gyrogap.vocabulary import table

VERSION = 1
"""Version of the benchmark; another one has other data for the same seed."""

MANIFEST, EFFECTS_FILE, CASES, SEALS = "manifest.json", "effects.json", "cases", "seals"

CASE_NAME = re.compile(r"[0-9A-Za-z_-]{1,64}")

OnCase = Callable[[int, int], None]
"""Called with the number of cases that are done, and their total."""


@dataclass(frozen=True, slots=True)
class ListedCase:
    """A case in the manifest."""

    case: str
    axes: int
    sha256: str


def chosen_cases(seed: int, rows: Sequence[str], count: int | None) -> Iterator[BenchmarkCase]:
    """Cases of some rows, all rows if none is named; the first `count` of each, or as many as each has."""
    for row in rows or ROWS:
        yield from (draw_case(seed, row, number) for number in range(ROWS[row].count if count is None else count))


def make_data_set(folder: Path, seals: Path, cases: Sequence[BenchmarkCase], on_case: OnCase) -> None:
    """Write a data set; the manifest comes last, so that an interrupted set is made again.

    Raises
    ------
    UsageError
        The folder holds a data set.
    """
    if (folder / MANIFEST).exists():
        raise UsageError(f"{folder}: holds a data set; give another folder")
    by_name = sorted(cases, key=lambda case: case.name)
    hashes, listed = {}, []
    for number, case in enumerate(by_name):
        on_case(number, len(by_name))
        hashes[case.name] = seal_label(seals, case.salt, case.label())
        listed.append({"case": case.name, "axes": case.axes, "sha256": _write_case(case, folder / CASES / case.name)})
    write_json(folder / EFFECTS_FILE, table())
    write_json(folder / HASHES, hashes)
    made_with = {"numpy": np.__version__, "scipy": scipy.__version__}
    write_json(folder / MANIFEST, {"benchmark": NAME, "version": VERSION, "made_with": made_with, "cases": listed})
    on_case(len(by_name), len(by_name))


def read_manifest(folder: Path) -> list[ListedCase]:
    """Cases of a data set.

    Raises
    ------
    DataError
        There is none, or it is of another version.
    """
    path = folder / MANIFEST
    manifest = read_json(path)
    if not isinstance(manifest, dict) or manifest.get("benchmark") != NAME:
        raise DataError(
            f"{folder / MANIFEST}: is no manifest of {NAME}; make a set: gyrodrift gyrogap make DIR --seed N"
        )
    object_of(manifest, {"version": int}, path, "the manifest")
    if manifest["version"] != VERSION:
        raise DataError(f"{path}: has version {manifest['version']}; this program reads version {VERSION}")
    object_of(manifest, {"cases": list}, path, "the manifest")
    listed = [object_of(case, {"case": str, "axes": int, "sha256": str}, path, "a case") for case in manifest["cases"]]
    for case in listed:
        if not CASE_NAME.fullmatch(case["case"]):  # it is a part of a path and of a line in the log of openings
            raise DataError(f"{path}: {shortened(case['case'], 40)!r} is no name of a case: letters and digits are")
    return [ListedCase(case["case"], case["axes"], case["sha256"]) for case in listed]


def digest_of_files(folder: Path) -> str:
    """SHA-256 of names and bytes of all files below a folder."""
    digest = sha256()
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        digest.update(str(path.relative_to(folder).as_posix()).encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def _write_case(case: BenchmarkCase, folder: Path) -> str:
    shutil.rmtree(folder, ignore_errors=True)
    case.write(folder)
    return digest_of_files(folder)
