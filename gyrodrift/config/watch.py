"""A config file, watched: polled by `stat`, since editors save by renaming and that kills file watches."""

from pathlib import Path

from gyrodrift.config.model import Config, load_config

FileVersion = tuple[int, int, int]

GONE_LOOKS = 2
"""A file that two looks in a row do not find is gone; between the halves of a careless save one may not find it."""


class ConfigWatch:
    """Loads the file at once, and again whenever its time, size or inode changes.

    Raises
    ------
    ConfigError
        From the constructor, and from `poll` for each changed file that has mistakes; the watch goes on.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._seen = _version_of(path)
        self.config = load_config(path)
        self._in_vain = 0

    @property
    def is_gone(self) -> bool:
        """Whether there is no such file any more."""
        return self._in_vain >= GONE_LOOKS

    def poll(self, *, again: bool = False) -> Config | None:
        """The new config where there is one; None where nothing changed, or the file is gone for a moment.

        `again` reads it in any case.
        """
        found = _version_of(self.path)
        self._in_vain = 0 if found else self._in_vain + 1
        if not again and (found is None or found == self._seen):
            return None
        self._seen = found
        self.config = load_config(self.path)
        return self.config


def _version_of(path: Path) -> FileVersion | None:
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_mtime_ns, status.st_ino, status.st_size
