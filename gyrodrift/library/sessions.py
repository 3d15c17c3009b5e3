"""Sessions for other programs."""

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gyrodrift.session.session import Session


def load_session(
    path: str | PathLike[str],
    *,
    columns: str | None = None,
    reference: str | None = None,
    allow_damage: bool = False,
    sample_rate_hz: float = 0.0,
) -> "Session":
    """Load a recorded session (`.mcap`) or a table (`.csv`, `.json` and others) as arrays.

    Parameters
    ----------
    path
        The file.
    columns
        Columns of a table, as in the option `--columns`; None to read them from the header.
    reference
        Topic of a bag or `.mcap` with the reference angle, as in the option `--reference`; None for none.
    allow_damage
        Return the undamaged part of a damaged recording; `session.damage` then has the losses.
    sample_rate_hz
        Rate of the samples, in place of a clock, as in the option `--sample-rate`; 0 for the clock of the session.

    Raises
    ------
    DamagedError
        If it is damaged; `damages` says which samples are lost, and how many seconds.
    DataError
        If it is missing, of an unknown kind, or no session.
    """
    from gyrodrift.session.checks.given import columns_or_none
    from gyrodrift.session.checks.stated import ReadingOptions, session_as_stated

    named = columns_or_none(columns)
    stated = ReadingOptions(named, reference=reference or "", sample_rate_hz=sample_rate_hz)
    return session_as_stated(Path(path), stated, allow_damage=allow_damage)
