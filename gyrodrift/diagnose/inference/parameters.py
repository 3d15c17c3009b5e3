"""Parameters of a named cause: its best size between those of the grid, and the interval of sizes as plausible."""

from dataclasses import dataclass

import numpy as np

from firmware_sim.effects.effect import Effect
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.inference.alternatives import Alternatives

PLAUSIBLE = 2.0
"""Log-likelihood: sizes that score less than the best by no more belong to the interval, and so do those within as many
standard errors; chi-square of one degree of freedom would have 1.92 for 95 %, and 1.96 errors."""

HALF_TURN_DEG = 180.0
"""A phase that is another one in each session is known to no better; the value is that of the first."""

UNITS = {
    "percent": "%",
    "percent_fs": "% of full scale",
    "percent_per_c": "%/°C",
    "dps_per_c": "deg/s/°C",
    "curve_per_c": "1/°C",
    "dps": "deg/s",
    "deg": "deg",
    "ms": "ms",
    "hz": "Hz",
    "ppm": "ppm",
    "dph": "deg/h",
    "dps_rts": "deg/s/√s",
    "dps_at_100_dps": "deg/s at 100 deg/s",
    "s": "s",
    "per_hour": "1/h",
    "cpr": "counts per turn",
}
"""By how the names of parameters end."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """A fitted parameter with the sizes that would do nearly as well."""

    name: str
    value: float
    low: float
    high: float
    unit: str


def unit_of(parameter: str) -> str:
    """Unit of a parameter, by the end of its name."""
    ends = [end for end in UNITS if parameter == end or parameter.endswith(f"_{end}")]
    return UNITS[max(ends, key=len)] if ends else ""


def best_size(sizes: Floats, profile: Floats) -> float:
    """Between the sizes of the grid: the top of a parabola through the best and its neighbours."""
    at = int(np.argmax(profile))
    if not 0 < at < len(sizes) - 1 or sizes[at - 1] * sizes[at + 1] <= 0.0:
        return float(sizes[at])
    left, middle, right = profile[at - 1 : at + 2]
    bend = left - 2.0 * middle + right
    shift = 0.5 * (left - right) / bend if bend < 0.0 else 0.0
    ratio = sizes[at + 1] / sizes[at] if shift > 0.0 else sizes[at] / sizes[at - 1]
    return float(sizes[at] * ratio**shift)


def size_of(one: Alternatives) -> float:
    """The fitted size: exact, or by its profile where it could not be refined."""
    return best_size(one.cause.candidate.sizes, one.profile) if one.exact is None else one.exact.size


def effect_of(one: Alternatives) -> Effect:
    """The effect of the simulator at the fitted size and phase; where phases are free, at that of the first session."""
    phase_deg, phases_deg = None if one.exact is None else one.exact.phase_deg, one.cause.response.phases_deg
    if phases_deg is not None:
        phase_deg = float(phases_deg[0])
    made = one.cause.candidate.make(size_of(one))
    return made if phase_deg is None else made.model_copy(update={"phase_deg": phase_deg})


def parameters_of(one: Alternatives) -> tuple[Parameter, ...]:
    """The size with its interval first, and then what is fixed with the candidate or stands in the rig."""
    candidate, profile = one.cause.candidate, one.profile
    best = size_of(one)
    plausible = candidate.sizes[profile > profile.max() - PLAUSIBLE]
    error = 0.0 if one.exact is None else PLAUSIBLE * one.exact.error
    name, unit = candidate.parameter, unit_of(candidate.parameter)
    reach = (best, best - error, best + error, plausible[0], plausible[-1])
    value, *ends = (_value(candidate.make(float(size)), name) for size in reach)
    found = [Parameter(name, value, min(value, *ends), max(value, *ends), unit)]
    for other, fixed in effect_of(one).model_dump(exclude_unset=True).items():
        if other not in {name, "name"}:
            found.append(Parameter(other, fixed, *_phase_reach(one, other, fixed), unit_of(other)))
    return tuple(found)


def _phase_reach(one: Alternatives, parameter: str, value: float) -> tuple[float, float]:
    """From where to where a phase may be; all else is fixed with the candidate."""
    if parameter != "phase_deg":
        return value, value
    if one.cause.response.phases_deg is not None:
        return -HALF_TURN_DEG, HALF_TURN_DEG
    off_deg = 0.0 if one.exact is None else PLAUSIBLE * one.exact.phase_error_deg
    return value - off_deg, value + off_deg


def _value(effect: Effect, parameter: str) -> float:
    return float(getattr(effect, parameter))
