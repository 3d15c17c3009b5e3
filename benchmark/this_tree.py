"""The command line of this clone, in a process of its own with one thread of linear algebra."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
COMMAND = (sys.executable, "-m", "gyrodrift")
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
ENVIRONMENT = {"PYTHONPATH": str(ROOT), **ONE_THREAD}
"""The code beside these programs is measured, wherever another one is installed."""


def run_gyrodrift(*words: str | Path, timeout_s: float | None = None) -> None:
    """Run a command.

    Raises
    ------
    subprocess.CalledProcessError
        It ended with an error; `stderr` has what it said.
    """
    subprocess.run(
        [*COMMAND, *map(str, words)],
        check=True,
        env=os.environ | ENVIRONMENT,
        capture_output=True,
        text=True,
        timeout=timeout_s,
    )
