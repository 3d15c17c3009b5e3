"""Tables of filters and of parameters in a tuning's report."""

from math import isfinite, log10

from markupsafe import Markup

from gyrodrift.evaluation.space import Axis
from gyrodrift.report.numbers import Numbers, significant
from gyrodrift.report.page import Section, bar, bold, marked
from gyrodrift.tune.report.charts import importances
from gyrodrift.tune.result import Alternative, Run, Tuning
from gyrodrift.tune.warnings import bound_of
from gyrodrift.values.noise import ROOT_SECONDS_PER_ROOT_HOUR, SECONDS_PER_HOUR

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
    has_test = any(way.pi.test is not None for way in tuning.alternatives)
    splits = ["training", *["held out"] * has_test]
    head = ["", *(f"E {split}, deg" for split in splits), *(f"PI {split}, deg²" for split in splits), "E"]
    rows = [_alternative_row(tuning, way, has_test=has_test) for way in tuning.alternatives]
    values = {"head": head, "rows": rows, "has_test": has_test}
    return Section("tune/report/templates/alternatives.html", values, "Filters and defaults")


def _alternative_row(tuning: Tuning, way: Alternative, *, has_test: bool) -> list[str]:
    is_best = way is min(tuning.alternatives, key=lambda every: every.judged_pi)
    marks = [marked("best", "best")] * is_best + [marked("note", "in the config")] * (way is tuning.written)
    means = [value for mean in (way.e_deg, way.pi) for value in (mean.train, *[mean.test] * has_test)]
    cells = ["–" if value is None else significant(value, 3) for value in means]
    return [Markup(" ").join([way.title, *marks]), *cells, _error_bar(tuning, way)]


def _judged_e_deg(way: Alternative) -> float:
    return way.e_deg.train if way.e_deg.test is None else way.e_deg.test


def _error_bar(tuning: Tuning, way: Alternative) -> Markup:
    """A bar from a third of the least error to this error, on a logarithmic scale."""
    errors_deg = [_judged_e_deg(every) for every in tuning.alternatives]
    known_deg = [e_deg for e_deg in errors_deg if e_deg > 0.0 and isfinite(e_deg)] or [1.0]
    low, high = min(known_deg) / 3.0, max(known_deg)
    e_deg = min(max(_judged_e_deg(way), low), high) if isfinite(_judged_e_deg(way)) else high
    color = COLORS.get(way.key, way.filter.color if way.filter else "quiet")
    is_pale = not way.is_tuned and way.filter is not None
    return bar(log10(e_deg / low) / log10(high / low), f"{significant(e_deg, 3)} deg", color, is_pale=is_pale)


def value_found(run: Run, axis: Axis) -> float:
    """Value of a search result, in the unit of the parameter."""
    return float(getattr(run.params, axis.name))


def found_value(tuning: Tuning, axis: Axis) -> str:
    """Value found, with four digits."""
    return significant(value_found(tuning.run, axis), 4)


def parameters(tuning: Tuning) -> Section:
    """The parameters with range, importance and meaning."""
    spread = [f"over {1 + len(tuning.other_runs)} seeds"] if tuning.other_runs else []
    shares = importances(tuning.slices).tolist() if tuning.slices.size else [None] * len(tuning.axes)
    model = tuning.filter.reduced_model
    values = {
        "model": model,
        "head": ["parameter", "found", *spread, "searched", *["importance"] * bool(tuning.slices.size), "effect"],
        "rows": [_row(tuning, axis, share) for axis, share in zip(tuning.axes, shares, strict=True)],
        "has_slices": bool(tuning.slices.size),
        "has_bound": any(bound_of(axis, value_found(tuning.run, axis)) for axis in tuning.axes),
        "reduced": [f"{name} {significant(getattr(tuning.reduced_params, name), 4)}" for name in model.names],
    }
    return Section("tune/report/templates/parameters.html", values, "Parameters")


def _row(tuning: Tuning, axis: Axis, share: float | None) -> list[str]:
    described = tuning.filter.parameter(axis.name)
    values = [value_found(run, axis) for run in (tuning.run, *tuning.other_runs)]
    bound = bound_of(axis, values[0])
    unit = Markup(" {}").format(marked("note", described.unit)) if described.unit else ""
    searched = Markup("{} – {}<br/>{} {}").format(
        significant(axis.low, 4),
        significant(axis.high, 4),
        _track(axis, values),
        marked("mark", f"at the {bound} bound") if bound else "",
    )
    percent = "" if share is None else f"{100.0 * share:.0f} %"
    return [
        Markup("{}{}").format(axis.name, unit),
        bold(found_value(tuning, axis)) + _data_sheet(axis, values[0]),
        *[f"{significant(min(values), 3)} – {significant(max(values), 3)}"] * bool(tuning.other_runs),
        searched,
        *([] if share is None else [marked("word", Markup("{} {}").format(bar(share, percent), percent))]),
        Markup('<div class="meaning">{}</div>').format(described.effect),
    ]


def _data_sheet(axis: Axis, value: float) -> Markup:
    """The value in the unit of data sheets, below it; empty for other parameters."""
    if axis.name not in DATA_SHEET:
        return Markup()
    factor, unit = DATA_SHEET[axis.name]
    return Markup("<br/>") + marked("note", f"{significant(factor * value, 3)} {unit}")


def _track(axis: Axis, values: Numbers) -> Markup:
    """Range with a dot at the first value and ticks at the other values."""
    marks = [Markup('<i style="left:{:.1f}%"></i>').format(100.0 * axis.unit(value)) for value in values]
    words = f"{100.0 * axis.unit(values[0]):.0f} % of the way"
    return Markup('<span class="track" role="img" aria-label="{}">{}</span>').format(words, Markup().join(marks))
