"""Fuzzing by chance, where atheris has no wheel: the seeds and what was kept of guided runs, changed."""

from random import Random

from fuzz.command import CORPUS, FOUND, KEPT
from fuzz.limits import Limited
from fuzz.mutate import mutated
from fuzz.targets import TARGETS


def run(name: str, seconds: int, seed: int) -> int:
    """Fuzz one target for so many seconds of processor time; what broke it stays in .fuzz/found/TARGET-running."""
    seeds = [path.read_bytes() for folder in (CORPUS, KEPT) for path in sorted((folder / name).iterdir())]
    running, target, random = FOUND / f"{name}-running", Limited(TARGETS[name], seconds), Random(seed)
    while not target.is_over:
        content = mutated(name, seeds, random)
        running.write_bytes(content)
        target(content)
    running.unlink(missing_ok=True)
    target.tell()
    return 0
