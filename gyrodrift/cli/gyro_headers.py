"""Header of a gyro for its microcontroller, written from a config by `tune`."""

from pathlib import Path

from gyrodrift.io.files import UnreadableError, check_writable, read_ordinary, write_whole
from gyrodrift.values.errors import UsageError

MARK = b"Written by gyrodrift "
"""Words in the head of every written header, before the version."""

INCLUDED = ("gyrodrift.h", "gyrodrift_native.h", "math.h", "stdint.h", "string.h")
"""Headers that the library and its includes are found by: a header of this name would be included in their place."""

LONGEST_BYTES = 1 << 20


def check_header(path: Path) -> None:
    """Check that a header can be written, and replaces no file of another origin.

    Raises
    ------
    UsageError
        With what is wrong.
    """
    if path.suffix not in (".h", ".hpp"):
        raise UsageError(f"--header {path}: a header ends in .h")
    if path.name.lower() in INCLUDED:
        raise UsageError(f"--header {path}: {path.name} is a header of the library or of C; choose another name")
    if not path.parent.is_dir():
        raise UsageError(f"--header {path}: there is no folder {path.parent}")
    check_writable(path.parent)
    try:
        content = read_ordinary(path, LONGEST_BYTES).content
    except FileNotFoundError:
        return
    except UnreadableError as error:
        raise UsageError(f"--header {path}: {error}") from error
    if MARK not in content:
        raise UsageError(f"--header {path}: is not from gyrodrift; choose another name")


def write_header(path: Path, config: Path) -> None:
    """Write parameters and calibration of a config."""
    from gyrodrift.config.model import load_config
    from gyrodrift.firmware.my_gyro import TunedGyro, my_gyro_h

    write_whole(path, [my_gyro_h(TunedGyro.of_config(load_config(config), config.name), path.name)])
