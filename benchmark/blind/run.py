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
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic
from typing import IO, Any

from gyrogap.catalogue import EFFECTS
from gyrogap.data_set import digest_of_files
from gyrogap.json_files import write_json
from this_tree import COMMAND, ENVIRONMENT, ROOT

from blind.folder import Plan, PlannedCase, SetFolder
from blind.gap import load_json, read_outcome

STDERR_KEPT = 4000
ADOPTING = "again"
NOTHING_TO_ADOPT = {
    "exit_status": 0,
    "timed_out": False,
    "seconds": 0.0,
    "stderr": "the blind run names no cause, so that there is nothing to adopt",
    "gap": None,
    "rig": None,
}

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
    command: tuple[str, ...] = COMMAND


@dataclass(frozen=True, slots=True)
class _Look:
    """One run of `diagnose` on a case.

    withheld
        Effects that it must do without.
    sessions
        Folder of the case that it is of; what is of `again` takes the rig that the blind run wrote.
    """

    run: str
    withheld: tuple[str, ...] = ()
    sessions: str = "sessions"

    @property
    def adopts(self) -> bool:
        """Whether the rig is what an earlier run made of it."""
        return self.sessions == ADOPTING


@dataclass(frozen=True, slots=True)
class _Job:
    """A case and its runs."""

    case: str
    looks: tuple[_Look, ...]


def run_set(folder: SetFolder, options: Options, say: Say) -> None:
    """All blind runs, then the oracle's."""
    plan = folder.plan()
    _run_jobs(folder, plan, [_blind_job(case) for case in plan.cases], options, say)
    if options.oracle:
        _run_jobs(folder, plan, _oracle_jobs(folder, plan), options, say)


def _blind_job(case: PlannedCase) -> _Job:
    withheld = (_Look("withheld", (case.withhold,)),) if case.withhold else ()
    then = (_Look(case.then, sessions=case.then),) if case.then else ()
    return _Job(case.name, (_Look("blind"), *withheld, *then))


def _oracle_jobs(folder: SetFolder, plan: Plan) -> list[_Job]:
    """For every case with a single effect: all others are withheld."""
    jobs = []
    for case in plan.cases:
        label = folder.open_seal(case.name, "oracle")
        if label["kind"] == "single":
            true = label["effects"][0]["name"]
            jobs.append(_Job(case.name, (_Look("oracle", tuple(effect for effect in EFFECTS if effect != true)),)))
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


def _missing(folder: SetFolder, job: _Job) -> list[_Look]:
    return [look for look in job.looks if not folder.result(job.case, look.run).is_file()]


def _run_job(folder: SetFolder, plan: Plan, job: _Job, options: Options) -> str:
    """Generate the case anew and make the runs that have no result; what to say of it."""
    said = []
    with TemporaryDirectory(prefix="blind-") as temporary:
        case = Path(temporary) / "case"
        _generate(plan, job.case, case)
        print_of_data = digest_of_files(case)
        for look in _missing(folder, job):
            rig = _adopted(folder, job.case) if look.adopts else (case / "rig.yaml").read_text()
            outcome = _diagnose(case, Path(temporary) / look.run, look, rig, options) if rig else NOTHING_TO_ADOPT
            outcome = {
                **outcome,
                "case": job.case,
                "run": look.run,
                "withheld": list(look.withheld),
                "data_sha256": print_of_data,
            }
            write_json(folder.result(job.case, look.run), outcome)
            said.append(f"{look.run} {_verdict(outcome)} {outcome['seconds']:.1f} s")
        if options.keep and not folder.kept(job.case).exists():
            shutil.copytree(case, folder.kept(job.case))
    return ", ".join(said)


def _verdict(outcome: dict[str, Any]) -> str:
    gap = outcome["gap"]
    return str(gap["verdict"]) if isinstance(gap, dict) and "verdict" in gap else "failed"


def _adopted(folder: SetFolder, case: str) -> str:
    """The rig that the blind run wrote, where it names a cause; else empty."""
    blind = load_json(folder.result(case, "blind"))
    return str(blind["rig"] or "") if read_outcome(blind).names_causes else ""


def _generate(plan: Plan, case: str, into: Path) -> None:
    """In a process of its own, which alone knows what is put in."""
    numbers = ["--seed", str(plan.seed), "--case", case]
    subprocess.run(
        [sys.executable, "-m", "benchmark", "blind", "generate", *numbers, "--out", str(into)], cwd=ROOT, check=True
    )


def _diagnose(case: Path, out: Path, look: _Look, rig: str, options: Options) -> dict[str, Any]:
    """Call the command line; its result, its last words and how long it took."""
    out.mkdir()
    stated = case / "rig.yaml"
    if look.adopts:
        stated = out / "rig.yaml"
        stated.write_text(rig)
    words = [*options.command, "diagnose", str(case / look.sessions), "--rig", str(stated)]
    words += ["--out", str(out / "report"), "--jobs", "1"]
    words += ["--baseline", str(case / "baseline")] if (case / "baseline").is_dir() else []
    words += [word for effect in look.withheld for word in ("--withhold", effect)]
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
        "rig": _text_of(out / "report" / "rig.yaml"),
    }


def _text_of(path: Path) -> str | None:
    return path.read_text() if path.is_file() else None


def _wait(words: list[str], folder: Path, stderr: IO[str], timeout_s: float) -> tuple[int, bool]:
    """Exit status, and whether it was ended for being late; in a session of its own, to end it with its children."""
    process = subprocess.Popen(
        words,
        cwd=folder,
        env=os.environ | ENVIRONMENT,
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
