"""Link events as log lines, at most one per second for events that may come with every sample.

Recordings and outputs get the same events.
"""

import time
from collections.abc import Callable
from typing import Any

from gyrodrift.io.logger import FilteringBoundLogger

WARNINGS = frozenset(
    {
        "gap",
        "link_lost",
        "link_refused",
        "device_reset",
        "host_clock_set",
        "link_silent",
        "rate_unit_differs",
        "rate_doubted",
        "verdict_withdrawn",
        "axis_differs",
        "accel_axes_differ",
        "accel_unit_differs",
        "accelerations_missing",
        "axes_missing",
        "rate_hangs",
        "impossible_reading",
        "clipped",
        "clock_unit_differs",
        "not_understood",
        "columns_kept",
        "decoder_failed",
    }
)
OFTEN = frozenset({"gap", "device", "device_reset", "impossible_reading", "clipped"})
"""Events that may come with every sample, from a bad link or a device that keeps booting."""

OFTEN_S = 1.0


class LinkEvents:
    """Event handler of a link; events in OFTEN are logged once per OFTEN_S.

    Gaps are added up. For other events the last one is logged, with `times` if there were several.
    """

    def __init__(self, log: FilteringBoundLogger, monotonic: Callable[[], float] = time.monotonic) -> None:
        self.listeners: list[Callable[[str, dict[str, Any]], Any]] = []
        self._log = log
        self._monotonic = monotonic
        self._pending: dict[str, dict[str, Any]] = {}
        self._next_s: dict[str, float] = {}

    def __call__(self, event: str, **fields: Any) -> None:
        """Log an event; a frequent one may be delayed."""
        if event not in OFTEN:
            self._report(event, fields)
            return
        self._pending[event] = _merged(event, self._pending.get(event), fields)
        self.report_pending()

    def report_pending(self, *, is_end: bool = False) -> None:
        """Log pending events whose last line is old enough; at the end, all of them."""
        now_s = self._monotonic()
        for event in [name for name in self._pending if is_end or now_s >= self._next_s.get(name, now_s)]:
            self._next_s[event] = now_s + OFTEN_S
            self._report(event, self._pending.pop(event))

    def _report(self, event: str, fields: dict[str, Any]) -> None:
        if event in WARNINGS:
            self._log.warning(event, **fields)
        else:
            self._log.info(event, **fields)
        for listener in self.listeners:
            listener(event, fields)


def _merged(event: str, pending: dict[str, Any] | None, fields: dict[str, Any]) -> dict[str, Any]:
    if event == "gap":
        holes, missing, longest_s = (
            (pending["holes"], pending["missing"], pending["longest_s"]) if pending else (0, 0, 0.0)
        )
        longest_s = max(longest_s, float(fields["seconds"]))
        return {"holes": holes + 1, "missing": missing + int(fields["missing"]), "longest_s": longest_s}
    return fields if pending is None else fields | {"times": pending.get("times", 1) + 1}
