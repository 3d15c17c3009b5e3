"""What the link reports, as log lines: never more than one a second for what may happen with every sample.

A recording and the outputs hear the same.
"""

import time
from collections.abc import Callable
from typing import Any

from gyrodrift.logger import FilteringBoundLogger

WARNINGS = frozenset(
    {
        "gap",
        "link_lost",
        "link_refused",
        "device_reset",
        "host_clock_set",
        "link_silent",
        "rate_unit_differs",
        "rate_hangs",
        "clock_unit_differs",
        "not_understood",
        "columns_kept",
        "decoder_failed",
    }
)
OFTEN = frozenset({"gap", "device", "device_reset"})
"""What a bad link or a device that boots over and over may bring with every sample."""

OFTEN_S = 1.0


class LinkEvents:
    """What a link calls with its events; of those that may come OFTEN, one is told in OFTEN_S, with what followed it.

    Gaps are added up. Of other events the last is told, with `times` where there were more.
    """

    def __init__(self, log: FilteringBoundLogger, monotonic: Callable[[], float] = time.monotonic) -> None:
        self.listeners: list[Callable[[str, dict[str, Any]], Any]] = []
        self._log = log
        self._monotonic = monotonic
        self._held: dict[str, dict[str, Any]] = {}
        self._next_s: dict[str, float] = {}

    def __call__(self, event: str, **fields: Any) -> None:
        """Log an event; one that comes often perhaps a little later."""
        if event not in OFTEN:
            self._report(event, fields)
            return
        self._held[event] = _together(event, self._held.get(event), fields)
        self.report_held()

    def report_held(self, *, is_end: bool = False) -> None:
        """Log what has added up, of each kind whose last line is old enough; at the end of all kinds."""
        now_s = self._monotonic()
        for event in [each for each in self._held if is_end or now_s >= self._next_s.get(each, now_s)]:
            self._next_s[event] = now_s + OFTEN_S
            self._report(event, self._held.pop(event))

    def _report(self, event: str, fields: dict[str, Any]) -> None:
        if event in WARNINGS:
            self._log.warning(event, **fields)
        else:
            self._log.info(event, **fields)
        for listener in self.listeners:
            listener(event, fields)


def _together(event: str, held: dict[str, Any] | None, fields: dict[str, Any]) -> dict[str, Any]:
    if event == "gap":
        holes, missing, longest_s = (held["holes"], held["missing"], held["longest_s"]) if held else (0, 0, 0.0)
        longest_s = max(longest_s, float(fields["seconds"]))
        return {"holes": holes + 1, "missing": missing + int(fields["missing"]), "longest_s": longest_s}
    return fields if held is None else fields | {"times": held.get("times", 1) + 1}
