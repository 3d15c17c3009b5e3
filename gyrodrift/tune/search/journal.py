"""Evaluations of a tuning in a file, from which an interrupted tuning resumes."""

import time
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np
from numpy.typing import NDArray

from gyrodrift.io.files import check_ordinary, whole_file
from gyrodrift.tune.search.objective import Objective
from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import DataError

SAVE_S = 5.0

LARGEST_BYTES = 1 << 28
"""Largest journal, bytes: millions of evaluations of a dozen searches."""


class Journal:
    """Points and costs of each search by its name, saved every few seconds.

    Parameters
    ----------
    path
        The file.
    identity
        Digest of sessions, split, method and ranges. A file with another identity is refused.
    is_resumed
        Continue from the file if it exists.
    """

    def __init__(self, path: Path, identity: str, *, is_resumed: bool) -> None:
        self.path = path
        self._identity = identity
        self._searches: dict[str, tuple[Floats, Floats]] = {}
        self._saved_s = time.monotonic()
        if is_resumed and path.exists():
            self._load()

    def cached(self, name: str) -> tuple[Floats, Floats] | None:
        """Points and costs of a search; None without any."""
        return self._searches.get(name)

    def note(self, name: str, objective: Objective) -> None:
        """Record the evaluations of a search, and save every few seconds."""
        self._searches[name] = (objective.cube, objective.costs)
        if time.monotonic() - self._saved_s >= SAVE_S:
            self.save()

    def save(self) -> None:
        """Write the file."""
        arrays = {"identity": np.array(self._identity)}
        for name, (cube, costs) in self._searches.items():
            arrays |= {f"{name}/cube": cube, f"{name}/costs": costs}
        with whole_file(self.path) as file:
            np.savez(file, **arrays)  # type: ignore[arg-type]  # the stubs take the names for options
        self._saved_s = time.monotonic()

    def discard(self) -> None:
        """Remove the file."""
        self.path.unlink(missing_ok=True)

    def _load(self) -> None:
        try:
            arrays = _arrays(self.path)
        except Exception as error:  # numpy, zip and zlib name their troubles in many ways
            why = str(error) or type(error).__name__
            raise DataError(f"{self.path}: cannot be resumed from: {why}; remove it to start over") from error
        if str(arrays.pop("identity", "")) != self._identity:
            raise DataError(
                f"{self.path}: belongs to other sessions, ranges or another method; "
                "remove it, or start over without --resume"
            )
        for name in {key.rpartition("/")[0] for key in arrays}:
            cube, costs = (arrays.get(f"{name}/{part}", np.empty(0)) for part in ("cube", "costs"))
            if cube.ndim != 2 or costs.shape != cube.shape[:1] or {cube.dtype, costs.dtype} != {np.dtype(np.float64)}:
                raise DataError(f"{self.path}: cannot be resumed from: it was damaged; remove it to start over")
            self._searches[name] = (cube, costs)


def _arrays(path: Path) -> dict[str, NDArray[Any]]:
    """Arrays of a file; a file that claims an impossible size is refused."""
    check_ordinary(path)
    with path.open("rb") as file, ZipFile(file) as parts:
        claimed = sum(part.file_size for part in parts.infolist())
        if claimed > LARGEST_BYTES:
            raise DataError(f"it claims to hold {claimed} bytes")
        file.seek(0)
        with np.load(file) as stored:
            arrays = {name: stored[name] for name in stored.files}
    if not all(isinstance(array, np.ndarray) for array in arrays.values()):  # numpy returns bytes for other content
        raise DataError("it holds something other than arrays")
    return arrays
