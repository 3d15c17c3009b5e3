"""What a tuning has asked so far, kept in a file, so that an interrupted one can go on where it was."""

import time
from pathlib import Path
from zipfile import BadZipFile

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.errors import DataError
from gyrodrift.files import whole_file
from gyrodrift.tune.search.objective import Objective

SAVE_S = 5.0


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
            # np.load leaves a damaged file open when it opens it itself.
            with self.path.open("rb") as file, np.load(file) as stored:
                arrays = {name: stored[name] for name in stored.files}
        except (OSError, ValueError, EOFError, BadZipFile) as error:
            raise DataError(f"{self.path}: cannot be resumed from: {error}; remove it to begin anew") from error
        if str(arrays.pop("identity", "")) != self._identity:
            raise DataError(
                f"{self.path}: belongs to other sessions, ranges or another method; "
                "remove it or leave --resume away to begin anew"
            )
        for name in {key.rpartition("/")[0] for key in arrays}:
            self._searches[name] = (arrays[f"{name}/cube"], arrays[f"{name}/costs"])
