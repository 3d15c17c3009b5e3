"""The line on stderr that says which file a command wrote."""

import sys
from pathlib import Path

from gyrodrift.values.errors import visible

SIZES = ((1e9, "GB"), (1e6, "MB"), (1e3, "kB"))


def tell_written(path: Path, contents: str, *, is_quiet: bool) -> None:
    """Say that a file is written, what it holds and how large it is; nothing with `--quiet`."""
    if not is_quiet:
        print(visible(f"gyrodrift: {written_words(path, contents)}"), file=sys.stderr)


def tell_page(path: Path, *, is_quiet: bool) -> None:
    """Say where the page of a command is, for a browser; nothing with `--quiet`."""
    if not is_quiet:
        print(visible(f"page: {path}"), file=sys.stderr)


def written_words(path: Path, contents: str) -> str:
    """Path, contents and size of a file that was written; a pipe or a device has no size."""
    size = f", {size_text(path.stat().st_size)}" if path.is_file() else ""
    return f"{path} written: {contents}{size}"


def samples_text(count: int) -> str:
    """A number of samples as a person reads it."""
    return f"{count:,} sample{'s' * (count != 1)}"


def size_text(size_bytes: int) -> str:
    """A size in bytes, kB, MB or GB, three digits."""
    for unit_bytes, unit in SIZES:
        if size_bytes >= unit_bytes:
            return f"{size_bytes / unit_bytes:.3g} {unit}"
    return f"{size_bytes} bytes"
