"""Fuzzing guided by coverage (atheris): inputs that reach new places of the code are kept and changed again."""

import sys
from random import Random

import atheris

from fuzz.command import CORPUS, FOUND, KEPT

LONGEST_HANG_S = 120
"""An input that waits for so long breaks the target, as one does that takes seconds of processor time."""

BYTES_SHARE = 0.3
"""Of the changes are those of libFuzzer, which knows what the code has compared; the others are ours."""

PACKAGES = ["gyrodrift", "firmware_sim", "mcap", "mcap_ros2", "yaml"]


def run(name: str, seconds: int, seed: int) -> int:
    """Fuzz one target for so many seconds of processor time; ends the process."""
    with atheris.instrument_imports(include=PACKAGES):
        from fuzz.targets import TARGETS  # noqa: PLC0415 - is instrumented while it is imported
    from fuzz.limits import LONGEST_INSTRUMENTED_CALL_S, Limited, ending  # noqa: PLC0415 - imports no target before
    from fuzz.mutate import LONGEST, changed  # noqa: PLC0415 - likewise

    def mutate(content: bytes, most_bytes: int, mutation_seed: int) -> bytes:
        random = Random(mutation_seed)
        if random.random() < BYTES_SHARE:
            made: bytes = atheris.Mutate(content, most_bytes)
            return made
        return changed(name, content, random)[:most_bytes]

    options = {
        "seed": seed % (1 << 31) or 1,
        "timeout": LONGEST_HANG_S,
        "rss_limit_mb": 0,  # memory of single calls is limited instead
        "max_len": LONGEST,
        "len_control": 0,
        "use_counters": 0,  # how often a place is reached is not worth an input that is kept
        "artifact_prefix": f"{FOUND}/{name}-",
    }
    words = [f"-{key}={value}" for key, value in options.items()]
    atheris.Setup(
        [sys.argv[0], *words, str(KEPT / name), str(CORPUS / name)],
        ending(Limited(TARGETS[name], seconds, LONGEST_INSTRUMENTED_CALL_S)),
        custom_mutator=mutate,
    )
    atheris.Fuzz()
    return 0
