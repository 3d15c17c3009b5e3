"""Sessions for other programs."""

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gyrodrift.session.session import Session


def load_session(path: str | PathLike[str]) -> "Session":
    """A recorded session (`.mcap` or `.csv`) as arrays.

    Raises
    ------
    DataError
        Where it is missing, of an unknown kind, or damaged.
    """
    from gyrodrift.session import files

    return files.load_session(Path(path))
