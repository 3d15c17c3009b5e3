"""State in which every process of the tests starts, however the suite was started.

Children inherit ignored signals (a background job of a shell ignores SIGINT, `nohup` SIGHUP), blocked signals, the
environment, the umask and the working directory.
"""

import os
import signal
import time
from pathlib import Path

ROOT = Path(__file__).parent.parent

DEFINED = {
    "LC_ALL": "C.UTF-8",
    "OPENBLAS_NUM_THREADS": "1",
    "PYTHONPATH": str(ROOT),  # the code beside these tests, wherever an editable install points
    "TERM": "xterm-256color",
    "TZ": "UTC",
}
KEPT = ("CI", "GYRODRIFT_RECORDINGS", "LD_LIBRARY_PATH", "PATH", "TMPDIR", "VIRTUAL_ENV")
KEPT_PREFIXES = ("COVERAGE_", "PYTEST_")
"""Paths of programs, and variables of the test runner."""

DEFAULT_SIGNALS = (signal.SIGHUP, signal.SIGQUIT, signal.SIGTERM, signal.SIGUSR1, signal.SIGUSR2, signal.SIGWINCH)


def set_process_defaults(home: Path) -> None:
    """Set signals, environment, umask and working directory; children inherit them."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    for number in DEFAULT_SIGNALS:
        signal.signal(number, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_SETMASK, ())
    os.umask(0o022)
    os.chdir(ROOT)
    _set_environment(home)


def _set_environment(home: Path) -> None:
    for name in list(os.environ):
        if name not in KEPT and not name.startswith(KEPT_PREFIXES):
            del os.environ[name]
    os.environ.update(DEFINED, HOME=str(home))
    time.tzset()
