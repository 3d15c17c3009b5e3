"""Sessions for other programs."""

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gyrodrift.session.session import Session


def load_session(path: str | PathLike[str], *, allow_damage: bool = False) -> "Session":
    """A recorded session (`.mcap` or `.csv`) as arrays.

    Parameters
    ----------
    path
        The file.
    allow_damage
        Whether what is whole of a damaged recording is returned; `session.damage` then says what is missing.

    Raises
    ------
    DamagedError
        Where it is damaged; `damages` says which samples are lost, and how many seconds.
    DataError
        Where it is missing, of an unknown kind, or no session.
    """
    from gyrodrift.session import files

    return files.load_session(Path(path), allow_damage=allow_damage)
