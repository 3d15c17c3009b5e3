"""What `serve` does with samples: the filter, then the outputs; its config is followed between two samples."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from structlog.typing import FilteringBoundLogger

from gyrodrift.errors import ConfigError
from gyrodrift.filters.filter import Filter, FilterState
from gyrodrift.filters.registry import DEFAULT
from gyrodrift.link.link import Link
from gyrodrift.sample import Corrected, Sample

if TYPE_CHECKING:  # the config brings its checker along, which a service without a config does without
    from gyrodrift.config.model import Config
    from gyrodrift.config.watch import ConfigWatch
    from gyrodrift.service.outputs.output import Output

REJECTED_S = 1.0

RATE_TOLERANCE = 0.05
"""Parameters belong to the sample rate they were tuned at; a stream that differs by more is warned of."""


@dataclass(slots=True)
class Filtering:
    """Takes samples, hands corrected ones to the outputs; without a config it is the chosen filter at its defaults."""

    link: Link
    outputs: "Sequence[Output]"
    log: FilteringBoundLogger
    watch: "ConfigWatch | None" = None
    chosen: Filter = DEFAULT
    state: FilterState = field(init=False)
    _filter: Filter = field(init=False)
    _coefficients: Any = field(init=False)
    _rejected: int = 0
    _rejected_s: float = 0.0
    _is_rate_checked: bool = False
    _is_gone: bool = False

    def __post_init__(self) -> None:
        if self.watch is None:
            self._filter, params = self.chosen, self.chosen.params()
            self.log.info("filter_chosen", name=self._filter.name, parameters="defaults")
        else:
            self._filter, params = self.watch.config.chosen, self.watch.config.params
            self.log.info("filter_chosen", name=self._filter.name, parameters=str(self.watch.path))
            self._tell_completed(self.watch)
        self._coefficients, self.state = self._filter.coefficients(params), self._filter.state()

    def take(self, samples: list[Sample]) -> None:
        """Filter samples and hand them on."""
        step, coefficients, state = self._filter.step, self._coefficients, self.state
        corrected = []
        for sample in samples:
            if step(coefficients, state, sample.t_device_s, sample.rate_dps):
                bias_dps = state.bias_dps
                corrected.append(
                    Corrected(
                        sample,
                        sample.rate_dps - bias_dps,
                        state.yaw_deg,
                        bias_dps,
                        state.yaw_sigma_deg,
                        state.confidence,
                    )
                )
        for output in self.outputs:
            output.take(corrected)

    def tick(self, now_s: float) -> None:
        """Follow the config, tell what was rejected."""
        for output in self.outputs:
            output.tick(now_s)
        if self.watch is not None:
            self._follow_config(self.watch)
        if self.state.rejected > self._rejected and now_s - self._rejected_s >= REJECTED_S:
            self.log.warning("samples_rejected", count=self.state.rejected - self._rejected, total=self.state.rejected)
            self._rejected, self._rejected_s = self.state.rejected, now_s
        if not self._is_rate_checked and self.watch is not None and self._filter.counts_samples:
            self._compare_rate(self.watch.config)

    def stats(self) -> dict[str, Any]:
        """For the log."""
        of_outputs = {name: value for output in self.outputs for name, value in output.stats().items()}
        yaw_deg, bias_dps = round(self.state.yaw_deg, 3), round(self.state.bias_dps, 5)
        return {"rejected": self.state.rejected, **of_outputs, "yaw_deg": yaw_deg, "bias_dps": bias_dps}

    def close(self) -> None:
        """Let the outputs finish."""
        for output in self.outputs:
            output.close()

    def _follow_config(self, watch: "ConfigWatch") -> None:
        old, new, problems = watch.config, None, tuple[str, ...]()
        try:
            new = watch.poll()
        except ConfigError as error:
            problems = error.problems
        self._tell_gone(watch)
        for problem in problems:
            self.log.error("config_rejected", reason=problem)
        if new is None:
            return
        if new.chosen is not self._filter:
            self._begin_again(new.chosen)
        self._coefficients = self._filter.coefficients(new.params)
        self._is_rate_checked = False
        self.log.info("config_applied", file=str(watch.path), changes=new.changes_from(old))
        if new.completed != old.completed:
            self._tell_completed(watch)

    def _tell_completed(self, watch: "ConfigWatch") -> None:
        """With which defaults."""
        if watch.config.completed:
            self.log.info("config_completed", file=str(watch.path), defaults=list(watch.config.completed))

    def _tell_gone(self, watch: "ConfigWatch") -> None:
        """Once, and once more when it is back."""
        if watch.is_gone and not self._is_gone:
            self.log.warning("config_gone", file=str(watch.path), hint="the last one that was valid stays")
        elif self._is_gone and not watch.is_gone:
            self.log.info("config_back", file=str(watch.path))
        self._is_gone = watch.is_gone

    def _begin_again(self, chosen: Filter) -> None:
        """Another filter knows nothing of this one's drift estimate, but goes on from the same yaw."""
        old, self._filter, self.state = self.state, chosen, chosen.state()
        self.state.yaw_deg, self.state.rejected = old.yaw_deg, old.rejected

    def _compare_rate(self, config: "Config") -> None:
        period_s = self.link.clock.period_s if self.link.clock else 0.0
        if not period_s:
            return
        self._is_rate_checked = True
        tuned_hz = config.sample_rate_hz
        if tuned_hz is not None and abs(period_s * tuned_hz - 1.0) > RATE_TOLERANCE:
            self.log.warning(
                "sample_rate_differs",
                tuned_at_hz=tuned_hz,
                stream_hz=round(1.0 / period_s, 3),
                hint=f"{self._filter.sample_counted} count samples: tune at the rate of this stream",
            )
