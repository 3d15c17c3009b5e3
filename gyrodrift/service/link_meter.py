"""How the link is now, second by second: what a person who watches wants beside the counters."""

import time
from typing import Any

from gyrodrift.link.link import Link
from gyrodrift.sample import Sample

SECOND_S = 1.0
BITS_PER_BYTE = 10
"""A byte on a serial line has a start and a stop bit."""


class LinkMeter:
    """Hears the samples of a link; what it tells is of the last whole second.

    rate_hz
        Samples per second.
    jitter_s
        Peak-to-peak variation of how long samples took from the device's clock to here.
    busy
        Share of the line's capacity that is used; 0 for a pty.
    """

    def __init__(self, link: Link) -> None:
        self.link = link
        self._marked_s = time.monotonic()
        self._samples = self._bytes = 0
        self._least_s = float("inf")
        self._most_s = float("-inf")
        self.rate_hz = self.jitter_s = self.busy = 0.0

    def take(self, samples: list[Sample]) -> None:
        """Note how late the newest of them is."""
        if not samples:
            return
        newest = samples[-1]
        late_s = newest.t_host_s - newest.t_device_s
        self._least_s = min(self._least_s, late_s)
        self._most_s = max(self._most_s, late_s)

    def tick(self, now_s: float) -> None:
        """Once a second, the figures of the second that has passed."""
        elapsed_s = now_s - self._marked_s
        if elapsed_s < SECOND_S:
            return
        counters, port = self.link.counters, self.link.port
        self.rate_hz = (counters.samples - self._samples) / elapsed_s
        self.jitter_s = max(0.0, self._most_s - self._least_s)
        bits_per_s = (counters.bytes - self._bytes) * BITS_PER_BYTE / elapsed_s
        self.busy = bits_per_s / self.link.baud if port is not None and not port.is_pty else 0.0
        self._marked_s, self._samples, self._bytes = now_s, counters.samples, counters.bytes
        self._least_s, self._most_s = float("inf"), float("-inf")

    def stats(self) -> dict[str, Any]:
        """Nothing of its own: the loop logs the counters."""
        return {}

    def close(self) -> None:
        """Nothing is open."""
