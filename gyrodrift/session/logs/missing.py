"""Imports of packages that only logs and bags need."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from gyrodrift.io.installation import extra_command
from gyrodrift.values.errors import DataError


@contextmanager
def packages_of(path: Path, extra: str) -> Iterator[None]:
    """Turn the import error of an optional package into an error for the user.

    Raises
    ------
    DataError
        The package is missing; with the command that installs it.
    """
    try:
        yield
    except ImportError as error:
        raise DataError(f"{path}: needs the package {error.name}: {extra_command(extra)}") from error
