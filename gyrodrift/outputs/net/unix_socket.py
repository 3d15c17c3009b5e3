"""A listening unix socket for one user; the permissions of its file decide who can connect."""

import os
import socket
from contextlib import suppress
from pathlib import Path

from gyrodrift.outputs.output import OutputError


def bind_unix(path: Path) -> socket.socket:
    """Bind a unix socket for this user alone; a stale socket is replaced.

    Raises
    ------
    OutputError
        If another process listens there, the path is no socket, or the folder is not writable.
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
    """Remove the socket that was bound at a path, unless its file was replaced; `file_of` identifies it."""
    with suppress(OSError):
        if file_of(path) == listening:
            path.unlink()


def file_of(path: Path) -> tuple[int, int]:
    """Device and inode of a file. OSError if there is none."""
    status = path.lstat()
    return status.st_dev, status.st_ino


def _clear(path: Path) -> None:
    """Remove a stale socket."""
    if not path.exists():
        return
    if not path.is_socket():
        raise OutputError(f"{path} exists and is no socket; choose another with path=")
    with socket.socket(socket.AF_UNIX) as trial:
        trial.setblocking(False)
        try:
            trial.connect(str(path))
        except ConnectionRefusedError:
            path.unlink()
            return
        except BlockingIOError:
            pass
    raise OutputError(f"{path} is used: another process listens there")
