"""Fuzz each target for a while: guided by coverage where atheris is there, by chance where it is not.

New inputs that reach something are kept in .fuzz/TARGET; what breaks something goes to .fuzz/found, and from there,
once it is repaired, into tests/fuzz/corpus/TARGET, which every run of the tests goes through.
"""

import argparse
import resource
import subprocess
import sys
import time
from importlib.util import find_spec
from pathlib import Path
from random import Random

ROOT = Path(__file__).resolve().parent.parent.parent
CORPUS = Path(__file__).resolve().parent / "corpus"
KEPT, FOUND = ROOT / ".fuzz", ROOT / ".fuzz" / "found"
LONGEST_CALL_S = 2
MOST_BYTES = 500 << 20
NAMES = ("decoders", "detector", "text", "columns", "clocks", "config", "rig", "mcap", "csv", "journal", "clients")


def main() -> int:
    """All targets one after the other, each in a process of its own, or one of them in this process."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("--seconds", type=int, default=600, help="for all targets together (default 600)")
    parser.add_argument("--seed", type=int, default=0, help="0 draws one (default 0)")
    parser.add_argument("--target", choices=NAMES, help="only this one, in this process")
    asked = parser.parse_args()
    seed = asked.seed or int(time.time())
    if asked.target:
        return _one(asked.target, asked.seconds, seed)
    share_s = max(1, asked.seconds // len(NAMES))
    print(f"{'guided by coverage' if find_spec('atheris') else 'by chance: no atheris here'}, seed {seed}", flush=True)
    broken = [name for name in NAMES if _process(name, share_s, seed)]
    print(f"{len(NAMES)} targets, {share_s} s each; broken: {', '.join(broken) or 'none'}")
    return 1 if broken else 0


def _process(name: str, seconds: int, seed: int) -> int:
    """Run a target and print its last words; a fault of the process itself is one too."""
    words = ["--target", name, "--seconds", str(seconds), "--seed", str(seed)]
    done = subprocess.run(
        [sys.executable, "-m", "tests.fuzz", *words], cwd=ROOT, capture_output=True, text=True, errors="replace",
        check=False,
    )  # fmt: skip
    lines = (done.stdout + done.stderr).splitlines()
    told = [line for line in lines if " runs in " in line or line.startswith("Done ")]
    print(f"{name:10} {told[-1] if told and not done.returncode else f'status {done.returncode}'}", flush=True)
    if done.returncode:
        print("\n".join(lines[-30:]), flush=True)
    return done.returncode


def _one(name: str, seconds: int, seed: int) -> int:
    """Fuzz one target."""
    for folder in (KEPT / name, FOUND):
        folder.mkdir(parents=True, exist_ok=True)
    return _guided(name, seconds, seed) if find_spec("atheris") else _by_chance(name, seconds, seed)


def _guided(name: str, seconds: int, seed: int) -> int:
    import atheris  # noqa: PLC0415 - has no wheel for every machine

    with atheris.instrument_imports(include=["gyrodrift", "firmware_sim"]):
        from fuzz.targets import TARGETS  # noqa: PLC0415 - is instrumented while it is imported

    base_bytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss << 10
    options = {
        "max_total_time": seconds,
        "seed": seed % (1 << 31) or 1,
        "timeout": LONGEST_CALL_S,
        "rss_limit_mb": (base_bytes + MOST_BYTES) >> 20,
        "max_len": 1 << 16,
        "artifact_prefix": f"{FOUND}/{name}-",
    }
    words = [f"-{key}={value}" for key, value in options.items()]
    atheris.Setup([sys.argv[0], *words, str(KEPT / name), str(CORPUS / name)], TARGETS[name])
    atheris.Fuzz()
    return 0


def _by_chance(name: str, seconds: int, seed: int) -> int:
    from fuzz.mutate import mutated  # noqa: PLC0415 - not for the guided one
    from fuzz.targets import TARGETS  # noqa: PLC0415

    seeds = [path.read_bytes() for path in sorted((CORPUS / name).iterdir())]
    random, runs, slowest_s, end_s = Random(seed), 0, 0.0, time.monotonic() + seconds
    base_kb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    while time.monotonic() < end_s:
        content, begun_s = mutated(seeds, random), time.monotonic()
        (FOUND / f"{name}-running").write_bytes(content)
        TARGETS[name](content)
        runs, slowest_s = runs + 1, max(slowest_s, time.monotonic() - begun_s)
        grown_kb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - base_kb
        if slowest_s > LONGEST_CALL_S or grown_kb << 10 > MOST_BYTES:
            print(f"{slowest_s:.1f} s, {grown_kb >> 10} MB: {FOUND / f'{name}-running'}")
            return 1
    (FOUND / f"{name}-running").unlink(missing_ok=True)
    print(f"{runs} runs in {seconds} s, the slowest took {slowest_s:.2f} s")
    return 0
