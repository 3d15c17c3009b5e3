"""End of a recording after some seconds of device time."""

import time
from collections.abc import Callable
from typing import Protocol

from gyrodrift.recording.recorder import Recorder
from gyrodrift.values.sample import Sample

GRACE_S = 1.0
"""A device that falls silent keeps a recording open no longer than this, s."""


class Stop(Protocol):
    """Flag that ends the loop."""

    is_set: bool


class Duration:
    """Passes the samples of the first `seconds` to a recorder, then sets the stop flag."""

    def __init__(
        self, recorder: Recorder, seconds: float, stop: Stop, monotonic: Callable[[], float] = time.monotonic
    ) -> None:
        self.close = recorder.close
        self.stats = recorder.stats
        self._recorder = recorder
        self._seconds = seconds
        self._stop = stop
        self._monotonic = monotonic
        self._is_over = False
        self._first_s: float | None = None
        self._first_host_s = self._last_host_s = 0.0

    def take(self, samples: list[Sample]) -> None:
        """Record the samples within the duration."""
        if not samples or self._is_over:
            return
        self._last_host_s = self._monotonic()
        if self._first_s is None:
            self._first_s, self._first_host_s = samples[0].t_device_s, self._last_host_s
        until_s = self._first_s + self._seconds
        inside = [sample for sample in samples if sample.t_device_s < until_s]
        self._recorder.take(inside)
        if len(inside) < len(samples):
            self._end()

    def tick(self, now_s: float) -> None:
        """End by the host clock if the device is silent."""
        self._recorder.tick(now_s)
        if self._first_s is None or now_s - self._last_host_s < GRACE_S:
            return
        if now_s - self._first_host_s >= self._seconds:
            self._end()

    def _end(self) -> None:
        """Set the flag and never reset it: a signal sets it too, and the samples of that moment are still recorded."""
        self._is_over = self._stop.is_set = True
