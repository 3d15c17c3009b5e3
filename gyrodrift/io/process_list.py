"""Hiding passwords of the command line in the list of processes."""

import re
from pathlib import Path

from gyrodrift.values.secret import WITHIN_WORD

ARGUMENTS = Path("/proc/self/cmdline")
MEMORY = Path("/proc/self/mem")
STATUS = Path("/proc/self/stat")
ARG_START = 48
"""Field of /proc/PID/stat with the address of the command line (proc(5))."""

PATTERNS = (
    re.compile(WITHIN_WORD.pattern.encode().replace(b".++", rb"([^\0]++)"), re.IGNORECASE),
    re.compile(rb"(://[^\s:@/\0]{0,256}+:)([^\s\0]{1,256})@"),
)
"""`WITHIN_WORD` and `ADDRESS` of `secret` for words that end with a zero byte; the second group is the secret."""


def hide_secrets() -> None:
    """Overwrite passwords on the command line with stars. Before that other users can see them for a moment."""
    try:
        words = ARGUMENTS.read_bytes()
        start = int(STATUS.read_text().rpartition(")")[2].split()[ARG_START - 3])
        with MEMORY.open("r+b", buffering=0) as memory:
            for match in (match for pattern in PATTERNS for match in pattern.finditer(words)):
                memory.seek(start + match.start(2))
                memory.write(b"*" * len(match[2]))
    except OSError:  # no /proc, or no write access to it
        return
