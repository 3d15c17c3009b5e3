"""A unix socket to listen on, for one user alone: file permissions are who may connect."""

import os
import socket
from contextlib import suppress
from pathlib import Path

from gyrodrift.outputs.output import OutputError


def bind_unix(path: Path) -> socket.socket:
    """A unix socket at a path, readable by this user alone; one that nobody listens on any more is replaced.

    Raises
    ------
    OutputError
        Where another process listens there, something else lies there, or the folder does not take it.
    """
    listening = socket.socket(socket.AF_UNIX)
    listening.setblocking(False)
    try:
        _clear(path)
        before = os.umask(0o177)
        try:
            listening.bind(str(path))
        finally:
            os.umask(before)
        listening.listen()
    except OutputError:
        listening.close()
        raise
    except OSError as error:
        listening.close()
        raise OutputError(f"cannot listen on {path}: {error.strerror or error}") from error
    return listening


def unlink_unix(path: Path, listening: tuple[int, int]) -> None:
    """Take away the socket that was bound at a path, and nothing that has its place since; `file_of` says which."""
    with suppress(OSError):
        if file_of(path) == listening:
            path.unlink()


def file_of(path: Path) -> tuple[int, int]:
    """What tells a file from others: device and inode. OSError where there is none."""
    found = path.lstat()
    return found.st_dev, found.st_ino


def _clear(path: Path) -> None:
    """Take away a socket that was left behind."""
    if not path.exists():
        return
    if not path.is_socket():
        raise OutputError(f"{path} is there and is no socket; give another with path=")
    with socket.socket(socket.AF_UNIX) as trial:
        trial.setblocking(False)
        try:
            trial.connect(str(path))
        except ConnectionRefusedError:
            path.unlink()
            return
        except BlockingIOError:
            pass
    raise OutputError(f"{path} is taken: another process listens there")
