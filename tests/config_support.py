"""A config that is read in this process, for tests of whoever follows it."""

from dataclasses import dataclass
from pathlib import Path

from gyrodrift.config.model import Config, load_config


@dataclass
class ReadHere:
    """A reading that takes so many looks."""

    path: Path
    looks: int = 0
    is_gone: bool = False
    is_closed: bool = False

    def outcome(self) -> Config | None:
        """The config, or None while looks are left."""
        if self.looks:
            self.looks -= 1
            return None
        self.is_gone = True
        return load_config(self.path)

    def close(self) -> None:
        """Nothing is under way."""
        self.is_closed = True
