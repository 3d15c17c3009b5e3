"""A config file that is followed by polling `stat`: editors save by renaming, which ends file watches."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Protocol

from gyrodrift.config.model import Config
from gyrodrift.config.reading import ConfigReading, load_in_time
from gyrodrift.values.errors import ConfigError

FileVersion = tuple[int, int, int]

GONE_LOOKS = 2
"""Polls in a row that must miss a file before it counts as gone; some editors remove a file before they write it."""


class PendingConfig(Protocol):
    """One reading of a file, such as `reading.ConfigReading`."""

    @property
    def is_gone(self) -> bool:
        """Whether its process has ended."""

    def outcome(self) -> Config | None:
        """The config; None while it is being read. Raises ConfigError."""

    def close(self) -> None:
        """Abort the reading."""


class ConfigWatch:
    """Loads the file at once. When its time, size or inode changes, another process reads it again.

    Parameters
    ----------
    begin
        Starts a reading.
    source
        Source whose block is read; empty for the whole file.

    Raises
    ------
    ConfigError
        From the constructor, and from `poll` for a changed file with mistakes; the watch goes on.
    """

    def __init__(self, path: Path, begin: Callable[[Path], PendingConfig] | None = None, source: str = "") -> None:
        self.path = path
        self._begin = begin or partial(ConfigReading, source=source)
        self._version = _version_of(path)
        self.config = load_in_time(path, source)
        self._in_vain = 0
        self._is_asked = False
        self._begun = 0
        self._reading: PendingConfig | None = None
        self._is_under_way = False

    @property
    def is_gone(self) -> bool:
        """Whether the file is missing."""
        return self._in_vain >= GONE_LOOKS

    @property
    def ended(self) -> int:
        """Number of readings that have ended."""
        return self._begun - self._is_under_way

    def ask(self) -> int:
        """Request another reading; returns the value of `ended` at which it is done."""
        self._is_asked = True
        return self._begun + 1

    def poll(self) -> Config | None:
        """The new config, once; None if nothing changed, the reading has not ended, or the file is missing.

        It never waits.
        """
        version = _version_of(self.path)
        self._in_vain = 0 if version else self._in_vain + 1
        if self._reading is None and (self._is_asked or (version is not None and version != self._version)):
            self._version = version
            self._begin_reading()
        return None if self._reading is None else self._go_on(self._reading)

    def close(self) -> None:
        """Abort a reading in progress."""
        if self._reading is not None:
            self._reading.close()
            self._reading = None

    def _begin_reading(self) -> None:
        self._is_asked = False
        self._begun += 1
        self._reading = self._begin(self.path)
        self._is_under_way = True

    def _go_on(self, reading: PendingConfig) -> Config | None:
        """The outcome, once. The next reading can begin when this process has ended."""
        new = None
        if self._is_under_way:
            try:
                new = reading.outcome()
            except ConfigError:
                self._is_under_way = False
                raise
            if new is None:
                return None
            self._is_under_way, self.config = False, new
        if reading.is_gone:
            self._reading = None
        return new


def _version_of(path: Path) -> FileVersion | None:
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_mtime_ns, status.st_ino, status.st_size
