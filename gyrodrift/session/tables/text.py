"""Lines of a table file: encoding, comments, and rejection of files that are not text."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from gyrodrift.values.errors import DataError

HEAD_BYTES = 1 << 16
LONGEST_LINE = 1 << 16
"""Characters of the longest line that can be a row."""

COMMENT = "#"
MARKS = {b"\xef\xbb\xbf": "utf-8-sig", b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16"}
"""Byte order marks and the codecs that read them."""

CONTAINERS = {
    b"PK\x03\x04": "is a zip archive or a spreadsheet (.xlsx): unpack it, or save the sheet as .csv",
    b"\x1f\x8b": "is compressed (gzip): unpack it first",
    b"\xd0\xcf\x11\xe0": "is a spreadsheet (.xls): save it as .csv",
    b"PAR1": "is a Parquet file: name it .parquet",
    b"SQLite format 3": "is a database (.db3): give the folder of the bag, which has metadata.yaml in it",
    b"#ROSBAG": "is a ROS 1 bag: name it .bag",
}
CONTROL_BYTES = bytes({*range(1, 9), *range(0x0E, 0x1A), *range(0x1C, 0x20), 0x7F})
CONTROL_SHARE = 0.02
"""Bytes with a larger share of control characters are not text."""


@contextmanager
def opened(path: Path) -> Iterator[TextIO]:
    """Open a table as text, with any encoding and line ends.

    Raises
    ------
    DataError
        It cannot be read, or is not text.
    """
    try:
        with path.open("rb") as file:
            encoding = _encoding(path, file.read(HEAD_BYTES))
        with path.open(encoding=encoding, errors="replace") as text:
            yield text
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror or error}") from error
    except MemoryError as error:
        raise DataError(f"{path}: its samples need more memory than this computer has") from error


def _encoding(path: Path, head: bytes) -> str:
    for magic, advice in CONTAINERS.items():
        if head.startswith(magic):
            raise DataError(f"{path}: {advice}")
    encoding = next((codec for mark, codec in MARKS.items() if head.startswith(mark)), "") or _without_mark(head)
    controls = len(head) - len(head.translate(None, CONTROL_BYTES))
    if controls > CONTROL_SHARE * len(head) and not encoding.startswith("utf-16"):
        raise DataError(f"{path}: is not text: byte {_first_control(head)} is a control character")
    return encoding


def _first_control(head: bytes) -> int:
    return next(index for index, byte in enumerate(head) if byte in CONTROL_BYTES)


def _without_mark(head: bytes) -> str:
    """Encoding without a byte order mark: UTF-16 has zeros in every second byte; text that is not UTF-8 is cp1252."""
    for start, codec in ((1, "utf-16-le"), (0, "utf-16-be")):
        if len(head) > 1 and head[start::2].count(0) > 0.7 * len(head[start::2]) and head[1 - start :: 2].count(0) == 0:
            return codec
    try:
        head[:-4].decode("utf-8") if len(head) == HEAD_BYTES else head.decode("utf-8")
    except UnicodeDecodeError as error:
        return "utf-8" if error.reason == "unexpected end of data" else "cp1252"
    return "utf-8"


class Lines:
    """Lines with content, without comments; `number` is the number of the last line, from 1.

    comments
        Numbers and texts of the comments before the first line with content.
    """

    def __init__(self, file: TextIO) -> None:
        self.number = 0
        self.comments: list[tuple[int, str]] = []
        self._file = file
        self._has_begun = False

    def __iter__(self) -> Iterator[str]:
        while line := self._file.readline(LONGEST_LINE):
            self.number += 1
            if line.startswith(COMMENT):
                self._remark(line)
            elif not line.isspace():
                self._has_begun = True
                yield line

    def _remark(self, line: str) -> None:
        if not self._has_begun and len(self.comments) < 1000:
            self.comments.append((self.number, line))
