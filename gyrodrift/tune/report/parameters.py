"""Tables of filters and of parameters in a tuning's report."""

from math import isfinite

from gyrodrift.evaluation.space import Axis
from gyrodrift.report.numbers import log_share, significant
from gyrodrift.report.page import Section
from gyrodrift.tune.report.charts import importances
from gyrodrift.tune.result import Run, Tuning
from gyrodrift.tune.warnings import bound_of
from gyrodrift.values.constants import SECONDS_PER_HOUR
from gyrodrift.values.noise import ROOT_SECONDS_PER_ROOT_HOUR

DATA_SHEET = {
    "turn_on_dps": (SECONDS_PER_HOUR, "°/h"),
    "walk_dps_rts": (SECONDS_PER_HOUR * ROOT_SECONDS_PER_ROOT_HOUR, "°/h/√h"),
}
"""Factor and unit of data sheets for parameters that these quote."""

COLORS = {"euler": "plain", "start": "quiet"}


def alternatives(tuning: Tuning) -> Section | None:
    """Mean yaw error of every filter, tuned and at its defaults; None for a tuning without alternatives."""
    if not tuning.alternatives:
        return None
    errors_deg = [way.e_deg.train if way.e_deg.test is None else way.e_deg.test for way in tuning.alternatives]
    known_deg = [e_deg for e_deg in errors_deg if e_deg > 0.0 and isfinite(e_deg)] or [1.0]
    shares = [log_share(e_deg, min(known_deg) / 3.0, max(known_deg)) for e_deg in errors_deg]
    values = {
        "tuning": tuning,
        "ways": list(zip(tuning.alternatives, shares, errors_deg, strict=True)),
        "best": min(tuning.alternatives, key=lambda way: way.judged_pi),
        "colors": COLORS,
        "has_test": any(way.pi.test is not None for way in tuning.alternatives),
    }
    return Section("tune/report/templates/alternatives.html", values, "Filters and defaults")


def value_found(run: Run, axis: Axis) -> float:
    """Value of a search result, in the unit of the parameter."""
    return float(getattr(run.params, axis.name))


def found_value(tuning: Tuning, axis: Axis) -> str:
    """Value found, with four digits."""
    return significant(value_found(tuning.run, axis), 4)


def parameters(tuning: Tuning) -> Section:
    """The parameters with range, importance and meaning."""
    model, has_slices = tuning.filter.reduced_model, bool(tuning.slices.size)
    values = {
        "model": model,
        "seeds": 1 + len(tuning.other_runs),
        "parameters": [_parameter(tuning, axis) for axis in tuning.axes],
        "importances": importances(tuning.slices).tolist() if has_slices else [],
        "reduced": [f"{name} {significant(getattr(tuning.reduced_params, name), 4)}" for name in model.names],
    }
    return Section("tune/report/templates/parameters.html", values, "Parameters")


def _parameter(tuning: Tuning, axis: Axis) -> dict[str, object]:
    """A parameter for the template; `ticks` are shares of the range in percent, that of the value found first."""
    values = [value_found(run, axis) for run in (tuning.run, *tuning.other_runs)]
    factor, unit = DATA_SHEET.get(axis.name, (1.0, ""))
    return {
        "axis": axis,
        "described": tuning.filter.parameter(axis.name),
        "found": found_value(tuning, axis),
        "least": min(values),
        "largest": max(values),
        "bound": bound_of(axis, values[0]),
        "data_sheet": f"{significant(factor * values[0], 3)} {unit}" if unit else "",
        "ticks": [100.0 * axis.unit(value) for value in values],
    }
