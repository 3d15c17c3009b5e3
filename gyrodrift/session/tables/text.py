"""Lines of a table file: encoding, comments, and rejection of files that are not text."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from shlex import quote
from typing import TextIO

from gyrodrift.io.plain_text import SIGNS
from gyrodrift.values.errors import DataError

HEAD_BYTES = 1 << 16
LONGEST_LINE = 1 << 16
"""Characters of the longest line that can be a row."""

COMMENT = "#"
ESCAPE = re.compile(r"\x1b\[[0-9;?]*+[A-Za-z]|\x1b[@-Z\\-_]")
"""Terminal control sequences (ECMA-48), as in `plain_text`."""

PACKED = {".gz", ".bz2", ".xz", ".zst"}
MARKS = {b"\xef\xbb\xbf": "utf-8-sig", b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16"}
"""Byte order marks and the codecs that read them."""

SAVE_SHEET = "save the sheet as .csv, and give that file"
EXPORT = "export its table as .csv, and give that file"
CONTAINERS = {
    b"PK\x03\x04": "is a zip archive: unzip {quoted}, and give a file of it",
    b"\x1f\x8b": "is compressed by gzip; unpack it: gzip -dc {quoted} > {unpacked}",
    b"BZh": "is compressed by bzip2; unpack it: bzip2 -dc {quoted} > {unpacked}",
    b"\xfd7zXZ": "is compressed by xz; unpack it: xz -dc {quoted} > {unpacked}",
    b"\x28\xb5\x2f\xfd": "is compressed by zstd; unpack it: zstd -dc {quoted} > {unpacked}",
    b"7z\xbc\xaf": "is a 7z archive: 7z x {quoted}, and give a file of it",
    b"Rar!": "is a rar archive: unrar x {quoted}, and give a file of it",
    b"\xd0\xcf\x11\xe0": f"is a spreadsheet (.xls): {SAVE_SHEET}",
    b"PAR1": "is a Parquet file: name it .parquet",
    b"SQLite format 3": "is a database (.db3): give the folder of the bag, which has metadata.yaml in it",
    b"#ROSBAG": "is a ROS 1 bag: name it .bag",
    b"\x89MCAP0": "is an MCAP file: name it .mcap",
    b"ULog\x01": "is a log of PX4: name it .ulg",
    b"\x89HDF": f"is an HDF5 file: {EXPORT}",
    b"MATLAB 5.0": "is a MATLAB file: write its table as .csv with writetable or writematrix",
    b"\x93NUMPY": "is an array of NumPy: write it as .csv with numpy.savetxt",
    b"ARROW1": f"is an Arrow file: {EXPORT}, or as .parquet",
    b"%PDF": f"is a PDF, no data: {EXPORT}",
    b"version https://git-lfs": "is a pointer of Git LFS, no data: fetch the data with git lfs pull",
}
"""First bytes of files that are no table, and what to do; {quoted} is the path, {unpacked} the path without ending."""

SHEETS = (b"xl/", b"opendocument.spreadsheet")
"""Bytes at the beginning of a zip archive that is a spreadsheet."""

ARRAYS = b".npy"
WEB_PAGE = re.compile(rb"\s*+(?:<!--.{0,999}?-->\s*+)?<(?:!doctype html|html|head)\b", re.IGNORECASE | re.DOTALL)
CONTROL_BYTES = bytes({*range(1, 9), *range(0x0E, 0x1A), *range(0x1C, 0x20), 0x7F})
CONTROL_SHARE = 0.02
"""Bytes with a larger share of control characters are not text."""


class NoTableError(DataError):
    """A file has no table in it."""


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
    if advice := _advice(head):
        raise DataError(f"{path}: {advice.format(quoted=quote(str(path)), unpacked=quote(_unpacked(path)))}")
    encoding = next((codec for mark, codec in MARKS.items() if head.startswith(mark)), "") or _without_mark(head)
    controls = len(head) - len(head.translate(None, CONTROL_BYTES))
    if controls > CONTROL_SHARE * len(head) and not encoding.startswith("utf-16"):
        raise NoTableError(f"{path}: is not text: byte {_first_control(head)} is a control character")
    return encoding


def _unpacked(path: Path) -> str:
    """Free name for an unpacked file."""
    name = path.with_suffix("") if path.suffix in PACKED else path
    name = name if name.suffix else name.with_suffix(".csv")
    return str(name.with_suffix(f".unpacked{name.suffix}") if name.exists() else name)


def _advice(head: bytes) -> str:
    """Kind of a file without a table, and what to do; empty for other files."""
    if head.startswith(b"PK") and any(mark in head for mark in SHEETS):
        return f"is a spreadsheet: {SAVE_SHEET}"
    if head.startswith(b"PK") and ARRAYS in head[:200]:
        return "is an archive of NumPy arrays: write its table as .csv with numpy.savetxt"
    if head[257:262] == b"ustar":
        return "is a tar archive: tar -xf {quoted}, and give a file of it"
    if WEB_PAGE.match(head):
        return "is a web page, no data: download the file itself (on code hosts: Raw)"
    return next((advice for magic, advice in CONTAINERS.items() if head.startswith(magic)), "")


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
    has_comments
        Whether lines with a comment mark are data, as some firmware marks them, and appear without the mark.
    """

    def __init__(self, file: TextIO, *, has_comments: bool = False) -> None:
        self.number = 0
        self.comments: list[tuple[int, str]] = []
        self._file = file
        self._has_begun = False
        self._has_comments = has_comments

    def __iter__(self) -> Iterator[str]:
        while line := self._file.readline(LONGEST_LINE):
            self.number += 1
            if "\x1b" in line:
                line = ESCAPE.sub("", line)
            if not line.isascii():
                line = line.translate(SIGNS)
            if line.startswith(COMMENT) and self._has_comments:
                yield line.lstrip(f"{COMMENT} ")
            elif line.startswith(COMMENT):
                self._remark(line)
            elif not line.isspace():
                self._has_begun = True
                yield line

    def _remark(self, line: str) -> None:
        if not self._has_begun and len(self.comments) < 1000:
            self.comments.append((self.number, line))
