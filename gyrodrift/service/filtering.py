"""The filter of `serve`: it hands corrected samples to the sinks, and applies a new config between two samples."""

import time
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import partial
from math import atan2, degrees, hypot, isfinite
from typing import TYPE_CHECKING, Any

from gyrodrift.filters.filter import Filter, FilterState, WitnessState
from gyrodrift.filters.registry import DEFAULT
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.filters.run import Axes, FilterRun
from gyrodrift.io.logger import FilteringBoundLogger
from gyrodrift.link.link import Link
from gyrodrift.service.calibrating import Calibrating, bias_of
from gyrodrift.service.correcting import Correcting
from gyrodrift.service.sink import ReaderGoneError, Sink
from gyrodrift.values.calibration import Calibration
from gyrodrift.values.errors import ConfigError
from gyrodrift.values.mount import nearest_axis
from gyrodrift.values.sample import Corrected, Sample

if TYPE_CHECKING:  # the config loads its checker, which a service without a config does not need
    from gyrodrift.config.model import Config
    from gyrodrift.config.watch import ConfigWatch

REJECTED_S = 1.0

SIDEWAYS_DEG = 60.0
"""Tilt from which on another axis of the sensor points up: it is nearer to the vertical from 45° to 54.7° on, with a
margin. Derived: acos(1/√3)."""

RATE_TOLERANCE = 0.05
"""Largest relative difference between the sample rate and the one that the parameters were tuned at."""


@dataclass(slots=True)
class Filtering:
    """Filters samples and hands the corrected samples to the sinks.

    sinks
        Receivers of corrected samples. A sink with a closed reader is removed while another sink is wanted.
    chosen
        Filter that runs at its defaults without a config.
    config_listeners
        Called with each new config.
    event_listeners
        Called with the log events of filter and config.
    axes
        Axes of the filter; None for those of the config.
    correcting
        The running filter and what it makes of a sample.
    calibrating
        Applies the calibration before the filter.
    applied, refused, applied_s
        Number of configs that were applied and refused since the start; Unix time of the last one applied, s.
    """

    link: Link
    sinks: list[Sink]
    log: FilteringBoundLogger
    watch: "ConfigWatch | None" = None
    config_listeners: "list[Callable[[Config], Any]]" = field(default_factory=list)
    event_listeners: list[Callable[[str, dict[str, Any]], Any]] = field(default_factory=list)
    chosen: Filter = DEFAULT
    axes: Axes | None = None
    correcting: Correcting = field(init=False)
    calibrating: Calibrating = field(init=False)
    params: Any = field(init=False)
    _scaled_by: Calibration | None = None
    _rejected: int = 0
    _rejected_s: float = 0.0
    _is_rate_checked: bool = False
    _is_one_axis_told: bool = False
    applied: int = 0
    refused: int = 0
    applied_s: float | None = None
    _is_gone: bool = False
    _refuted: int = 0
    _outcome: "list[str] | ConfigError" = field(default_factory=list)

    def __post_init__(self) -> None:
        given = self.watch.config.calibration if self.watch is not None else None
        self.calibrating = Calibrating(self.link, self.log, self._tell, given)
        chosen, self.params, source = self.chosen, self.chosen.params(), "defaults"
        if self.watch is not None:
            config = self.watch.config
            chosen, self.params, source = config.chosen, config.params, str(self.watch.path)
        self.correcting = Correcting(FilterRun(chosen, self.params, self.axes or "auto"))
        self._set_coefficients()
        self.log.info("filter_chosen", name=chosen.name, parameters=source)
        if self.watch is not None:
            self._follow_axes(self.watch.config)
            self._tell_completed(self.watch)

    def take(self, samples: list[Sample]) -> None:
        """Filter samples and hand them to the sinks."""
        calibrated = self.calibrating.take(samples, bias_of(self.state))
        if self.calibrating.applied is not self._scaled_by:
            self._set_coefficients()
        corrected = self._corrected(calibrated) if samples else []
        for sink in tuple(self.sinks):
            try:
                sink.take(corrected)
            except ReaderGoneError:
                self._forget(sink)

    def tick(self, now_s: float) -> None:
        """Follow the config, and warn of rejected samples."""
        for sink in tuple(self.sinks):
            try:
                sink.tick(now_s)
            except ReaderGoneError:
                self._forget(sink)
        if self.watch is not None:
            self._follow_config(self.watch)
        if self.state.rejected > self._rejected and now_s - self._rejected_s >= REJECTED_S:
            fields = {"count": self.state.rejected - self._rejected, "total": self.state.rejected}
            self.log.warning("samples_rejected", **fields)
            self._tell("samples_rejected", fields)
            self._rejected, self._rejected_s = self.state.rejected, now_s
        self._tell_refuted()
        if not self._is_rate_checked and self.watch is not None and self.filter.counts_samples:
            self._compare_rate(self.watch.config)

    def stats(self) -> dict[str, Any]:
        """Counters and values for the log."""
        of_sinks = {name: value for sink in self.sinks for name, value in sink.stats().items()}
        yaw_deg, bias_dps = round(self.yaw_deg, 3), round(self.state.bias_dps, 5)
        return {"rejected": self.state.rejected, **of_sinks, "yaw_deg": yaw_deg, "bias_dps": bias_dps}

    def close(self) -> None:
        """Close all sinks at the same time; a failing sink does not keep the others open."""
        with ExitStack() as closing:
            if self.watch is not None:
                closing.callback(self.watch.close)
            for sink in self.sinks:
                sink.finish()
                closing.callback(sink.close)

    @property
    def run(self) -> FilterRun:
        """The running filter."""
        return self.correcting.run

    @property
    def filter(self) -> Filter:
        """The record of the running filter."""
        return self.run.filter

    @property
    def state(self) -> FilterState:
        """State of the running filter."""
        state: FilterState = self.run.state
        return state

    @property
    def last(self) -> Sample | None:
        """Last sample that the filter accepted."""
        return self.correcting.last

    @property
    def yaw_deg(self) -> float:
        """Yaw of the output, deg."""
        return self.correcting.yaw_deg

    @property
    def scale_sigma_deg(self) -> float:
        """Share of the yaw sigma from the scale factor, deg; NaN for a filter that does not state it."""
        return self.run.scale_sigma_deg

    @property
    def witness(self) -> WitnessState | None:
        """Witness of rest of the filter; None for a filter without one."""
        return getattr(self.state, "witness", None) if self.filter.uses_auxiliary else None

    def begin_with(self, state: FilterState) -> None:
        """Start the filter with this state; before its first sample."""
        self.run.state = state

    def hear(self, event: str, _fields: Mapping[str, Any]) -> None:
        """Align yaw with the device's own yaw again after the device has restarted, where that begins at 0."""
        if event == "device_reset":
            self.correcting.device.align()

    def zero(self) -> None:
        """Set yaw and its sigma to 0 at the last sample."""
        self.correcting.zero()

    def set_heading(self, heading_deg: float) -> None:
        """Set the compass heading, deg clockwise from north."""
        self.correcting.reference.set_heading(self.state.yaw_deg, heading_deg)

    def _set_coefficients(self) -> None:
        """Work out the coefficients, with the scale error that the calibration in force leaves."""
        self._scaled_by = applied = self.calibrating.applied
        sigma, axes_sigma = (None, None) if applied is None else (applied.scale_sigma, applied.axes_scale_sigma)
        self.run.use(self.filter.scaled(self.params, sigma), self.filter.scaled(self.params, axes_sigma))

    def _corrected(self, samples: list[Sample]) -> list[Corrected]:
        had_axes = self.run.three_axes is not None
        corrected = self.correcting.take(samples)
        if not had_axes and self.run.three_axes is not None:
            self.log.info("three_axes", filter=self.filter.name, hint="the device sends three rates and accelerations")
            self._tell("three_axes", {"filter": self.filter.name})
            self._compare_mount(samples)
        if self.run.axes == "3" and samples[-1].inertial is None and self.run.three_axes is None:
            self._tell_one_axis()
        return corrected

    def _tell_one_axis(self) -> None:
        """Warn once that the device has not the three axes that the user states."""
        if not self._is_one_axis_told:
            self._is_one_axis_told = True
            hint = "the device sends one rate: axes 3 has no effect, and yaw is right while this axis is vertical"
            self.log.warning("axes_missing", hint=hint)
            self._tell("axes_missing", {"hint": hint})

    def _compare_mount(self, samples: list[Sample]) -> None:
        """Warn of a device that begins on its side or upside down, as a sensor with another mount does.

        The first sample counts: many may come at once, and the device may turn meanwhile.
        """
        forces = (sample.inertial[3:] for sample in samples if sample.inertial and self.run.has_axes(sample.inertial))
        first = next((force for force in forces if isfinite(sum(force))), None)
        if first is None:
            return
        x, y, z = self.run.mount.to_device(first)
        tilt_deg = degrees(atan2(hypot(x, y), z))
        if tilt_deg < SIDEWAYS_DEG:
            return
        hint = f"if the device was level then, set mount: {{up: {nearest_axis(first)}, forward: ...}} in the config"
        fields = {"up": self.run.mount.up, "tilt_deg": round(tilt_deg, 1), "hint": hint}
        self.log.warning("mount_differs", **fields)
        self._tell("mount_differs", fields)

    def _follow_axes(self, config: "Config") -> None:
        """Apply the axes and the mount of a config; `--axes` takes precedence. A filter of three axes starts again."""
        axes = self.axes or config.axes
        is_same = (axes, config.mount) == (self.run.axes, self.run.mount)
        self.run.axes, self.run.mount = axes, config.mount
        if self.run.three_axes is not None and not is_same:
            self._begin_again(self.filter)

    def _forget(self, sink: Sink) -> None:
        """Continue without a sink whose reader is closed, unless no other sink is wanted."""
        remaining = [candidate for candidate in self.sinks if candidate is not sink]
        if not any(candidate.is_wanted for candidate in remaining):
            raise ReaderGoneError
        self.log.info("reader_gone")
        self.sinks.remove(sink)

    def _tell(self, event: str, fields: dict[str, Any]) -> None:
        for listener in self.event_listeners:
            listener(event, fields)

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

    def _tell_refuted(self) -> None:
        """Warn of a witness of rest that the rate has contradicted."""
        witness = self.witness
        if witness is None or witness.refuted <= self._refuted:
            return
        self._refuted = witness.refuted
        fields = {
            "count": witness.refuted,
            "hint": "it reported rest during a turn; it is ignored until it reports motion",
        }
        self.log.warning("witness_refuted", **fields)
        self._tell("witness_refuted", fields)

    def _follow_config(self, watch: "ConfigWatch") -> None:
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
            self.log.error("config_rejected", reason=problem)
        self._tell("config_rejected", {"reasons": list(error.problems)})

    def _apply(self, watch: "ConfigWatch", old: "Config", new: "Config") -> list[str]:
        if new.chosen is not self.filter:
            self._begin_again(new.chosen)
        self.calibrating.follow(new.calibration, bias_of(self.state))
        self.params = new.params
        self._follow_axes(new)
        self._set_coefficients()
        self._is_rate_checked = False
        self.applied, self.applied_s = self.applied + 1, time.time()
        changes = new.changes_from(old)
        fields = {"file": str(watch.path), "changes": changes}
        self.log.info("config_applied", **fields)
        self._tell("config_applied", fields)
        if new.completed != old.completed:
            self._tell_completed(watch)
        for listener in self.config_listeners:
            listener(new)
        return changes

    def _tell_completed(self, watch: "ConfigWatch") -> None:
        """Log the defaults in use."""
        if watch.config.completed:
            self.log.info("config_completed", file=str(watch.path), defaults=list(watch.config.completed))

    def _tell_gone(self, watch: "ConfigWatch") -> None:
        """Warn of a missing config file once, and log its return."""
        if watch.is_gone and not self._is_gone:
            self.log.warning("config_gone", file=str(watch.path), hint="the last valid config stays")
            self._tell("config_gone", {"file": str(watch.path)})
        elif self._is_gone and not watch.is_gone:
            self.log.info("config_back", file=str(watch.path))
            self._tell("config_back", {"file": str(watch.path)})
        self._is_gone = watch.is_gone

    def _begin_again(self, chosen: Filter) -> None:
        """Start another filter at the present yaw; the bias estimate of the old filter is dropped."""
        old, self._refuted = self.state, 0
        self.correcting.run = FilterRun(chosen, chosen.params(), self.run.axes, self.run.mount)
        self.state.yaw_deg, self.state.rejected = old.yaw_deg, old.rejected
        if chosen is RESTLEVEL and isfinite(old.yaw_sigma_deg):  # three axes go on from it
            self.run.state.yaw_sigma_deg = old.yaw_sigma_deg

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
                hint=f"{self.filter.sample_counted} count samples; tune at the rate of this stream",
            )
