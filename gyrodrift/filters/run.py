"""A filter over samples in their order, on one axis or on three.

The step of one axis is called as it is, so a device of one axis gets the same bits as from the step itself. The package
of three axes is imported when the first sample with three axes arrives.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from math import inf, isfinite, isnan, nan
from typing import TYPE_CHECKING, Any, Literal, get_args

from gyrodrift.filters.filter import Filter
from gyrodrift.filters.gaps import UNKNOWN_S, GapWatch, count_correction, count_gap, expect_gap, longest_step_s
from gyrodrift.values.aid import Aid, AidStatus
from gyrodrift.values.mount import LEVEL, Mount
from gyrodrift.values.quaternion import with_heading
from gyrodrift.values.sample import Attitude, Inertial

if TYPE_CHECKING:
    from gyrodrift.filters.aids.follow import Aids
    from gyrodrift.filters.three_axes import ThreeAxisFilter

Axes = Literal["auto", "1", "3"]
"""Axes of a filter: three where the device sends three rates and accelerations, only z, or always all three."""

AXES: tuple[Axes, ...] = get_args(Axes)

WITHOUT_AXES_S = 2.0
"""Time in which a device of three axes sent one rate, after which it counts as one of one axis, s. Chosen: lost frames
leave less."""


@dataclass(slots=True)
class FilterRun:
    """A filter with its state; it goes over to three axes with the first sample that has them.

    It goes back to one axis if the device sends one rate for `WITHOUT_AXES_S`: another device may be plugged in.

    filter, params
        The filter and its parameters.
    axes_params
        Parameters on three axes; those of one axis unless `use` gives others.
    axes
        `auto` needs accelerations; `3` also takes three rates without them.
    mount
        Axes of the sensor on the device. On three axes the filter runs in the frame of the device, and yaw is its
        heading.
    state
        State after the last sample; that of three axes has the attributes of `three_axes.ThreeAxisState` too.
    three_axes
        The three-axis version in use; None on one axis.
    watch
        Limit that tells a gap from a step for a filter that does not itself.
    """

    filter: Filter
    params: Any
    axes: Axes = "auto"
    mount: Mount = LEVEL
    state: Any = field(init=False)
    three_axes: "ThreeAxisFilter | None" = field(init=False, default=None)
    axes_params: Any = field(init=False)
    _coefficients: Any = field(init=False)
    _step: Any = field(init=False)
    watch: GapWatch = field(init=False, default_factory=GapWatch)
    _axes_t_s: float = -inf
    _t_s: float = nan
    _aids: "Aids | None" = None

    def __post_init__(self) -> None:
        self.state = self.filter.state()
        self._step = self.filter.step_auxiliary if hasattr(self.state, "watch") else self._holding_step
        self.axes_params, self._coefficients = self.params, self.filter.coefficients(self.params)

    def step(
        self, t_s: float, rate_dps: float, inertial: Inertial | None = None, still: float = nan, temp_c: float = nan
    ) -> bool:
        """Take a sample; False if it is rejected. Time without samples that are taken is a gap."""
        if self._aids is None:
            return self._step_axes(t_s, rate_dps, inertial, still, temp_c)
        return self._step_aided(self._aids, t_s, rate_dps, inertial, still, temp_c)

    def _step_aided(
        self, aids: "Aids", t_s: float, rate_dps: float, inertial: Inertial | None, still: float, temp_c: float
    ) -> bool:
        """Take a sample, and what second sources have measured up to it."""
        still = aids.still(t_s) if isnan(still) else still
        had_axes, scale = self.three_axes is not None, 0.0 if self.three_axes else aids.scale.mean
        is_accepted = self._step_axes(t_s, (1.0 + scale) * rate_dps, inertial, still, temp_c)
        if had_axes != (self.three_axes is not None):
            aids.plain = None
        if aids.plain is not None:
            aided_state, self.state = self.state, aids.plain
            self._step_axes(t_s, (1.0 + aids.plain_scale) * rate_dps, inertial, still, temp_c)
            aids.plain, self.state = self.state, aided_state
        if is_accepted:
            aids.follow((self.three_axes or self.filter).aided, self._coefficients, self.state, t_s)
            if aids.is_contradicted:
                self._go_on_plain(aids)
        return is_accepted

    def _go_on_plain(self, aids: "Aids") -> None:
        """Go on with the state without the sources, one of which has misled the filter."""
        step_deg, corrections = aids.plain.yaw_deg - self.state.yaw_deg, self.state.corrections
        self.state = aids.plain
        self.state.corrections = corrections
        count_correction(self.state, step_deg)
        aids.forget()

    def _step_axes(self, t_s: float, rate_dps: float, inertial: Inertial | None, still: float, temp_c: float) -> bool:
        if inertial is not None:
            self._axes_t_s = t_s
        elif self.three_axes is not None and t_s - self._axes_t_s > WITHOUT_AXES_S:
            self._go_back()
        if self.three_axes is None:
            if not self.has_axes(inertial):
                return bool(self._step(self._coefficients, self.state, t_s, rate_dps, still, temp_c))
            self._go_over()
        given = Inertial(0.0, 0.0, rate_dps) if inertial is None else inertial
        if self.mount != LEVEL:
            given = Inertial(*self.mount.to_device(given[:3]), *self.mount.to_device(given[3:]))
        return self.three_axes.step(self._coefficients, self.state, t_s, given, still, temp_c)  # type: ignore[union-attr]

    def gap(self, seconds: float | None = None, *, has_restarted: bool = False) -> None:
        """Take the next step as a gap, whatever the times are; with a restart the bias is in doubt, too.

        seconds
            Length of the gap, s, if the times do not show it; None if it is unknown.
        """
        if self.state.samples > 0:
            told_s = UNKNOWN_S if seconds is None else seconds
            expect_gap(self._gap_watch, told_s, has_restarted=has_restarted)
            if self._aids is not None and self._aids.plain is not None:
                expect_gap(self._aids.plain.watch, told_s, has_restarted=has_restarted)

    def aid(self, aid: Aid) -> None:
        """Take a measurement of a second source; a filter without uncertainty takes only `standing` and `speed`."""
        if self._aids is None:
            from gyrodrift.filters.aids.follow import Aids  # noqa: PLC0415 - few devices have a second source

            self._aids = Aids()
            if self.state.samples > 0:  # it knows the time of the last sample
                aided = (self.three_axes or self.filter).aided
                self._aids.follow(aided, self._coefficients, self.state, self.state.t_s)
        self._aids.take(aid)

    @property
    def aids(self) -> dict[str, AidStatus]:
        """How each second source agrees with the filter, by its name."""
        return {} if self._aids is None else self._aids.status

    @property
    def gaps(self) -> int:
        """Number of gaps so far."""
        return self._gap_watch.gaps

    @property
    def restarts(self) -> int:
        """Number of gaps so far after which the bias is in doubt."""
        return self._gap_watch.restarts

    @property
    def correction_deg(self) -> float:
        """Step of yaw in the last sample that is no motion, deg; 0 for a filter that does not change its mind."""
        return float(getattr(self.state, "correction_deg", 0.0))

    @property
    def corrections(self) -> int:
        """Number of corrections over 1 deg."""
        return int(getattr(self.state, "corrections", 0))

    def use(self, params: Any, axes_params: Any = None) -> None:
        """Go on with other parameters; `axes_params` are those on three axes if they differ."""
        self.params, self.axes_params = params, params if axes_params is None else axes_params
        if self.three_axes is None:
            self._coefficients = self.filter.coefficients(self.params)
        else:
            self._coefficients = self.three_axes.coefficients(self.axes_params)

    def attitude(self, turn_deg: float = 0.0) -> Attitude:
        """Attitude on three axes, after a further turn about the vertical."""
        state, mount = self.state, self.mount
        q, biases_dps = with_heading(state.q, turn_deg), state.bias_xyz_dps
        if mount != LEVEL:
            q, biases_dps = mount.sensor_attitude(q), mount.to_sensor(biases_dps)
        roll_deg, pitch_deg = mount.roll_pitch_deg(q)
        return Attitude(*q, mount.tilt_deg(q), roll_deg, pitch_deg, state.tilt_sigma_deg, *biases_dps)

    def zero(self) -> None:
        """Set the yaw sigma to 0 at the last sample."""
        (self.three_axes or self.filter).zero(self.state)

    @property
    def learner(self) -> Callable[[Any, float], Any] | None:
        """Function from earlier knowledge of the sensor and its age in s to the present one; None without a memory.

        Knowledge of three axes is in the frame of the sensor, whatever the mount.
        """
        of_three, of_one = self.three_axes, self.filter.memory
        if of_three is not None and of_three.learned is not None:
            return partial(of_three.learned, self.state, self.mount)
        return partial(of_one.learned, self.state) if of_three is None and of_one is not None else None

    @property
    def scale_sigma_deg(self) -> float:
        """Share of the yaw sigma from the scale factor, deg; NaN for a filter that does not state it."""
        return nan if self.three_axes else self.filter.scale_sigma_deg(self._coefficients, self.state)

    def has_axes(self, inertial: Inertial | None) -> bool:
        """Whether this sample makes the filter go over to three axes."""
        if inertial is None:
            return False
        if self.axes == "auto":
            return isfinite(inertial.accel_x_mps2 + inertial.accel_y_mps2 + inertial.accel_z_mps2)
        return self.axes == "3"

    @property
    def _gap_watch(self) -> GapWatch:
        watch: GapWatch = getattr(self.state, "watch", self.watch)
        return watch

    def _holding_step(self, c: Any, s: Any, t_s: float, rate_dps: float, still: float, temp_c: float) -> bool:
        """Step of a filter without a rule for gaps: it holds yaw over a gap, and begins again at a restart."""
        watch, yaw_deg, step_s = self.watch, s.yaw_deg, t_s - self._t_s
        if watch.has_restarted:
            rejected, s = s.rejected, self.filter.state()
            self.state, s.yaw_deg, s.rejected = s, yaw_deg, rejected
        is_gap = step_s > watch.longest_step_s or watch.has_restarted
        if not self.filter.step_auxiliary(c, s, t_s, rate_dps, still, temp_c):
            return False
        if is_gap:
            count_gap(watch, step_s)
            s.yaw_deg = yaw_deg
        elif s.samples > 1:
            watch.longest_step_s = longest_step_s(step_s)
        self._t_s = t_s
        return True

    def _go_over(self) -> None:
        from gyrodrift.filters.three_axes import three_axis_version

        self.three_axes = three_axis_version(self.filter)
        self.state = self.three_axes.state(self.state, self.mount)
        self.use(self.params, self.axes_params)

    def _go_back(self) -> None:
        old, self.three_axes, self.state = self.state, None, self.filter.state()
        self.state.yaw_deg, self.state.rejected = old.yaw_deg, old.rejected
        self.use(self.params, self.axes_params)
