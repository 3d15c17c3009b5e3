"""A copy of the project in which faults are put and tests are run."""

import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from mutate.fault import Fault, FaultError

ROOT = Path(__file__).resolve().parent.parent.parent
PYTEST = ("-m", "pytest", "-x", "-q", "-n", "0", "-p", "no:randomly", "-p", "no:cacheprovider")
LONGEST_TEST_S = 300
"""A test that a fault makes hang fails after this time."""

LONGEST_RUN_S = 900
CLIENTS = ("tests/clients/node_modules", "tests/clients/signalk/node_modules")
"""Clients of npm are no tracked files; the copy uses those of the project."""

FAILED = re.compile(r"^(?:FAILED|ERROR) (\S+)", re.MULTILINE)
ALL_PASSED, SOME_FAILED = 0, 1
"""Exit statuses of pytest; all others say that tests could not run."""


class Outcome(StrEnum):
    """What became of a fault."""

    CAUGHT = "caught"
    NOT_CAUGHT = "NOT caught"
    ERROR = "error"


@dataclass(frozen=True, slots=True)
class Trial:
    """A fault that was tried.

    seconds
        How long its tests ran.
    test
        The one that failed.
    output
        The end of what the tests said.
    """

    name: str
    outcome: Outcome
    seconds: float
    test: str = ""
    output: str = ""


def copy_project(folder: Path) -> None:
    """Copy all tracked files of the project, as they are in the working tree."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True)
    for name in filter(None, listed.stdout.split("\0")):
        source, place = ROOT / name, folder / name
        if source.is_file():
            place.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(source, place)
    for name in filter(lambda each: (ROOT / each).is_dir(), CLIENTS):
        (folder / name).symlink_to(ROOT / name)


def run_tests(folder: Path, tests: Sequence[str]) -> tuple[int, str]:
    """Exit status and output of pytest in a copy, whose own code is tested."""
    environment = os.environ | {"PYTHONPATH": str(folder), "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, *PYTEST, "--timeout", str(LONGEST_TEST_S), *tests]
    with suppress(subprocess.TimeoutExpired):
        done = subprocess.run(
            command, cwd=folder, env=environment, capture_output=True, text=True, errors="replace", check=False,
            timeout=LONGEST_RUN_S,
        )  # fmt: skip
        return done.returncode, done.stdout + done.stderr
    return SOME_FAILED, f"still running after {LONGEST_RUN_S} s"


def try_fault(folder: Path, fault: Fault, number: int) -> Trial:
    """Put a fault into a copy, run its tests, and take the fault out; `number` is another one for each fault."""
    begun_s = time.monotonic()
    try:
        with put_in(folder, fault, number):
            status, output = run_tests(folder, fault.tests)
    except FaultError as error:
        return Trial(fault.name, Outcome.ERROR, 0.0, output=str(error))
    outcomes = {ALL_PASSED: Outcome.NOT_CAUGHT, SOME_FAILED: Outcome.CAUGHT}
    failed, end = FAILED.search(output), "\n".join(output.splitlines()[-15:])
    outcome, seconds = outcomes.get(status, Outcome.ERROR), time.monotonic() - begun_s
    return Trial(fault.name, outcome, seconds, failed[1] if failed else "", end)


@contextmanager
def put_in(folder: Path, fault: Fault, number: int) -> Iterator[None]:
    """Change the file, and restore it.

    Bytecode is kept by the time of a source in whole seconds: each version of the file gets a time of its own.
    """
    path = folder / fault.file
    source, time_s = path.read_text(), path.stat().st_mtime
    path.write_text(fault.applied_to(source))
    os.utime(path, (time_s, time_s + number + 1))
    try:
        yield
    finally:
        path.write_text(source)
        os.utime(path, (time_s, time_s))
