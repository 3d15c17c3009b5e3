"""What a tuning has asked so far, kept in a file, so that an interrupted one can go on where it was."""

import time
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np
from numpy.typing import NDArray

from gyrodrift.arrays import Floats
from gyrodrift.errors import DataError
from gyrodrift.files import whole_file
from gyrodrift.tune.search.objective import Objective

SAVE_S = 5.0

LARGEST_BYTES = 1 << 28
"""Millions of evaluations of a dozen searches."""


class Journal:
    """Points and costs of each search by its name, saved every few seconds.

    Parameters
    ----------
    path
        The file.
    identity
        What the searches depend on: sessions, split, method, ranges. A file of another identity is refused.
    is_resumed
        Whether to go on with what the file holds, if it is there.
    """

    def __init__(self, path: Path, identity: str, *, is_resumed: bool) -> None:
        self.path = path
        self._identity = identity
        self._searches: dict[str, tuple[Floats, Floats]] = {}
        self._saved_s = time.monotonic()
        if is_resumed and path.exists():
            self._load()

    def known(self, name: str) -> tuple[Floats, Floats] | None:
        """What is known of a search."""
        return self._searches.get(name)

    def note(self, name: str, objective: Objective) -> None:
        """Remember how far a search has come."""
        self._searches[name] = (objective.cube, objective.costs)
        if time.monotonic() - self._saved_s >= SAVE_S:
            self.save()

    def save(self) -> None:
        """Write all of it."""
        arrays = {"identity": np.array(self._identity)}
        for name, (cube, costs) in self._searches.items():
            arrays |= {f"{name}/cube": cube, f"{name}/costs": costs}
        with whole_file(self.path) as file:
            np.savez(file, **arrays)  # type: ignore[arg-type]  # the stubs take the names for options
        self._saved_s = time.monotonic()

    def discard(self) -> None:
        """It is done."""
        self.path.unlink(missing_ok=True)

    def _load(self) -> None:
        try:
            arrays = _arrays(self.path)
        except Exception as error:  # numpy, zip and zlib name their troubles in many ways
            why = str(error) or type(error).__name__
            raise DataError(f"{self.path}: cannot be resumed from: {why}; remove it to begin anew") from error
        if str(arrays.pop("identity", "")) != self._identity:
            raise DataError(
                f"{self.path}: belongs to other sessions, ranges or another method; "
                "remove it or leave --resume away to begin anew"
            )
        for name in {key.rpartition("/")[0] for key in arrays}:
            cube, costs = (arrays.get(f"{name}/{part}", np.empty(0)) for part in ("cube", "costs"))
            if cube.ndim != 2 or costs.shape != cube.shape[:1] or {cube.dtype, costs.dtype} != {np.dtype(np.float64)}:
                raise DataError(f"{self.path}: cannot be resumed from: it was damaged; remove it to begin anew")
            self._searches[name] = (cube, costs)


def _arrays(path: Path) -> dict[str, NDArray[Any]]:
    """All that stands in a file; what claims to be larger than any search is not opened."""
    with path.open("rb") as file, ZipFile(file) as parts:
        claimed = sum(part.file_size for part in parts.infolist())
        if claimed > LARGEST_BYTES:
            raise DataError(f"it claims to hold {claimed} bytes")
        file.seek(0)
        with np.load(file) as stored:
            arrays = {name: stored[name] for name in stored.files}
    if not all(isinstance(each, np.ndarray) for each in arrays.values()):  # numpy gives bytes for what is no array
        raise DataError("it holds something other than arrays")
    return arrays
