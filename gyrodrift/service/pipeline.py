"""The way of a sample through `serve`: calibration, filter on the axes of the device, zero and north, sinks.

`Pipeline.take` shows the whole way. `FilterRun` turns the axes of the sensor into those of the device, and steps the
filter on one axis or on three.
"""

from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field
from math import atan2, degrees, hypot, inf, isfinite, nan
from typing import TYPE_CHECKING, Any

from gyrodrift.filters.filter import Filter, FilterState, WitnessState
from gyrodrift.filters.gaps import CORRECTION_DEG
from gyrodrift.filters.registry import DEFAULT
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.filters.run import Axes, FilterRun
from gyrodrift.io.logger import FilteringBoundLogger
from gyrodrift.link.clocks.arrival import ArrivalClock
from gyrodrift.link.link import Link
from gyrodrift.service.calibrating import Calibrating, bias_of
from gyrodrift.service.history import STEPS_AT_ONCE, History, HistoryPart, SecondRun
from gyrodrift.service.listener import JudgedListener, ReaderGoneError, Sink
from gyrodrift.service.reference import DeviceReference, EncoderReference, SmoothYaw, YawReference
from gyrodrift.values.calibration import Calibration
from gyrodrift.values.mount import Mount, nearest_axis
from gyrodrift.values.sample import Corrected, Sample

if TYPE_CHECKING:  # the config loads its checker, which a service without a config does not need
    from gyrodrift.config.model import Config

REJECTED_S = CORRECTED_S = 1.0
"""Shortest time between two warnings of the same kind, s."""

REPLUG_S = 1.0
"""Shortest loss of a link without a device clock in which the device may have been switched off, s. Chosen: a person
needs more to replug it; a device clock shows a restart itself."""

AID_HINT = "it is left out until it agrees again; check its sign, unit, delay and name"

SIDEWAYS_DEG = 60.0
"""Tilt from which on another axis of the sensor points up: it is nearer to the vertical from 45° to 54.7° on, with a
margin. Derived: acos(1/√3)."""

WITHDRAWN_DEG = 180.0
"""Sigma of a yaw that is withdrawn, because its rates turned out to be another quantity: any heading is possible."""

NO_SAMPLE = Sample(0, nan, nan, nan)


@dataclass(slots=True)
class Pipeline(JudgedListener):
    """A filter with everything before and behind it.

    sinks
        Receivers of corrected samples. A sink with a closed reader is removed while another sink is wanted.
    config, source
        Config at the start, and its path; None and `defaults` without one. `ConfigFollower` applies later ones.
    chosen, axes
        Filter that runs at its defaults without a config, and axes that precede those of a config.
    event_listeners
        Called with the log events of filter and config.
    calibrating, run
        Calibration before the filter, and the running filter.
    reference, encoder, device
        Zero and north of yaw, and the angles of encoder and device from the same zero.
    smooth
        Yaw that takes corrections in at the `slew_dps` of the config.
    history
        Last samples, if parameters may change while the filter runs; they are then filtered again.
    last, raw_yaw_deg
        Last sample that the filter accepted, and the integral of the measured rate, deg.
    """

    link: Link
    sinks: list[Sink]
    log: FilteringBoundLogger
    config: "Config | None" = None
    source: str = "defaults"
    chosen: Filter = DEFAULT
    axes: Axes | None = None
    event_listeners: list[Callable[[str, dict[str, Any]], Any]] = field(default_factory=list)
    calibrating: Calibrating = field(init=False)
    params: Any = field(init=False)
    run: FilterRun = field(init=False)
    reference: YawReference = field(default_factory=YawReference)
    encoder: EncoderReference = field(default_factory=EncoderReference)
    device: DeviceReference = field(default_factory=DeviceReference)
    smooth: SmoothYaw = field(default_factory=SmoothYaw)
    history: History | None = None
    last: Sample | None = None
    raw_yaw_deg: float = 0.0
    _second: SecondRun | None = None
    _step_deg: float = 0.0
    _scaled_by: Calibration | None = None
    _rejected: int = 0
    _rejected_s: float = 0.0
    _refuted: int = 0
    _slew_dps: float | None = None
    _restarts: int = 0
    _steps_deg: list[float] = field(default_factory=list)
    _corrected_s: float = -inf
    _device_id: str = ""
    _is_one_axis_told: bool = False
    _has_aids: bool = False
    _differing: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        config = self.config
        chosen, self.params = (self.chosen, self.chosen.params()) if config is None else (config.chosen, config.params)
        self.calibrating = Calibrating(self.link, self.log, self.tell, None if config is None else config.calibration)
        self.run = FilterRun(chosen, self.params, self.axes or "auto")
        self._set_coefficients()
        self.log.info("filter_chosen", name=chosen.name, parameters=self.source)
        if config is not None:
            self._slew_dps = config.slew_dps
            self._use_axes(self.axes or config.axes, config.mount)

    def take(self, samples: list[Sample]) -> None:
        """Calibrate and filter samples, and hand the corrected ones to the sinks."""
        calibrated = self.calibrating.take(samples, bias_of(self.run.state))
        if self.calibrating.applied is not self._scaled_by:
            self._set_coefficients()
        second = self._second
        if second is not None and second.catch_up(max(STEPS_AT_ONCE, 2 * len(calibrated))):
            self._use_second(second)
        had_axes, step, corrected = self.run.three_axes is not None, self.run.step, []
        for sample in calibrated:
            part = None if self.history is None else self.history.expect(self.run, sample)
            if step(sample.t_device_s, sample.rate_dps, sample.inertial, sample.still, sample.temp_c):
                corrected.append(self._accepted(sample, part))
        if calibrated:
            self._tell_axes(calibrated, had_axes=had_axes)
        for sink in tuple(self.sinks):
            try:
                sink.take(corrected)
            except ReaderGoneError:
                self._forget(sink)

    def tick(self, now_s: float) -> None:
        """Let the sinks go on, and warn of rejected samples and of a wrong witness of rest."""
        for sink in tuple(self.sinks):
            try:
                sink.tick(now_s)
            except ReaderGoneError:
                self._forget(sink)
        rejected = self.state.rejected - self.link.counters.unmeasured
        if rejected > self._rejected and now_s - self._rejected_s >= REJECTED_S:
            self.warn("samples_rejected", count=rejected - self._rejected, total=rejected)
            self._rejected, self._rejected_s = rejected, now_s
        witness = self.witness
        if witness is not None and witness.refuted > self._refuted:
            self._refuted = witness.refuted
            hint = "it reported rest during a turn; it is ignored until it reports motion"
            self.warn("witness_refuted", count=witness.refuted, hint=hint)
        self._tell_corrections(now_s)
        self._tell_aids()

    def stats(self) -> dict[str, Any]:
        """Counters and values for the log."""
        of_sinks = {name: value for sink in self.sinks for name, value in sink.stats().items()}
        yaw_deg, bias_dps = round(self.yaw_deg, 3), round(self.state.bias_dps, 5)
        return {"rejected": self.state.rejected, **of_sinks, "yaw_deg": yaw_deg, "bias_dps": bias_dps}

    def close(self) -> None:
        """Close all sinks at the same time; a failing sink does not keep the others open."""
        with ExitStack() as closing:
            for sink in self.sinks:
                sink.finish()
                closing.callback(sink.close)

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
    def yaw_deg(self) -> float:
        """Yaw of the output, deg."""
        return float(self.run.state.yaw_deg) - self.reference.zero_deg

    @property
    def witness(self) -> WitnessState | None:
        """Witness of rest of the filter; None for a filter without one."""
        return getattr(self.state, "witness", None) if self.filter.uses_auxiliary else None

    def now(self) -> Corrected:
        """The last sample with the present state, after a zero or a heading too; without the encoder."""
        last = (self.last or NO_SAMPLE)._replace(encoder_deg=nan, device_yaw=None)
        return self._corrected(last)._replace(sample=last._replace(device_yaw=self.device.last))

    def begin_with(self, state: FilterState) -> None:
        """Start the filter with this state; before its first sample."""
        self.run.state = state

    def hear(self, event: str, fields: Mapping[str, Any]) -> None:
        """Tell the filter that the device has restarted, was replugged or is another one.

        The device's own yaw begins at 0 after a restart, and is aligned again. Withdrawn yaw is marked.
        """
        match event:
            case "device_reset":
                self.device.align()
                self._restart(fields["gone_s"])
            case "link_restored" if isinstance(self.link.clock, ArrivalClock) and fields["gone_s"] >= REPLUG_S:
                self._restart(fields["gone_s"])
            case "device":
                if self._device_id not in {"", fields["device_id"]}:
                    self._restart()
                self._device_id = fields["device_id"]
            case "verdict_withdrawn" if self.last is not None:
                withdrawn = self.now()._replace(yaw_sigma_deg=WITHDRAWN_DEG, confidence=0.0)
                for sink in tuple(self.sinks):
                    sink.take([withdrawn])

    def zero(self) -> None:
        """Set yaw and its sigma to 0 at the last sample."""
        self._forget_history()
        self.run.zero()
        self.reference.zero(self.run.state.yaw_deg, self.raw_yaw_deg)
        self.smooth.behind_deg = 0.0
        self.encoder.align()
        self.device.align()

    def set_heading(self, heading_deg: float) -> None:
        """Set the compass heading, deg clockwise from north."""
        self._forget_history()
        self.reference.set_heading(self.state.yaw_deg, heading_deg)

    def use(self, config: "Config") -> None:
        """Go on with another config; the history is filtered again, and until then another filter has no bias."""
        is_other = (config.chosen, config.params) != (self.filter, self.params)
        if config.chosen is not self.filter:
            self._begin_again(config.chosen)
        self.calibrating.follow(config.calibration, bias_of(self.state))
        self.params, self._slew_dps = config.params, config.slew_dps
        self._use_axes(self.axes or config.axes, config.mount)
        self._set_coefficients()
        if is_other:
            self._begin_second()

    def tell(self, event: str, fields: dict[str, Any]) -> None:
        """Tell the listeners of an event."""
        for listener in self.event_listeners:
            listener(event, fields)

    def warn(self, event: str, **fields: Any) -> None:
        """Log a warning, and tell the listeners."""
        self.log.warning(event, **fields)
        self.tell(event, fields)

    def _accepted(self, sample: Sample, part: HistoryPart | None) -> Corrected:
        """Result of an accepted sample, whose second sources the filter hears first."""
        for aid in sample.aids:
            self.run.aid(aid)
            self._has_aids = True
        if (last := self.last) is not None:
            step_s = sample.t_device_s - last.t_device_s
            self.raw_yaw_deg += 0.5 * (sample.rate_dps + last.rate_dps) * step_s
            self._follow_corrections(step_s)
        if part is not None:
            part.keep(sample)
        self.last, corrected = sample, self._corrected(sample)
        self._step_deg = 0.0
        return corrected

    def _corrected(self, sample: Sample) -> Corrected:
        run, state, reference = self.run, self.run.state, self.reference
        bias_dps, yaw_deg = state.bias_dps, state.yaw_deg
        zeroed_deg = yaw_deg - reference.zero_deg
        has_axes = run.three_axes is not None
        return Corrected(
            sample,
            (state.heading_rate_dps if has_axes else sample.rate_dps) - bias_dps,
            zeroed_deg,
            bias_dps,
            state.yaw_sigma_deg,
            state.confidence,
            state.bias_sigma_dps,
            state.rest_probability,
            self.raw_yaw_deg - reference.raw_zero_deg,
            reference.heading_deg(yaw_deg) if reference.has_north else nan,
            self.encoder.angle_deg(sample.encoder_deg, zeroed_deg),
            run.attitude(-reference.zero_deg) if has_axes else None,
            self.device.take(sample.device_yaw, zeroed_deg),
            self._correction_deg,
            run.corrections,
            nan if self._slew_dps is None else zeroed_deg - self.smooth.behind_deg,
            run.aids if self._has_aids else None,
        )

    @property
    def _correction_deg(self) -> float:
        """Step of yaw in the last sample that is no motion, deg, by the filter and by its second run."""
        return self.run.correction_deg + self._step_deg

    def _restart(self, gone_s: float | None = None) -> None:
        """Tell the filter that the device has restarted, after a gap of this length if it is known, s."""
        self._forget_history()
        self.run.gap(gone_s, has_restarted=True)

    def _forget_history(self) -> None:
        """Keep no sample before the next one, and end a second run over them."""
        self._second = None
        if self.history is not None:
            self.history.forget()

    def _begin_second(self) -> None:
        """Filter the history again, unless the same filter keeps nothing but its present state."""
        part, self._second = None if self.history is None else self.history.oldest, None
        if part is None:
            return
        if part.beginning.filter is not self.filter or hasattr(self.state, "correction_deg"):
            self._second = SecondRun(part, self.filter, self.run.params, self.run.axes_params)

    def _use_second(self, second: SecondRun) -> None:
        """Go on with the second run, which has caught up.

        The step of yaw counts as a correction. Yaw of another filter has no step: it goes on from the present one.
        """
        old, self.run, self._second = self.run, second.run, None
        step_deg = self.state.yaw_deg - old.state.yaw_deg
        if second.is_other:
            self.reference.shift(step_deg)
        else:
            self._step_deg = step_deg
        self.state.rejected, self._restarts = old.state.rejected, self.run.restarts
        if hasattr(self.state, "corrections"):
            self.state.corrections = old.corrections + (abs(self._step_deg) > CORRECTION_DEG)
        self._refuted = 0 if self.witness is None else self.witness.refuted
        seconds = 0.0 if self.last is None else self.last.t_device_s - second.begun_s
        fields = {"seconds": round(seconds, 1), "step_deg": round(self._step_deg, 3)}
        self.log.info("history_filtered", **fields)
        self.tell("history_filtered", fields)

    def _follow_corrections(self, step_s: float) -> None:
        """Note the correction of the last sample, `step_s` after the one before."""
        correction_deg = self._correction_deg
        if abs(correction_deg) > CORRECTION_DEG:
            self._steps_deg.append(correction_deg)
        if self._slew_dps is not None:
            self.smooth.follow(correction_deg, step_s, self._slew_dps)

    def _tell_corrections(self, now_s: float) -> None:
        """Warn of large corrections, at most once a second, and of a bias that is unknown again."""
        if self._steps_deg and now_s - self._corrected_s >= CORRECTED_S:
            largest_deg, count = max(self._steps_deg, key=abs), len(self._steps_deg)
            self.warn("yaw_corrected", step_deg=round(largest_deg, 3), count=count, total=self.run.corrections)
            self._steps_deg, self._corrected_s = [], now_s
        if self.run.restarts > self._restarts:
            hint = "the device may have restarted: yaw drifts until it has been at rest for some seconds"
            self.warn("bias_reopened", count=self.run.restarts, hint=hint)
        self._restarts = self.run.restarts

    def _tell_aids(self) -> None:
        """Warn once of each second source that begins to contradict the filter."""
        differing = {name: status.differs for name, status in self.run.aids.items() if status.differs}
        for name in differing.keys() - self._differing.keys():
            self.warn("aid_differs", name=name, reason=differing[name], hint=AID_HINT)
        self._differing = differing

    def _set_coefficients(self) -> None:
        """Work out the coefficients, with the scale error that the calibration in force leaves."""
        applied = self.calibrating.applied
        if applied is not self._scaled_by:
            self._forget_history()
        self._scaled_by = applied
        sigma, axes_sigma = (None, None) if applied is None else (applied.scale_sigma, applied.axes_scale_sigma)
        self.run.use(self.filter.scaled(self.params, sigma), self.filter.scaled(self.params, axes_sigma))

    def _use_axes(self, axes: Axes, mount: Mount) -> None:
        """Set axes and mount; a filter of three axes starts again if they differ."""
        is_same = (axes, mount) == (self.run.axes, self.run.mount)
        self.run.axes, self.run.mount = axes, mount
        if self.run.three_axes is not None and not is_same:
            self._forget_history()
            self._begin_again(self.filter)

    def _begin_again(self, chosen: Filter) -> None:
        """Start another filter at the present yaw; the bias estimate of the old filter is dropped."""
        old, self._refuted = self.state, 0
        self.run = FilterRun(chosen, chosen.params(), self.run.axes, self.run.mount)
        self.state.yaw_deg, self.state.rejected = old.yaw_deg, old.rejected
        if chosen is RESTLEVEL and isfinite(old.yaw_sigma_deg):  # three axes go on from it
            self.run.state.yaw_sigma_deg = old.yaw_sigma_deg

    def _tell_axes(self, samples: list[Sample], *, had_axes: bool) -> None:
        """Report three axes, and warn once of a device that has not those that the user states."""
        has_axes = self.run.three_axes is not None
        if has_axes and not had_axes:
            self.log.info("three_axes", filter=self.filter.name, hint="the device sends three rates and accelerations")
            self.tell("three_axes", {"filter": self.filter.name})
            self._compare_mount(samples)
        if self.run.axes == "3" and not (has_axes or samples[-1].inertial or self._is_one_axis_told):
            self._is_one_axis_told = True
            hint = "the device sends one rate: axes 3 has no effect, and yaw is right while this axis is vertical"
            self.warn("axes_missing", hint=hint)

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
        if tilt_deg >= SIDEWAYS_DEG:
            hint = f"if the device was level then, set mount: {{up: {nearest_axis(first)}, forward: ...}} in the config"
            self.warn("mount_differs", up=self.run.mount.up, tilt_deg=round(tilt_deg, 1), hint=hint)

    def _forget(self, sink: Sink) -> None:
        """Continue without a sink whose reader is closed, unless no other sink is wanted."""
        remaining = [candidate for candidate in self.sinks if candidate is not sink]
        if not any(candidate.is_wanted for candidate in remaining):
            raise ReaderGoneError
        self.log.info("reader_gone")
        self.sinks.remove(sink)
