"""Imports of packages that only logs and bags need."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from gyrodrift.errors import DataError
from gyrodrift.installation import extra_command


@contextmanager
def packages_of(path: Path, extra: str) -> Iterator[None]:
    """Around the import of such a package.

    Raises
    ------
    DataError
        With the command that installs it, where it is missing.
    """
    try:
        yield
    except ImportError as error:
        raise DataError(f"{path}: needs the package {error.name}: {extra_command(extra)}") from error
