"""Fuzzing by chance, where atheris has no wheel: the seeds and what was kept of guided runs, changed."""

import resource
from random import Random

from fuzz.command import CORPUS, FOUND, KEPT
from fuzz.limits import Limited
from fuzz.mutate import mutated
from fuzz.targets import TARGETS

MOST_BYTES = 500 << 20


def run(name: str, seconds: int, seed: int) -> int:
    """Fuzz one target for so many seconds of processor time; what broke it stays in .fuzz/found/TARGET-running."""
    seeds = [path.read_bytes() for folder in (CORPUS, KEPT) for path in sorted((folder / name).iterdir())]
    running, target, random = FOUND / f"{name}-running", Limited(TARGETS[name], seconds), Random(seed)
    base_kb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    while not target.is_over:
        content = mutated(name, seeds, random)
        running.write_bytes(content)
        target(content)
        grown_kb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - base_kb
        if grown_kb << 10 > MOST_BYTES:
            print(f"{grown_kb >> 10} MB more memory: {running}")
            return 1
    running.unlink(missing_ok=True)
    target.tell()
    return 0
