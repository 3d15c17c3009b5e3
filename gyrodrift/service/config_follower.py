"""Applies a config that changes while `serve` runs, between two samples."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any

from gyrodrift.service.listener import IdleListener
from gyrodrift.service.pipeline import Pipeline
from gyrodrift.values.errors import ConfigError

if TYPE_CHECKING:  # the config loads its checker, which a service without a config does not need
    from gyrodrift.config.model import Config
    from gyrodrift.config.watch import ConfigWatch

RATE_TOLERANCE = 0.05
"""Largest relative difference between the sample rate and the one that the parameters were tuned at."""


@dataclass(slots=True)
class ConfigFollower(IdleListener):
    """A listener behind the pipeline; without a config it does nothing.

    listeners
        Called with each new config.
    applied, refused, applied_s
        Number of configs that were applied and refused since the start; Unix time of the last one applied, s.
    """

    pipeline: Pipeline
    watch: "ConfigWatch | None" = None
    listeners: "list[Callable[[Config], Any]]" = field(default_factory=list)
    applied: int = 0
    refused: int = 0
    applied_s: float | None = None
    _is_rate_checked: bool = False
    _is_gone: bool = False
    _outcome: "list[str] | ConfigError" = field(default_factory=list)

    def __post_init__(self) -> None:
        if self.watch is not None:
            self._log_completed(self.watch)

    def tick(self, now_s: float) -> None:  # noqa: ARG002 - all listeners have this signature
        """Apply a config that has changed, and check the sample rate once."""
        if self.watch is not None:
            self.follow(self.watch)
            if not self._is_rate_checked and self.pipeline.filter.counts_samples:
                self._compare_rate(self.watch.config)

    def close(self) -> None:
        """End the process that reads the config."""
        if self.watch is not None:
            self.watch.close()

    def reload(self, watch: "ConfigWatch") -> Callable[[], list[str] | None]:
        """Read the config again, changed or not. The result gives the changes, or None until they are known.

        It raises ConfigError with all mistakes; the old config then stays.
        """
        return partial(self._outcome_of, watch, watch.ask())

    def _outcome_of(self, watch: "ConfigWatch", reading: int) -> list[str] | None:
        if watch.ended < reading:
            return None
        if isinstance(self._outcome, ConfigError):
            raise self._outcome
        return self._outcome

    def follow(self, watch: "ConfigWatch") -> None:
        """Apply a new config, or report its mistakes."""
        old, new = watch.config, None
        try:
            new = watch.poll()
        except ConfigError as error:
            self._outcome = error
            self._refuse(error)
        self._tell_gone(watch)
        if new is not None:
            self._outcome = self._apply(watch, old, new)

    def _refuse(self, error: ConfigError) -> None:
        self.refused += 1
        for problem in error.problems:
            self.pipeline.log.error("config_rejected", reason=problem)
        self.pipeline.tell("config_rejected", {"reasons": list(error.problems)})

    def _apply(self, watch: "ConfigWatch", old: "Config", new: "Config") -> list[str]:
        self.pipeline.use(new)
        self._is_rate_checked = False
        self.applied, self.applied_s = self.applied + 1, time.time()
        changes = new.changes_from(old)
        self._log("config_applied", file=str(watch.path), changes=changes)
        if new.completed != old.completed:
            self._log_completed(watch)
        for listener in self.listeners:
            listener(new)
        return changes

    def _log(self, event: str, **fields: Any) -> None:
        self.pipeline.log.info(event, **fields)
        self.pipeline.tell(event, fields)

    def _log_completed(self, watch: "ConfigWatch") -> None:
        """Log the defaults in use."""
        if watch.config.completed:
            defaults = list(watch.config.completed)
            self.pipeline.log.info("config_completed", file=str(watch.path), defaults=defaults)

    def _tell_gone(self, watch: "ConfigWatch") -> None:
        """Warn of a missing config file once, and log its return."""
        if watch.is_gone and not self._is_gone:
            self.pipeline.log.warning("config_gone", file=str(watch.path), hint="the last valid config stays")
            self.pipeline.tell("config_gone", {"file": str(watch.path)})
        elif self._is_gone and not watch.is_gone:
            self._log("config_back", file=str(watch.path))
        self._is_gone = watch.is_gone

    def _compare_rate(self, config: "Config") -> None:
        clock, chosen = self.pipeline.link.clock, self.pipeline.filter
        period_s = clock.period_s if clock else 0.0
        if not period_s:
            return
        self._is_rate_checked = True
        tuned_hz = config.sample_rate_hz
        if tuned_hz is not None and abs(period_s * tuned_hz - 1.0) > RATE_TOLERANCE:
            self.pipeline.log.warning(
                "sample_rate_differs",
                tuned_at_hz=tuned_hz,
                stream_hz=round(1.0 / period_s, 3),
                hint=f"{chosen.sample_counted} count samples; tune at the rate of this stream",
            )
