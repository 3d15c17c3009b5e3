"""What an input may cost, and how long a target is fuzzed: both in processor time, which other work does not change."""

import os
import resource
import time
from collections.abc import Callable

LONGEST_CALL_S, LONGEST_INSTRUMENTED_CALL_S = 1.0, 3.0
"""Of 32 kB; coverage makes a call two to three times as long."""


MOST_BYTES = 500 << 20
"""Largest growth of the peak memory in one call. The memory of a whole run says nothing: a guided run loses some kB in
each call of a mutator of its own, though the same calls without a fuzzer leave memory flat."""


class Limited:
    """A target with assertions on processor time and memory; `is_over` once all calls have had `seconds`."""

    def __init__(self, target: Callable[[bytes], None], seconds: float, longest_s: float = LONGEST_CALL_S) -> None:
        self.runs = 0
        self._target, self._seconds, self._longest_s = target, seconds, longest_s
        self._begun_s = time.process_time()

    def __call__(self, content: bytes) -> None:
        """Run the target."""
        begun_s, begun_bytes = time.process_time(), _peak_bytes()
        self._target(content)
        taken_s, grown_bytes = time.process_time() - begun_s, _peak_bytes() - begun_bytes
        assert taken_s < self._longest_s, f"{len(content)} bytes took {taken_s:.1f} s of processor time"
        assert grown_bytes < MOST_BYTES, f"{len(content)} bytes took {grown_bytes >> 20} MB of memory"
        self.runs += 1

    @property
    def is_over(self) -> bool:
        """Whether the time is up."""
        return time.process_time() - self._begun_s >= self._seconds

    def tell(self) -> None:
        """Print how far it came."""
        print(f"{self.runs} runs in {time.process_time() - self._begun_s:.0f} s", flush=True)


def _peak_bytes() -> int:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss << 10


def ending(limited: Limited) -> Callable[[bytes], None]:
    """The target for a fuzzer that never returns: the process ends with status 0 when the time is up."""

    def run(content: bytes) -> None:
        limited(content)
        if limited.is_over:
            limited.tell()
            os._exit(0)

    return run
