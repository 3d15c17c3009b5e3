"""Put named faults into a copy of the project, one at a time, and run the tests that must catch them.

The tests of all chosen faults run first without a fault: they must pass. Status 0 where every fault is caught.
"""

import argparse
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import SimpleQueue
from tempfile import TemporaryDirectory

from mutate.copy import ALL_PASSED, ROOT, Outcome, Trial, copy_project, run_tests, try_fault
from mutate.fault import Fault
from mutate.faults import FAULTS

CAUGHT = ROOT / ".mutate" / "caught.txt"
"""Names of the faults that the last run caught: `--resume` passes them by."""


def main(argv: Sequence[str] | None = None) -> int:
    """Try the chosen faults and print a table."""
    parser = argparse.ArgumentParser(prog="python -m benchmark mutate", description=__doc__)
    parser.add_argument("chosen", nargs="*", metavar="NAME", help="areas or parts of names (default: all faults)")
    parser.add_argument("--processes", type=int, default=2, help="how many faults are tried at a time (default 2)")
    parser.add_argument("--resume", action="store_true", help="pass by what the last run caught")
    parser.add_argument("--no-baseline", action="store_true", help="do not run the tests without a fault first")
    parser.add_argument("--list", action="store_true", help="print names and sentences, try nothing")
    asked = parser.parse_args(argv)
    faults = chosen_faults(asked.chosen, CAUGHT.read_text().split() if asked.resume and CAUGHT.exists() else ())
    if asked.list:
        print("\n".join(f"{fault.name:40} {fault.breaks}" for fault in faults))
        return 0
    if not faults:
        print("no fault of that name")
        return 2
    if not asked.resume:
        CAUGHT.unlink(missing_ok=True)
    return run(faults, asked.processes, has_baseline=not asked.no_baseline)


def chosen_faults(words: Sequence[str], caught: Sequence[str] = ()) -> list[Fault]:
    """The faults whose name contains one of the words, less those already caught."""
    is_chosen = {fault.name: not words or any(word in fault.name for word in words) for fault in FAULTS}
    return [fault for fault in FAULTS if is_chosen[fault.name] and fault.name not in caught]


def run(faults: Sequence[Fault], processes: int, *, has_baseline: bool) -> int:
    """Try faults in as many copies as processes; 1 where one is not caught, or the tests fail without it."""
    begun_s = time.monotonic()
    with TemporaryDirectory(prefix="gyrodrift-mutate-") as name, ThreadPoolExecutor(processes) as pool:
        copies: SimpleQueue[Path] = SimpleQueue()
        for number in range(processes):
            folder = Path(name) / str(number)
            folder.mkdir()
            copy_project(folder)
            copies.put(folder)
        if has_baseline and not _passes_without_fault(faults, copies):
            return 1
        tried = [pool.submit(_try, copies, fault, number) for number, fault in enumerate(faults)]
        trials = [_tell(trial.result()) for trial in tried]
    caught = sum(trial.outcome is Outcome.CAUGHT for trial in trials)
    print(f"{caught} of {len(trials)} faults caught in {time.monotonic() - begun_s:.0f} s")
    return 0 if caught == len(trials) else 1


def _passes_without_fault(faults: Sequence[Fault], copies: SimpleQueue[Path]) -> bool:
    """Whether all tests of the faults pass in a copy as it is."""
    tests = _without_parts(sorted({test for fault in faults for test in fault.tests}))
    folder = copies.get()
    status, output = run_tests(folder, tests)
    copies.put(folder)
    print("\n".join(output.splitlines()[-1 if status == ALL_PASSED else -40 :]), "without a fault", flush=True)
    return status == ALL_PASSED


def _without_parts(tests: list[str]) -> list[str]:
    """Tests of which the whole file is named too are left out."""
    return [test for test in tests if "::" not in test or test.partition("::")[0] not in tests]


def _try(copies: SimpleQueue[Path], fault: Fault, number: int) -> Trial:
    """Try a fault in a copy that is free."""
    folder = copies.get()
    try:
        trial = try_fault(folder, fault, number)
    finally:
        copies.put(folder)
    if trial.outcome is Outcome.CAUGHT:
        CAUGHT.parent.mkdir(exist_ok=True)
        with CAUGHT.open("a") as file:
            file.write(f"{fault.name}\n")
    return trial


def _tell(trial: Trial) -> Trial:
    """Print a row of the table, and what the tests said where the fault was not caught."""
    print(f"{trial.name:44} {trial.outcome:10} {trial.seconds:6.1f} s  {trial.test}", flush=True)
    if trial.outcome is not Outcome.CAUGHT:
        print(trial.output, flush=True)
    return trial
