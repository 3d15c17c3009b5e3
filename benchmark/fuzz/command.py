"""Fuzz each target for a while: guided by coverage where atheris is there, by chance where it is not.

New inputs that reach something are kept in .fuzz/TARGET, where the next run begins. What breaks something goes to
.fuzz/found, and from there, once it is repaired, into benchmark/fuzz/corpus/TARGET: every run of the tests goes through
it.
An input that takes over a second of processor time, or 500 MB of memory, breaks its target too.
"""

import argparse
import re
import resource
import subprocess
import sys
import time
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
CORPUS = Path(__file__).resolve().parent / "corpus"
KEPT, FOUND = ROOT / ".fuzz", ROOT / ".fuzz" / "found"
NAMES = (
    *(
        "decoders",
        "detector",
        "text",
        "columns",
        "clocks",
        "config",
        "rig",
        "mcap",
        "damage",
        "csv",
        "journal",
        "memory",
    ),
    *("clients", "sockets", "source_decoders"),
)
COVERED = re.compile(r"cov: (\d+)")
RUNS = re.compile(r"^\d+ runs in \d+ s$")


def main(argv: Sequence[str] | None = None) -> int:
    """All targets one after the other, each in a process of its own, or one of them in this process."""
    parser = argparse.ArgumentParser(prog="python -m benchmark fuzz", description=__doc__)
    parser.add_argument("--seconds", type=int, default=600, help="processor time of all targets together (default 600)")
    parser.add_argument("--seed", type=int, default=0, help="0 draws one (default 0)")
    parser.add_argument("--only", nargs="+", choices=NAMES, default=NAMES, metavar="TARGET", help="only these")
    parser.add_argument("--target", choices=NAMES, help="only this one, in this process")
    asked = parser.parse_args(argv)
    seed = asked.seed or int(time.time())
    if asked.target:
        return _one(asked.target, asked.seconds, seed)
    share_s = max(1, asked.seconds // len(asked.only))
    print(f"{'guided by coverage' if find_spec('atheris') else 'by chance: no atheris here'}, seed {seed}", flush=True)
    broken = [name for name in asked.only if _process(name, share_s, seed)]
    print(f"{len(asked.only)} targets, {share_s} s of processor time each; broken: {', '.join(broken) or 'none'}")
    return 1 if broken else 0


def _process(name: str, seconds: int, seed: int) -> int:
    """Run a target and print how far it came; a fault of the process itself breaks the target too."""
    words = ["--target", name, "--seconds", str(seconds), "--seed", str(seed)]
    done = subprocess.run(
        [sys.executable, "-m", "benchmark", "fuzz", *words], cwd=ROOT, capture_output=True, text=True, errors="replace",
        check=False,
    )  # fmt: skip
    lines = (done.stdout + done.stderr).splitlines()
    print(f"{name:10} {summary(lines, name) if not done.returncode else f'status {done.returncode}'}", flush=True)
    if done.returncode:
        for said in (done.stdout, done.stderr):
            print("\n".join(line[:400] for line in said.splitlines()[-25:]), flush=True)
    return done.returncode


def summary(lines: Sequence[str], name: str) -> str:
    """Runs, places of the code that were reached, and inputs that were kept, from what a target's process said."""
    runs = [line for line in lines if RUNS.match(line)]
    covered = [found[1] for line in lines if (found := COVERED.search(line))]
    kept = sum(1 for _ in (KEPT / name).iterdir()) if (KEPT / name).is_dir() else 0
    said = runs[-1] if runs else "nothing was run"
    return f"{said}, {covered[-1] if covered else 'unknown'} places reached, {kept} inputs kept"


def _one(name: str, seconds: int, seed: int) -> int:
    """Fuzz one target."""
    for folder in (KEPT / name, FOUND):
        folder.mkdir(parents=True, exist_ok=True)
    if find_spec("atheris"):
        from fuzz.guided import run  # noqa: PLC0415 - atheris has no wheel for every machine
    else:
        from fuzz.chance import run  # noqa: PLC0415 - one of the two
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    return run(name, seconds, seed)
