"""Sessions and numbers that a person gives to an analysis, checked before long work."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from gyrodrift.columns.spec import Column, columns_of
from gyrodrift.io.files import check_inputs_kept
from gyrodrift.session.checks.stated import AS_WRITTEN, ReadingOptions
from gyrodrift.session.damage import DamagedError
from gyrodrift.session.files import damages_of
from gyrodrift.values.errors import UsageError

OnWarning = Callable[[str], None]
"""Called with a warning for a person, without a full stop."""


def ignore_warning(_warning: str) -> None:
    """Ignore a warning."""


@dataclass(frozen=True, slots=True)
class InputOptions:
    """Options for the sessions of an analysis.

    reading
        Columns and units as stated by a person.
    allow_damage
        Whether the undamaged part of a damaged recording is used.
    outputs
        Files that the analysis writes, none of which may be an input.
    warn
        Called with the damage of each recording that is used.
    """

    reading: ReadingOptions = AS_WRITTEN
    allow_damage: bool = False
    outputs: Sequence[Path] = ()
    warn: OnWarning = ignore_warning

    def check(self, sessions: Sequence[Path], files: Sequence[Path] = ()) -> None:
        """Check that the outputs replace neither sessions nor other input files, and that the sessions are usable.

        Raises
        ------
        UsageError
            With the input that would be lost.
        DamagedError
            With all damaged recordings, unless damage is allowed.
        """
        check_inputs_kept(self.outputs, [*sessions, *files])
        damages = damages_of(sessions)
        if damages and not self.allow_damage:
            raise DamagedError(damages)
        for path, damage in damages:
            self.warn(damage_warning(path, str(damage)))


AS_GIVEN = InputOptions()


def damage_warning(path: Path, damage: str) -> str:
    """The warning for a recording whose undamaged part is used."""
    return f"{path}: is damaged: {damage}"


def columns_or_none(spec: str | None) -> tuple[Column, ...] | None:
    """Columns of the option `--columns SPEC`; None without one leaves them to the headers."""
    return None if spec is None else columns_of(spec)


def check_name(option: str, name: str, names: Iterable[str], kind: str | None = None) -> None:
    """Refuse a name that does not exist; `kind` is the kind of name, if it is not the name of the option."""
    if name not in names:
        raise UsageError(f"{option} {name!r}: there is no such {kind or option}; there are {', '.join(names)}")


def check_count(option: str, value: int) -> None:
    """Refuse a number below 1."""
    if value < 1:
        raise UsageError(f"{option} {value}: expected a whole number from 1")


def check_seeds(seeds: tuple[int, ...]) -> None:
    """Refuse negative seeds, and a search without any."""
    if not seeds or min(seeds) < 0:
        raise UsageError(f"seeds {seeds}: expected whole numbers from 0, at least one")
