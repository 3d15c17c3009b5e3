"""The three-axis version of each filter, for devices that send three rates and accelerations.

restlevel has its own: the attitude filter, with the same parameters. Any other filter of one axis runs on the rate of
the heading, which the attitude filter takes from rates and tilt.
"""

from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, field
from typing import Any, Protocol

from gyrodrift.filters.aids.reading import AidedFilter
from gyrodrift.filters.attitude.aided import AIDED
from gyrodrift.filters.attitude.block import RAD
from gyrodrift.filters.attitude.model import AttitudeState
from gyrodrift.filters.attitude.step import coefficients as attitude_coefficients
from gyrodrift.filters.attitude.step import step as attitude_step
from gyrodrift.filters.attitude.zero import zero_yaw
from gyrodrift.filters.filter import Filter, FilterState
from gyrodrift.filters.gaps import GapWatch
from gyrodrift.filters.restlevel.bias_state import AxisKnowledge
from gyrodrift.filters.restlevel.memory import RestlevelMemory, learned_of
from gyrodrift.filters.restlevel.model import RestlevelParams, RestlevelState
from gyrodrift.filters.restlevel.rate_state import NoiseModel
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.values.mount import Mount
from gyrodrift.values.quaternion import Quaternion, with_heading
from gyrodrift.values.sample import Inertial
from gyrodrift.values.vectors import Vector


class ThreeAxisState(FilterState, Protocol):
    """State of a three-axis filter after a sample.

    heading_rate_dps
        Rate of the heading by the measured rates, deg/s.
    q
        Unit quaternion (w, x, y, z) from the sensor to the earth frame, z up; its heading is `yaw_deg`.
    tilt_deg, tilt_sigma_deg
        Angle between the z axis of the sensor and the vertical, and its standard deviation, deg.
    bias_xyz_dps
        Bias estimates about x, y and z, deg/s.
    """

    heading_rate_dps: float

    @property
    def q(self) -> Quaternion:  # noqa: D102 - above
        ...

    @property
    def tilt_deg(self) -> float:  # noqa: D102
        ...

    @property
    def tilt_sigma_deg(self) -> float:  # noqa: D102
        ...

    @property
    def bias_xyz_dps(self) -> tuple[float, float, float]:  # noqa: D102
        ...


@dataclass(frozen=True, slots=True)
class ThreeAxisFilter:
    """Three-axis version of a filter.

    coefficients, zero
        As in `Filter`.
    state
        Takes the state of one axis and the mount, and returns the first state. Yaw, its sigma and remembered biases are
        those of the one axis.
    step
        Takes coefficients, state, device time in s, rates and accelerations, the still flag and the temperature in °C,
        both NaN if unknown; False if the sample is rejected.
    aided
        Functions that take measurements of second sources; None for a filter that cannot.
    learned
        From the state, the mount, the earlier knowledge and its age in s to the new knowledge, in the frame of the
        sensor; None for a filter without a memory.
    """

    coefficients: Callable[[Any], Any]
    state: Callable[[Any, Mount], Any]
    zero: Callable[[Any], None]
    step: Callable[[Any, Any, float, Inertial, float, float], bool]
    aided: AidedFilter | None = None
    learned: Callable[[Any, Mount, Any, float], Any] | None = None


def three_axis_version(chosen: Filter) -> ThreeAxisFilter:
    """Three-axis version of a filter."""
    if chosen is RESTLEVEL:
        return ThreeAxisFilter(attitude_coefficients, _attitude_after, zero_yaw, _attitude_step, AIDED, _learned)
    step = chosen.step_auxiliary

    def heading_step(c: Any, s: HeadingState, t_s: float, inertial: Inertial, still: float, temp_c: float) -> bool:
        """Take the rate of the heading, then filter it."""
        before, inner = c
        gaps, restarts, yaw_deg = s.watch.gaps, s.watch.restarts, s.yaw_deg
        is_accepted = attitude_step(before, s.attitude, t_s, *inertial, still, temp_c)
        if s.watch.restarts > restarts:
            s.inner = chosen.state()
        is_accepted = is_accepted and step(inner, s.inner, t_s, s.attitude.heading_rate_dps, still, temp_c)
        if s.watch.gaps > gaps:
            s.yaw_deg = yaw_deg
        s.samples, s.rejected = s.samples + is_accepted, s.rejected + (not is_accepted)
        return is_accepted

    return ThreeAxisFilter(
        lambda params: (attitude_coefficients(RestlevelParams()), chosen.coefficients(params)),
        lambda before, _mount: _heading_after(before, chosen),
        lambda s: chosen.zero(s.inner),
        heading_step,
    )


def _attitude_after(before: RestlevelState, mount: Mount) -> AttitudeState:
    axes = axes_in_frame([*before.level, AxisKnowledge(before.remembered, before.line)], mount.to_device)
    return AttitudeState(
        yaw_deg=before.yaw_deg,
        yaw_sigma_deg=before.yaw_sigma_deg,
        rejected=before.rejected,
        noise_var=RAD * RAD * before.recalled.angle_walk_var,
        axes=axes,
    )


def _learned(s: AttitudeState, mount: Mount, before: RestlevelMemory | None, age_s: float) -> RestlevelMemory | None:
    x, y, z = axes_in_frame(s.axes, mount.to_sensor)
    noise = NoiseModel(sample_var=0.0, angle_walk_var=s.noise_var / RAD / RAD)
    return learned_of((z, x, y), noise, s.lived_s, before, age_s)


def axes_in_frame(axes: list[AxisKnowledge], turn: Callable[[Vector], Vector]) -> list[AxisKnowledge]:
    """Copies of the knowledge of x, y and z in another frame; `turn` turns vectors into it, by right angles."""
    numbers = turn((1.0, 2.0, 3.0))
    return [_signed(deepcopy(axes[round(abs(number)) - 1]), number / abs(number)) for number in numbers]


def _signed(axis: AxisKnowledge, sign: float) -> AxisKnowledge:
    """Knowledge of an axis, or with the sign −1 that of the opposite direction."""
    line, sure = axis.line, axis.sure
    for slot in axis.remembered:
        slot.bias_dps *= sign
    line.slope_dps_c, line.level_dps = sign * line.slope_dps_c, sign * line.level_dps
    sure.begin_dps, sure.bias_dps, sure.first_dps = sign * sure.begin_dps, sign * sure.bias_dps, sign * sure.first_dps
    return axis


def _heading_after(before: FilterState, chosen: Filter) -> "HeadingState":
    state = HeadingState(chosen.state(), rejected=before.rejected)
    state.yaw_deg = before.yaw_deg
    return state


def _attitude_step(c: Any, s: AttitudeState, t_s: float, inertial: Inertial, still: float, temp_c: float) -> bool:
    return attitude_step(c, s, t_s, *inertial, still, temp_c)


@dataclass(slots=True)
class HeadingState:
    """State of a filter of one axis that runs on the rate of the heading.

    Yaw, its bias and their certainties are those of the filter. Tilt and the biases of the axes are those of the
    attitude filter.
    """

    inner: Any
    attitude: AttitudeState = field(default_factory=AttitudeState)
    samples: int = 0
    rejected: int = 0

    @property
    def yaw_deg(self) -> float:
        """Yaw of the filter, deg."""
        return float(self.inner.yaw_deg)

    @yaw_deg.setter
    def yaw_deg(self, yaw_deg: float) -> None:
        self.inner.yaw_deg = yaw_deg

    @property
    def watch(self) -> GapWatch:
        """Limit that tells a gap from a step."""
        return self.attitude.watch

    @property
    def bias_dps(self) -> float:
        """Bias of the rate of the heading by the filter, deg/s."""
        return float(self.inner.bias_dps)

    @property
    def yaw_sigma_deg(self) -> float:
        """Standard deviation of yaw, deg; NaN for a filter without it."""
        return float(self.inner.yaw_sigma_deg)

    @property
    def bias_sigma_dps(self) -> float:
        """Standard deviation of the bias, deg/s; NaN for a filter without it."""
        return float(self.inner.bias_sigma_dps)

    @property
    def rest_probability(self) -> float:
        """Probability of rest; NaN for a filter without it."""
        return float(self.inner.rest_probability)

    @property
    def confidence(self) -> float:
        """Probability of the most probable hypothesis; NaN for a filter without it."""
        return float(self.inner.confidence)

    @property
    def heading_rate_dps(self) -> float:
        """Rate of the heading by the measured rates, deg/s."""
        return self.attitude.heading_rate_dps

    @property
    def q(self) -> Quaternion:
        """Attitude with the heading of the filter."""
        return with_heading(self.attitude.q, self.yaw_deg - self.attitude.yaw_deg)

    @property
    def tilt_deg(self) -> float:
        """Tilt, deg."""
        return self.attitude.tilt_deg

    @property
    def tilt_sigma_deg(self) -> float:
        """Standard deviation of the tilt, deg."""
        return self.attitude.tilt_sigma_deg

    @property
    def bias_xyz_dps(self) -> tuple[float, float, float]:
        """Bias estimates about the axes, deg/s."""
        return self.attitude.bias_xyz_dps
