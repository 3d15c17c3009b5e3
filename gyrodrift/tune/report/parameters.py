"""Table 1 in the report of a tuning: parameters with range, importance and meaning."""

from gyrodrift.evaluation.space import Axis
from gyrodrift.html.html import headings, paragraph, section, span, table, text
from gyrodrift.html.numbers import Numbers, significant
from gyrodrift.tune.report.figures import importances
from gyrodrift.tune.report.numbering import table_name
from gyrodrift.tune.result import Run, Tuning
from gyrodrift.tune.warnings import bound_of
from gyrodrift.values.constants import SECONDS_PER_HOUR
from gyrodrift.values.noise import ROOT_SECONDS_PER_ROOT_HOUR

DATA_SHEET = {
    "turn_on_dps": (SECONDS_PER_HOUR, "°/h"),
    "walk_dps_rts": (SECONDS_PER_HOUR * ROOT_SECONDS_PER_ROOT_HOUR, "°/h/√h"),
}
"""Factor and unit of data sheets for parameters that these quote."""


def value_found(run: Run, axis: Axis) -> float:
    """Value of a search result, in the unit of the parameter."""
    return float(getattr(run.params, axis.name))


def parameter(tuning: Tuning, axis: Axis) -> str:
    """Value found, with four digits."""
    return significant(value_found(tuning.run, axis), 4)


def parameters(tuning: Tuning) -> str:
    """The section of Table 1."""
    spread = [f"over {1 + len(tuning.other_runs)} seeds"] if tuning.other_runs else []
    importance = ["importance"] if tuning.slices.size else []
    columns = ["parameter", "found", *spread, "searched", *importance, "effect"]
    head = headings(columns, words=2)
    shares = importances(tuning.slices) if tuning.slices.size else None
    rows = [_row(tuning, axis, None if shares is None else float(shares[n])) for n, axis in enumerate(tuning.axes)]
    caption = f"{table_name(1, published=1)} The parameters found."
    if tuning.slices.size:
        caption += (
            " Importance: share of the parameter in how much the cost rises along the slices below "
            "(the mean of ln PI/least PI over the range)."
        )
    if any(bound_of(axis, value_found(tuning.run, axis)) for axis in tuning.axes):
        caption += (
            " For a value at a bound, widen the range (<code>--range NAME=LOW:HIGH</code>), unless it is a bound of "
            "the filter, such as c1 = 0."
        )
    return section("Parameters", table(caption, head, rows, words=2), _reduced_note(tuning))


def _row(tuning: Tuning, axis: Axis, importance: float | None) -> list[str]:
    described = tuning.filter.parameter(axis.name)
    unit = f" {span(described.unit, 'note')}" if described.unit else ""
    values = [value_found(run, axis) for run in (tuning.run, *tuning.other_runs)]
    spread = [f"{significant(min(values), 3)} – {significant(max(values), 3)}"] if tuning.other_runs else []
    searched = f"{significant(axis.low, 4)} – {significant(axis.high, 4)}"
    bound = bound_of(axis, values[0])
    mark = span(f"at the {bound} bound", "mark") if bound else ""
    meaning = f'<div class="meaning">{described.effect}</div>'
    shares = [] if importance is None else [_share(importance)]
    chosen = f"<b>{parameter(tuning, axis)}</b>{_data_sheet(axis, values[0])}"
    return [
        f"{text(axis.name)}{unit}",
        chosen,
        *spread,
        f"{searched}<br/>{_track(axis, values)} {mark}",
        *shares,
        meaning,
    ]


def _data_sheet(axis: Axis, value: float) -> str:
    """The value in the unit of data sheets, below it; empty for other parameters."""
    if axis.name not in DATA_SHEET:
        return ""
    factor, unit = DATA_SHEET[axis.name]
    return f"<br/>{span(f'{significant(factor * value, 3)} {unit}', 'note')}"


def _share(importance: float) -> str:
    """A bar with its percentage."""
    return (
        f'<svg class="track" viewBox="0 0 128 16" role="img" aria-label="{100 * importance:.0f} %">'
        f'<rect x="0" y="3" width="{84.0 * importance:.1f}" height="10" rx="2" fill="var(--tuned)"/>'
        f'<text x="{84.0 * importance + 4.0:.1f}" y="12.5" font-size="11" fill="currentColor">{100 * importance:.0f} %'
        "</text></svg>"
    )


def _track(axis: Axis, values: Numbers) -> str:
    """Range with a dot at the value and ticks at the values of other seeds."""
    places = [4.0 + 120.0 * axis.unit(value) for value in values]
    ticks = "".join(f'<path d="M{x:.1f} 3V13" stroke="var(--quiet)" stroke-width="1.2"/>' for x in places[1:])
    return (
        f'<svg class="track" viewBox="0 0 128 16" role="img" aria-label="{100 * axis.unit(values[0]):.0f} % of the '
        f'way"><path d="M4 8H124" stroke="var(--grid)" stroke-width="4" stroke-linecap="round"/>{ticks}'
        f'<circle cx="{places[0]:.1f}" cy="8" r="4" fill="var(--tuned)"/></svg>'
    )


def _reduced_note(tuning: Tuning) -> str:
    model = tuning.filter.reduced_model
    values = ", ".join(f"{name} {significant(getattr(tuning.reduced_params, name), 4)}" for name in model.names)
    return paragraph(
        f"Reduced model, with {model.title} tuned and the other parameters fixed: {values}. If it is about as good on "
        "the test sessions, the other parameters bring no gain.",
        "note",
    )
