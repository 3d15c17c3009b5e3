"""The runner: generates a case, has the command line look at it, keeps what it said.

It knows names of cases and what to withhold, no labels; only for the oracle, after all blind runs, are seals opened.
What has a result is not run again. A run that fails or takes too long has a result too: that it failed.
"""

import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic
from typing import IO, Any

from blind.catalogue import EFFECTS
from blind.folder import Plan, SetFolder, write_json
from blind.gap import load_json
from blind.seals import open_seal

ROOT = Path(__file__).resolve().parent.parent.parent
STDERR_KEPT = 4000
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
"""As many cases at a time as there are workers, none with threads of its own in linear algebra."""

Say = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class Options:
    """How to run.

    workers
        Cases at a time.
    timeout_s
        After which a run has failed.
    oracle
        Whether the runs with the true effect as the only candidate are made.
    keep
        Whether sessions are kept.
    command
        What is called in place of `gyrodrift`.
    """

    workers: int = 2
    timeout_s: float = 600.0
    oracle: bool = True
    keep: bool = False
    command: tuple[str, ...] = (sys.executable, "-m", "gyrodrift")


@dataclass(frozen=True, slots=True)
class _Job:
    """A case and its runs: name, and effects that are withheld."""

    case: str
    runs: tuple[tuple[str, tuple[str, ...]], ...]


def run_set(folder: SetFolder, options: Options, say: Say) -> None:
    """All blind runs, then the oracle's."""
    plan = folder.plan()
    _run_jobs(folder, plan, [_blind_job(case.name, case.withhold) for case in plan.cases], options, say)
    if options.oracle:
        _run_jobs(folder, plan, _oracle_jobs(folder, plan), options, say)


def _blind_job(case: str, withhold: str) -> _Job:
    return _Job(case, (("blind", ()), *((("withheld", (withhold,)),) if withhold else ())))


def _oracle_jobs(folder: SetFolder, plan: Plan) -> list[_Job]:
    """For every case with a single effect: all others are withheld."""
    jobs = []
    for case in plan.cases:
        label = open_seal(folder, case.name, "oracle")
        if label["kind"] == "single":
            true = label["effects"][0]["name"]
            jobs.append(_Job(case.name, (("oracle", tuple(effect for effect in EFFECTS if effect != true)),)))
    return jobs


def _run_jobs(folder: SetFolder, plan: Plan, jobs: list[_Job], options: Options, say: Say) -> None:
    todo = [job for job in jobs if _missing(folder, job)]
    executor = ThreadPoolExecutor(options.workers)
    try:
        futures = {executor.submit(_run_job, folder, plan, job, options): job for job in todo}
        for number, future in enumerate(as_completed(futures), 1):
            say(f"[{number}/{len(todo)}] {futures[future].case}: {future.result()}")
    finally:
        executor.shutdown(cancel_futures=True)


def _missing(folder: SetFolder, job: _Job) -> list[tuple[str, tuple[str, ...]]]:
    return [run for run in job.runs if not folder.result(job.case, run[0]).is_file()]


def _run_job(folder: SetFolder, plan: Plan, job: _Job, options: Options) -> str:
    """Generate the case anew and make the runs that have no result; what to say of it."""
    said = []
    with TemporaryDirectory(prefix="blind-") as temporary:
        case = Path(temporary) / "case"
        _generate(plan, job.case, case)
        print_of_data = _hash_of_files(case)
        for run, withheld in _missing(folder, job):
            outcome = _diagnose(case, Path(temporary) / run, withheld, options)
            outcome |= {"case": job.case, "run": run, "withheld": list(withheld), "data_sha256": print_of_data}
            write_json(folder.result(job.case, run), outcome)
            verdict = (
                outcome["gap"]["verdict"]
                if isinstance(outcome["gap"], dict) and "verdict" in outcome["gap"]
                else "failed"
            )
            said.append(f"{run} {verdict} {outcome['seconds']:.1f} s")
        if options.keep and not folder.kept(job.case).exists():
            shutil.copytree(case, folder.kept(job.case))
    return ", ".join(said)


def _generate(plan: Plan, case: str, into: Path) -> None:
    """In a process of its own, which alone knows what is put in."""
    numbers = ["--set", plan.set_name, "--seed", str(plan.seed), "--case", case]
    subprocess.run(
        [sys.executable, "-m", "tests.blind", "generate", *numbers, "--out", str(into)], cwd=ROOT, check=True
    )


def _hash_of_files(case: Path) -> str:
    """So that runs of the same case can be seen to have had the same data."""
    total = sha256()
    for path in sorted(case.rglob("*")):
        if path.is_file():
            total.update(path.name.encode() + path.read_bytes())
    return total.hexdigest()


def _diagnose(case: Path, out: Path, withheld: tuple[str, ...], options: Options) -> dict[str, Any]:
    """Call the command line; its result, its last words and how long it took."""
    out.mkdir()
    words = [*options.command, "diagnose", str(case / "sessions"), "--rig", str(case / "rig.yaml")]
    words += ["--out", str(out / "report"), "--jobs", "1"]
    words += [word for effect in withheld for word in ("--withhold", effect)]
    started_s = monotonic()
    with (out / "stderr").open("w+") as stderr:
        status, is_late = _wait(words, out, stderr, options.timeout_s)
        seconds = monotonic() - started_s
        stderr.seek(0)
        last_words = stderr.read()[-STDERR_KEPT:]
    return {
        "exit_status": status,
        "timed_out": is_late,
        "seconds": round(seconds, 2),
        "stderr": last_words,
        "gap": load_json(out / "report" / "gap.json") if status == 0 else None,
    }


def _wait(words: list[str], folder: Path, stderr: IO[str], timeout_s: float) -> tuple[int, bool]:
    """Exit status, and whether it was ended for being late; in a session of its own, to end it with its children."""
    process = subprocess.Popen(
        words,
        cwd=folder,
        env=os.environ | ONE_THREAD,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=stderr,
        start_new_session=True,
    )
    try:
        return process.wait(timeout_s), False
    except subprocess.TimeoutExpired:
        return -signal.SIGKILL, True
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
