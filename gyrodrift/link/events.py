"""What the link reports, as log lines: never more than one a second for what may happen with every sample.

A recording and the outputs hear the same.
"""

import time
from collections.abc import Callable
from typing import Any

from structlog.typing import FilteringBoundLogger

WARNINGS = frozenset(
    {
        "gap",
        "link_lost",
        "link_refused",
        "device_reset",
        "link_silent",
        "rate_unit_differs",
        "not_understood",
        "columns_kept",
    }
)
GAP_EVERY_S = 1.0


class LinkEvents:
    """What a link calls with its events; gaps that follow each other closely are added up to one line."""

    def __init__(self, log: FilteringBoundLogger, monotonic: Callable[[], float] = time.monotonic) -> None:
        self.listeners: list[Callable[[str, dict[str, Any]], Any]] = []
        self._log = log
        self._monotonic = monotonic
        self._holes = 0
        self._missing = 0
        self._longest_s = 0.0
        self._next_s = float("-inf")

    def __call__(self, event: str, **fields: Any) -> None:
        """Log an event; a gap perhaps a little later."""
        if event == "gap":
            self._holes += 1
            self._missing += int(fields["missing"])
            self._longest_s = max(self._longest_s, float(fields["seconds"]))
            self.report_gaps()
        else:
            self._report(event, fields)

    def report_gaps(self) -> None:
        """Log the gaps that have added up, if the last such line is old enough."""
        now_s = self._monotonic()
        if self._holes and now_s >= self._next_s:
            self._report("gap", {"holes": self._holes, "missing": self._missing, "longest_s": self._longest_s})
            self._holes = self._missing = 0
            self._longest_s = 0.0
            self._next_s = now_s + GAP_EVERY_S

    def _report(self, event: str, fields: dict[str, Any]) -> None:
        if event in WARNINGS:
            self._log.warning(event, **fields)
        else:
            self._log.info(event, **fields)
        for listener in self.listeners:
            listener(event, fields)
