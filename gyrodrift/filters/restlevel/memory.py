"""What restlevel remembers of a sensor from one run to the next: bias, noise at rest, drift, and how it starts.

Only sure rests are remembered. From a memory of some age follow the biases to begin with: the last one, as far out as
the sensor is known to drift in that time and to change with its temperature, and that of the starts at such a
temperature, since a sensor that is switched on in one place comes up alike. How far out the remembered bias was at each
start, against what was expected, is the sensor's own drift: it is learned, and a start that is far out counts no more
than nine times what was expected.
"""

from dataclasses import dataclass, field
from math import exp
from typing import Annotated, Any

from annotated_types import Ge, Le

from gyrodrift.filters.restlevel.bias_state import NEW_SLOPE_VAR
from gyrodrift.filters.restlevel.hypotheses import CALIBRATED, PARTLY_CALIBRATED, WELL_CALIBRATED
from gyrodrift.filters.restlevel.kalman import gaussian_logpdf
from gyrodrift.filters.restlevel.model import COLDEST_C, UNKNOWN_C, WARMEST_C, RestlevelParams, RestlevelState
from gyrodrift.filters.restlevel.temperature import LOOP_VAR_C

REMEMBERED_WEIGHT = 0.95
"""Probability that the sensor is the one that is remembered, not one to which something has happened."""

START_SHARE, START_AGE_S = 0.1, 600.0
"""How far a bias changes when the sensor is switched off and on, in sigmas of the turn-on bias; the time after which it
will have been."""

SIMILAR_START_C = 3.0
"""Starts at temperatures no further apart than this are alike."""

STARTS_KEPT = 12
FACTOR_STARTS = 3.0
FACTOR_CLIP = 9.0
LEAST_FACTOR, MOST_FACTOR = 0.1, 1000.0

LEAST_VAR = 1e-8

Dps = Annotated[float, Ge(-1e5), Le(1e5)]
Size = Annotated[float, Ge(0.0), Le(1e6)]
Celsius = Annotated[float, Ge(-100.0), Le(200.0)]


@dataclass(frozen=True, slots=True)
class RememberedStart:
    """The first sure rest of a run: bias and sigma in deg/s, temperature in °C, s before the memory was made."""

    bias_dps: Dps
    bias_sigma_dps: Size
    temp_c: Celsius | None
    age_s: Annotated[float, Ge(0.0)]


@dataclass(frozen=True, slots=True)
class RestlevelMemory:
    """What is known of a sensor.

    bias_dps, bias_sigma_dps, temp_c
        Bias of the last sure rest and its sigma, deg/s, and the temperature there, °C; None where nobody said.
    age_s
        How long before the memory was made that was, s.
    sample_var, angle_walk_var, flicker_var, resolution_dps, period_s
        Noise at rest, as in `NoiseModel`, and the time between two samples, s.
    drift_factor, starts
        By how much its variance from run to run is larger than expected of any sensor, and from how many runs.
    first
        Its starts, the last one first.
    slope_dps_c, slope_sigma_dps_c
        Slope of its bias against temperature and its standard deviation, deg/s per °C.
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


def learned(state: RestlevelState, before: RestlevelMemory | None, age_s: float) -> RestlevelMemory | None:
    """What a run has made sure of, with what was remembered before it; None where it has made sure of nothing.

    Parameters
    ----------
    state
        Of the filter.
    before, age_s
        What it began with, and how old that is now, s.
    """
    sure, noise = state.sure, state.noise
    if sure.rests == 0:
        return None
    start = RememberedStart(sure.first_dps, sure.first_dps_sigma, _said(sure.first_c), state.lived_s - sure.first_s)
    kept = () if before is None else before.first[: STARTS_KEPT - 1]
    older = [RememberedStart(one.bias_dps, one.bias_sigma_dps, one.temp_c, one.age_s + age_s) for one in kept]
    factor, starts = _drift_factor(state, before)
    return RestlevelMemory(
        bias_dps=sure.bias_dps,
        bias_sigma_dps=max(0.0, sure.bias_var) ** 0.5,
        temp_c=_said(sure.temp_c),
        age_s=max(0.0, state.lived_s - sure.t_s),
        sample_var=noise.sample_var,
        angle_walk_var=noise.angle_walk_var,
        flicker_var=noise.flicker_var,
        resolution_dps=noise.resolution_dps,
        period_s=sure.period_s,
        drift_factor=factor,
        starts=starts,
        first=(start, *older),
        slope_dps_c=state.line.slope_dps_c,
        slope_sigma_dps_c=max(0.0, state.line.slope_var) ** 0.5,
    )


def begun(params: RestlevelParams, memory: RestlevelMemory, age_s: float, temp_c: float | None) -> RestlevelState:
    """A new state that remembers; the memory was made `age_s` ago, and the sensor has this temperature in °C now."""
    state = RestlevelState()
    state.line.slope_dps_c, state.line.slope_var = memory.slope_dps_c, memory.slope_sigma_dps_c**2
    is_one = temp_c is not None and COLDEST_C < temp_c < WARMEST_C  # as in `step`: a device may say anything
    found = _expected(params, memory, age_s, temp_c if is_one else None)
    precision = sum(1.0 / variance for _, variance in found)
    is_new_start = min(1.0, (age_s + memory.age_s) / START_AGE_S)
    weight = REMEMBERED_WEIGHT * (1.0 - is_new_start * _self_nulling(params, memory))
    for place, (bias_dps, variance) in zip(state.remembered, found, strict=False):
        place.weight = weight / variance / precision
        place.bias_dps, place.bias_var = bias_dps, variance
    recalled = state.recalled
    recalled.period_s, recalled.sample_var = memory.period_s, memory.sample_var
    recalled.angle_walk_var, recalled.flicker_var = memory.angle_walk_var, memory.flicker_var
    recalled.resolution_dps = memory.resolution_dps
    return state


def _self_nulling(params: RestlevelParams, memory: RestlevelMemory) -> float:
    """Probability that the sensor removes its own bias, by how small the last one was: the next one is another then."""
    if params.turn_on_dps == 0.0:
        return 0.0
    turn_on_var, seen_var = params.turn_on_dps**2, memory.bias_sigma_dps**2 + LEAST_VAR
    kinds = (
        (WELL_CALIBRATED, turn_on_var * CALIBRATED**2),
        (PARTLY_CALIBRATED, turn_on_var * CALIBRATED),
        (1.0 - WELL_CALIBRATED - PARTLY_CALIBRATED, turn_on_var),
    )
    densities = [share * exp(gaussian_logpdf(memory.bias_dps, var + seen_var)) for share, var in kinds]
    return densities[0] / max(sum(densities), LEAST_VAR)


def _expected(
    params: RestlevelParams, memory: RestlevelMemory, age_s: float, temp_c: float | None
) -> list[tuple[float, float]]:
    """Biases to begin with and their variances: of the last sure rest, and of the start most like this one."""
    last_s = age_s + memory.age_s
    is_new_start = min(1.0, last_s / START_AGE_S)
    last_var = memory.bias_sigma_dps**2 + _drift_var(params, memory, last_s, is_new_start)
    moved_dps, moved_var = _moved(memory, memory.temp_c, temp_c)
    found = [(memory.bias_dps + moved_dps, last_var + moved_var)]
    alike = [one for one in memory.first if _is_alike(one.temp_c, temp_c)]
    if alike and is_new_start < 1.0 and not _is_alike(memory.temp_c, temp_c):
        is_new_start = 1.0
    if alike and is_new_start == 1.0:
        one = min(alike, key=lambda each: abs((each.temp_c or 0.0) - (temp_c or 0.0)))
        start_var = one.bias_sigma_dps**2 + _drift_var(params, memory, age_s + one.age_s, 1.0)
        moved_dps, moved_var = _moved(memory, one.temp_c, temp_c)
        found.append((one.bias_dps + moved_dps, start_var + moved_var))
    return found


def _drift_var(params: RestlevelParams, memory: RestlevelMemory, age_s: float, is_new_start: float) -> float:
    """What a bias may have changed by, (deg/s)²: by a walk, no further than a turn-on bias is, and by a new start."""
    turn_on_var = params.turn_on_dps**2
    walk_var = min(params.walk_dps_rts**2 * age_s, turn_on_var)
    return LEAST_VAR + memory.drift_factor * (walk_var + START_SHARE**2 * turn_on_var * is_new_start)


def _moved(memory: RestlevelMemory, then_c: float | None, now_c: float | None) -> tuple[float, float]:
    """Return by how much a change of temperature has moved the bias, deg/s, and the variance of that."""
    if then_c is None or now_c is None:
        return 0.0, 0.0
    step_c = now_c - then_c
    slope_dps = memory.slope_sigma_dps_c * step_c
    return memory.slope_dps_c * step_c, slope_dps * slope_dps + LOOP_VAR_C * abs(step_c)


def _is_alike(then_c: float | None, now_c: float | None) -> bool:
    return then_c is None or now_c is None or abs(now_c - then_c) <= SIMILAR_START_C


def _drift_factor(state: RestlevelState, before: RestlevelMemory | None) -> tuple[float, int]:
    """By how far the first sure rest of this run was out, against what was expected."""
    if before is None:
        return 1.0, 0
    expected = min(state.remembered, key=lambda one: -one.weight)
    if expected.weight == 0.0:
        return before.drift_factor, before.starts
    variance = expected.bias_var + state.sure.first_dps_sigma**2
    surprise = min((state.sure.first_dps - expected.bias_dps) ** 2 / variance, FACTOR_CLIP)
    factor = before.drift_factor * (1.0 + (surprise - 1.0) / (before.starts + FACTOR_STARTS))
    return min(max(factor, LEAST_FACTOR), MOST_FACTOR), before.starts + 1


def _said(temp_c: float) -> float | None:
    return None if temp_c == UNKNOWN_C else temp_c


def knowledge(content: Any) -> RestlevelMemory:
    """A memory from what a file says.

    Raises
    ------
    ValueError
        With what is wrong with it.
    """
    from pydantic import TypeAdapter  # noqa: PLC0415 - only who remembers pays for it

    memory: RestlevelMemory = TypeAdapter(RestlevelMemory).validate_python(content)
    return memory
