"""State of the link over the last second: sample rate, jitter, and use of the line."""

import time
from typing import Any

from gyrodrift.link.link import Link
from gyrodrift.values.constants import LINE_BITS_PER_BYTE
from gyrodrift.values.sample import Sample

SECOND_S = 1.0


class LinkMeter:
    """Measures the samples of a link over the last whole second.

    rate_hz
        Samples per second.
    jitter_s
        Peak-to-peak variation of the delay from device clock to arrival, s.
    busy
        Used share of the capacity of the line; 0 for a pty.
    """

    def __init__(self, link: Link) -> None:
        self.link = link
        self._marked_s = time.monotonic()
        self._samples = self._bytes = 0
        self._least_s = float("inf")
        self._most_s = float("-inf")
        self.rate_hz = self.jitter_s = self.busy = 0.0

    def take(self, samples: list[Sample]) -> None:
        """Note the delay of the newest sample."""
        if not samples:
            return
        newest = samples[-1]
        late_s = newest.t_host_s - newest.t_device_s
        self._least_s = min(self._least_s, late_s)
        self._most_s = max(self._most_s, late_s)

    def tick(self, now_s: float) -> None:
        """Update the values once a second."""
        elapsed_s = now_s - self._marked_s
        if elapsed_s < SECOND_S:
            return
        counters, port = self.link.counters, self.link.port
        self.rate_hz = (counters.samples - self._samples) / elapsed_s
        self.jitter_s = max(0.0, self._most_s - self._least_s)
        bits_per_s = (counters.bytes - self._bytes) * LINE_BITS_PER_BYTE / elapsed_s
        self.busy = bits_per_s / self.link.baud if port is not None and port.has_line_rate else 0.0
        self._marked_s, self._samples, self._bytes = now_s, counters.samples, counters.bytes
        self._least_s, self._most_s = float("inf"), float("-inf")

    def stats(self) -> dict[str, Any]:
        """No fields: the loop logs the counters."""
        return {}

    def close(self) -> None:
        """Nothing is open."""
