"""A config file, watched: polled by `stat`, since editors save by renaming and that kills file watches."""

from collections.abc import Callable
from pathlib import Path
from typing import Protocol

from gyrodrift.config.in_time import load_in_time
from gyrodrift.config.model import Config
from gyrodrift.config.reading import ConfigReading
from gyrodrift.errors import ConfigError

FileVersion = tuple[int, int, int]

GONE_LOOKS = 2
"""A file that two looks in a row do not find is gone; between the halves of a careless save one may not find it."""


class PendingConfig(Protocol):
    """One reading of a file, as `reading.ConfigReading` is one."""

    @property
    def is_gone(self) -> bool:
        """Whether nothing of it is left."""

    def outcome(self) -> Config | None:
        """The config; None while it is being read. Raises ConfigError."""

    def close(self) -> None:
        """End it."""


class ConfigWatch:
    """Loads the file at once, and again whenever its time, size or inode changes: then by a process of its own.

    Parameters
    ----------
    begin
        Begins a reading.

    Raises
    ------
    ConfigError
        From the constructor, and from `poll` for each changed file that has mistakes; the watch goes on.
    """

    def __init__(self, path: Path, begin: Callable[[Path], PendingConfig] = ConfigReading) -> None:
        self.path = path
        self._begin = begin
        self._seen = _version_of(path)
        self.config = load_in_time(path)
        self._in_vain = 0
        self._is_asked = False
        self._begun = 0
        self._reading: PendingConfig | None = None
        self._is_under_way = False

    @property
    def is_gone(self) -> bool:
        """Whether there is no such file any more."""
        return self._in_vain >= GONE_LOOKS

    @property
    def ended(self) -> int:
        """How many readings have ended."""
        return self._begun - self._is_under_way

    def ask(self) -> int:
        """Have the file read again, changed or not; the count of `ended` when that is done."""
        self._is_asked = True
        return self._begun + 1

    def poll(self) -> Config | None:
        """The new config where one has been read; None where nothing changed, or is not read yet, or the file is gone.

        It waits for nothing.
        """
        found = _version_of(self.path)
        self._in_vain = 0 if found else self._in_vain + 1
        if self._reading is None and (self._is_asked or (found is not None and found != self._seen)):
            self._seen = found
            self._begin_reading()
        return None if self._reading is None else self._go_on(self._reading)

    def close(self) -> None:
        """End a reading that is under way."""
        if self._reading is not None:
            self._reading.close()
            self._reading = None

    def _begin_reading(self) -> None:
        self._is_asked = False
        self._begun += 1
        self._reading = self._begin(self.path)
        self._is_under_way = True

    def _go_on(self, reading: PendingConfig) -> Config | None:
        """The outcome once; another reading begins when the process of this one is gone."""
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
