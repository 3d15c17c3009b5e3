"""The process that reads a config for a running service: `python -m gyrodrift.config PID PATH [SOURCE]`.

PID is the service; this process ends with it. It writes to stdout, pickled: the version of this program, the config or
None, and every mistake.
"""

import pickle
import sys
from pathlib import Path

from gyrodrift import __version__
from gyrodrift.config.model import Config
from gyrodrift.config.reading import load_in_time
from gyrodrift.io.system import kill_with
from gyrodrift.values.errors import ConfigError


def _read(path: Path, source: str) -> tuple[Config | None, tuple[str, ...]]:
    try:
        return load_in_time(path, source), ()
    except ConfigError as error:
        return None, error.problems


if __name__ == "__main__":
    _, parent, path, source = [*sys.argv, ""][:4]
    kill_with(int(parent))
    pickle.dump((__version__, *_read(Path(path), source)), sys.stdout.buffer)
