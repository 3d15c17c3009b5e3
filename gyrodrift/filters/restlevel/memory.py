"""Memory of a sensor from run to run: bias, noise at rest, drift and starts.

Only sure rests are remembered. A memory gives one or two biases to begin with, each with a variance:

- the bias of the last sure rest, with the drift of the sensor since then and the change by temperature;
- the bias of the start that is most similar in temperature, because a sensor starts similarly at the same temperature.

A memory of one axis or of three has these for each axis. The biases of the axes change together: by the same age and
temperature, and by the same chance that the sensor is another one.

The drift factor of an axis is learned from its starts. It compares the squared error of the remembered bias with its
expected variance. The ratio is clipped at nine, so that an outlier counts little.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from math import exp
from typing import Annotated, Any

from annotated_types import Ge, Le

from gyrodrift.filters.beliefs import PARTS
from gyrodrift.filters.restlevel.bias_state import NEW_SLOPE_VAR, AxisKnowledge
from gyrodrift.filters.restlevel.kalman import gaussian_logpdf
from gyrodrift.filters.restlevel.model import COLDEST_C, UNKNOWN_C, WARMEST_C, RestlevelParams, RestlevelState
from gyrodrift.filters.restlevel.rate_state import NoiseModel
from gyrodrift.filters.restlevel.temperature import LOOP_VAR_C

REMEMBERED_WEIGHT = 0.95
"""Probability that the memory is still true: the sensor was not replaced or damaged. Chosen."""

START_SHARE, START_AGE_S = 0.1, 600.0
"""Change of the bias by a restart of the sensor, in sigmas of the turn-on bias. A memory older than `START_AGE_S`, s,
is from before a restart. Chosen."""

SIMILAR_START_C = 3.0
"""Largest difference in temperature of two similar starts, °C. Chosen: the bias moves by 0.03 deg/s at the slope of
`NEW_SLOPE_VAR`."""

STARTS_KEPT = 12
"""Largest number of remembered starts. Chosen: a memory stays small."""

FACTOR_STARTS = 3.0
"""Number of starts that the prior of the drift factor counts for. Chosen: a weak prior."""

FACTOR_CLIP = 9.0
"""Largest ratio of a squared error to its expected variance that the drift factor counts. Derived: 3², three sigmas."""

LEAST_FACTOR, MOST_FACTOR = 0.1, 1000.0
"""Limits of the drift factor. Chosen."""

LEAST_VAR = 1e-8
"""Smallest variance of a remembered bias, (deg/s)², and smallest denominator of a probability. Chosen: the square of
0.0001 deg/s."""

Dps = Annotated[float, Ge(-1e5), Le(1e5)]
Size = Annotated[float, Ge(0.0), Le(1e6)]
Celsius = Annotated[float, Ge(-100.0), Le(200.0)]


@dataclass(frozen=True, slots=True)
class RememberedStart:
    """First sure rest of a run: bias and its sigma, deg/s, temperature, °C, and its age when the memory was made, s."""

    bias_dps: Dps
    bias_sigma_dps: Size
    temp_c: Celsius | None
    age_s: Annotated[float, Ge(0.0)]


@dataclass(frozen=True, slots=True)
class AxisMemory:
    """Memory of an axis.

    bias_dps, bias_sigma_dps, temp_c
        Last sure rest: bias and its sigma, deg/s, and temperature, °C; None if the temperature is unknown.
    age_s
        Age of that rest when the memory was made, s.
    sample_var, angle_walk_var, flicker_var, resolution_dps, period_s
        Noise at rest, as in `NoiseModel`, and the sample period, s.
    drift_factor, starts
        Ratio of the variance of the bias from run to run to its expected variance, and the number of runs behind it.
    first
        Starts of the sensor, the latest first.
    slope_dps_c, slope_sigma_dps_c
        Slope of the bias against temperature and its standard deviation, deg/s per °C.
    """

    bias_dps: Dps
    bias_sigma_dps: Size
    temp_c: Celsius | None
    age_s: Annotated[float, Ge(0.0)]
    sample_var: Size
    angle_walk_var: Size
    flicker_var: Size
    resolution_dps: Annotated[float, Ge(-1.0), Le(1e5)]
    period_s: Size
    drift_factor: Annotated[float, Ge(LEAST_FACTOR), Le(MOST_FACTOR)] = 1.0
    starts: Annotated[int, Ge(0)] = 0
    first: tuple[RememberedStart, ...] = field(default=())
    slope_dps_c: Dps = 0.0
    slope_sigma_dps_c: Size = NEW_SLOPE_VAR**0.5


@dataclass(frozen=True, slots=True)
class RestlevelMemory(AxisMemory):
    """Memory of a sensor: that of its z axis, and of x and y by a filter of three axes."""

    x: AxisMemory | None = None
    y: AxisMemory | None = None

    @property
    def axes(self) -> tuple[AxisMemory, ...]:
        """Memories of z, or of z, x and y."""
        return (self,) if self.x is None or self.y is None else (self, self.x, self.y)


def learned(state: RestlevelState, before: RestlevelMemory | None, age_s: float) -> RestlevelMemory | None:
    """Memory after a run; None without a sure rest.

    Parameters
    ----------
    state
        State of the filter at the end of the run.
    before, age_s
        Memory at the beginning of the run, and its age now, s.
    """
    return learned_of((state,), state.noise, state.lived_s, before, age_s)


def learned_of(
    axes: Sequence[RestlevelState | AxisKnowledge],
    noise: NoiseModel,
    lived_s: float,
    before: RestlevelMemory | None,
    age_s: float,
) -> RestlevelMemory | None:
    """Memory of one axis or of three after a run; None without a sure rest.

    Parameters
    ----------
    axes
        What was learned of z, or of z, x and y of the sensor.
    noise, lived_s
        Noise at rest, and length of the run, s.
    before, age_s
        Memory at the beginning of the run, and its age now, s.
    """
    if axes[0].sure.rests == 0:
        return None
    kept = () if before is None else before.axes
    z, *level = (
        _learned_axis(axis, noise, lived_s, kept[index] if index < len(kept) else None, age_s)
        for index, axis in enumerate(axes)
    )
    values: dict[str, Any] = {entry.name: getattr(z, entry.name) for entry in fields(z)}
    return RestlevelMemory(**values | dict(zip("xy", level, strict=False)))


def _learned_axis(
    axis: RestlevelState | AxisKnowledge, noise: NoiseModel, lived_s: float, before: AxisMemory | None, age_s: float
) -> AxisMemory:
    """Memory of an axis after a run."""
    sure = axis.sure
    first_age_s = lived_s - sure.first_s
    start = RememberedStart(sure.first_dps, sure.first_dps_sigma, _known_temp(sure.first_c), first_age_s)
    kept = () if before is None else before.first[: STARTS_KEPT - 1]
    older = [RememberedStart(rest.bias_dps, rest.bias_sigma_dps, rest.temp_c, rest.age_s + age_s) for rest in kept]
    factor, starts = _drift_factor(axis, before)
    return AxisMemory(
        bias_dps=sure.bias_dps,
        bias_sigma_dps=max(0.0, sure.bias_var) ** 0.5,
        temp_c=_known_temp(sure.temp_c),
        age_s=max(0.0, lived_s - sure.t_s),
        sample_var=noise.sample_var,
        angle_walk_var=noise.angle_walk_var,
        flicker_var=noise.flicker_var,
        resolution_dps=noise.resolution_dps,
        period_s=sure.period_s,
        drift_factor=factor,
        starts=starts,
        first=(start, *older),
        slope_dps_c=axis.line.slope_dps_c,
        slope_sigma_dps_c=max(0.0, axis.line.slope_var) ** 0.5,
    )


def begun(params: RestlevelParams, memory: RestlevelMemory, age_s: float, temp_c: float | None) -> RestlevelState:
    """New state with a memory that was made `age_s` ago; `temp_c` is the present temperature of the sensor, °C.

    It is the state of one axis, which a filter of three axes goes on from.
    """
    state = RestlevelState()
    is_in_range = temp_c is not None and COLDEST_C < temp_c < WARMEST_C  # a device may send any number
    biases = [_expected_biases(params, axis, age_s, temp_c if is_in_range else None) for axis in memory.axes]
    variances = [sum(variance for _, variance in slot) for slot in zip(*biases, strict=False)]
    precision = sum(1.0 / variance for variance in variances)
    restart_probability = _restart_probability(age_s + memory.age_s)
    weight = REMEMBERED_WEIGHT * (1.0 - restart_probability * _self_nulling(params, memory))
    axes: tuple[RestlevelState | AxisKnowledge, ...] = (state, *state.level)
    for axis, of_axis, expected in zip(axes, memory.axes, biases, strict=False):
        axis.line.slope_dps_c, axis.line.slope_var = of_axis.slope_dps_c, of_axis.slope_sigma_dps_c**2
        for slot, (bias_dps, variance), total_var in zip(axis.remembered, expected, variances, strict=False):
            slot.weight = weight / total_var / precision
            slot.bias_dps, slot.bias_var = bias_dps, variance
    recalled = state.recalled
    recalled.period_s, recalled.sample_var = memory.period_s, memory.sample_var
    recalled.angle_walk_var, recalled.flicker_var = memory.angle_walk_var, memory.flicker_var
    recalled.resolution_dps = memory.resolution_dps
    return state


def _restart_probability(age_s: float) -> float:
    """Probability that the sensor was switched off and on within an age, s; it grows linearly with the age."""
    return min(1.0, age_s / START_AGE_S)


def _self_nulling(params: RestlevelParams, memory: RestlevelMemory) -> float:
    """Probability that the sensor subtracts its own bias at each start, from the size of the remembered biases.

    The bias of such a sensor after the next start is unrelated to the remembered bias.
    """
    if params.turn_on_dps == 0.0:
        return 0.0
    measured = [(axis.bias_dps, axis.bias_sigma_dps**2 + LEAST_VAR) for axis in memory.axes]
    turn_on_var = params.turn_on_dps**2
    densities = [
        share * exp(sum(gaussian_logpdf(bias_dps, wider**2 * turn_on_var + var) for bias_dps, var in measured))
        for share, wider in PARTS
    ]
    return densities[0] / max(sum(densities), LEAST_VAR)


def _expected_biases(
    params: RestlevelParams, memory: AxisMemory, age_s: float, temp_c: float | None
) -> list[tuple[float, float]]:
    """Biases to begin with, deg/s, and their variances, (deg/s)²: of the last sure rest, and of the most similar start.

    The start is used if the sensor certainly was switched off and on, or if the last rest had another temperature.
    """
    last_s = age_s + memory.age_s
    restart_probability = _restart_probability(last_s)
    last_var = memory.bias_sigma_dps**2 + _drift_var(params, memory, last_s, restart_probability)
    moved_dps, moved_var = _temp_change(memory, memory.temp_c, temp_c)
    biases = [(memory.bias_dps + moved_dps, last_var + moved_var)]
    similar = [start for start in memory.first if _is_similar(start.temp_c, temp_c)]
    if similar and restart_probability < 1.0 and not _is_similar(memory.temp_c, temp_c):
        restart_probability = 1.0
    if similar and restart_probability == 1.0:
        nearest = min(similar, key=lambda start: abs((start.temp_c or 0.0) - (temp_c or 0.0)))
        start_var = nearest.bias_sigma_dps**2 + _drift_var(params, memory, age_s + nearest.age_s, 1.0)
        moved_dps, moved_var = _temp_change(memory, nearest.temp_c, temp_c)
        biases.append((nearest.bias_dps + moved_dps, start_var + moved_var))
    return biases


def _drift_var(params: RestlevelParams, memory: AxisMemory, age_s: float, restart_probability: float) -> float:
    """Variance of the change of a bias within an age, (deg/s)²: by its random walk, and by a restart of the sensor.

    The walk is limited to the variance of the turn-on bias.
    """
    turn_on_var = params.turn_on_dps**2
    walk_var = min(params.walk_dps_rts**2 * age_s, turn_on_var)
    return LEAST_VAR + memory.drift_factor * (walk_var + START_SHARE**2 * turn_on_var * restart_probability)


def _temp_change(memory: AxisMemory, then_c: float | None, now_c: float | None) -> tuple[float, float]:
    """Change of the bias by temperature, deg/s, and its variance, (deg/s)²; 0 if a temperature is unknown."""
    if then_c is None or now_c is None:
        return 0.0, 0.0
    step_c = now_c - then_c
    slope_dps = memory.slope_sigma_dps_c * step_c
    return memory.slope_dps_c * step_c, slope_dps * slope_dps + LOOP_VAR_C * abs(step_c)


def _is_similar(then_c: float | None, now_c: float | None) -> bool:
    """Whether two temperatures, °C, are similar; an unknown temperature is similar to all."""
    return then_c is None or now_c is None or abs(now_c - then_c) <= SIMILAR_START_C


def _drift_factor(axis: RestlevelState | AxisKnowledge, before: AxisMemory | None) -> tuple[float, int]:
    """Drift factor after this run, and its number of runs, from the first sure rest and the remembered bias."""
    if before is None:
        return 1.0, 0
    expected = min(axis.remembered, key=lambda slot: -slot.weight)
    if expected.weight == 0.0:
        return before.drift_factor, before.starts
    variance = expected.bias_var + axis.sure.first_dps_sigma**2
    surprise = min((axis.sure.first_dps - expected.bias_dps) ** 2 / variance, FACTOR_CLIP)
    factor = before.drift_factor * (1.0 + (surprise - 1.0) / (before.starts + FACTOR_STARTS))
    return min(max(factor, LEAST_FACTOR), MOST_FACTOR), before.starts + 1


def _known_temp(temp_c: float) -> float | None:
    """Temperature, °C; None if it is unknown."""
    return None if temp_c == UNKNOWN_C else temp_c


def count_axes(memory: RestlevelMemory) -> int:
    """Number of axes of a memory."""
    return len(memory.axes)


def knowledge(content: Any) -> RestlevelMemory:
    """Memory from the content of a file.

    Raises
    ------
    ValueError
        If the content is no memory; the message names the reason.
    """
    from pydantic import TypeAdapter  # noqa: PLC0415 - a run without a memory does not import pydantic

    memory: RestlevelMemory = TypeAdapter(RestlevelMemory).validate_python(content)
    return memory
