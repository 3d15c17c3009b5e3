"""Builds that the processes of a test run share."""

import fcntl
import tempfile
from collections.abc import Callable
from pathlib import Path


def built_once(name: str, build: Callable[[Path], None]) -> Path:
    """Folder that `build` fills once for all processes of a test run, which share a home folder."""
    folder = Path.home() / "built" / name
    folder.parent.mkdir(exist_ok=True)
    with (folder.parent / f"{name}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not folder.exists():
            unfinished = Path(tempfile.mkdtemp(dir=folder.parent))
            build(unfinished)
            unfinished.rename(folder)
    return folder
