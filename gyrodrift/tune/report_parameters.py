"""The parameters in the report of a tuning: Table 1, with where each lies in its range and what it does."""

from gyrodrift.page.html import headings, paragraph, section, span, table, text
from gyrodrift.page.numbers import Numbers, significant
from gyrodrift.tune.caveats import bound_of
from gyrodrift.tune.result import Run, Tuning
from gyrodrift.tune.space import Axis

UNITS = {"i_c_dps": "deg/s per sample", "tau_s": "s", "theta_w_dps": "deg/s"}

MEANINGS = {
    "i_c_dps": "How far the drift estimate moves at each sample. Small: drift is learnt slowly. "
    "Large: the estimate hunts to and fro.",
    "tau_s": "How long the rate is averaged before its sign is looked at. Small: the noise of single samples decides. "
    "Large: it decides late.",
    "theta_w_dps": "Turn switch: above this rate nothing is learnt. Small: learns only near rest, and a bias larger "
    "than this never. Large: slow turns pass for drift.",
    "c1": "How strongly the step shrinks while the rate keeps its sign. 0: not at all. Large: long runs count little.",
    "c2": "How steeply it shrinks as the run gets longer. Small: hardly. Above 1: what one run can correct is bounded.",
}


def found(run: Run, axis: Axis) -> float:
    """The value that a search found, in the unit of the parameter."""
    return float(getattr(run.params, axis.name))


def parameter(tuning: Tuning, axis: Axis) -> str:
    """The value that was chosen, with four digits."""
    return significant(found(tuning.run, axis), 4)


def parameters(tuning: Tuning) -> str:
    """The section of Table 1."""
    spread = [f"over {1 + len(tuning.others)} seeds"] if tuning.others else []
    head = headings(["parameter", "found", *spread, "searched", "where in its range", "what it does"], words=2)
    rows = [_row(tuning, axis) for axis in tuning.axes]
    caption = "<b>Table 1.</b> The parameters found."
    if any(bound_of(axis, found(tuning.run, axis)) for axis in tuning.axes):
        caption += (
            " A value at a bound asks for a wider range (<code>--range NAME=LOW:HIGH</code>), unless the filter itself "
            "ends there, as c1 and c2 do at 0."
        )
    return section("Parameters", table(caption, head, rows, words=2), _two_note(tuning))


def _row(tuning: Tuning, axis: Axis) -> list[str]:
    unit = f" {span(UNITS[axis.name], 'note')}" if axis.name in UNITS else ""
    values = [found(run, axis) for run in (tuning.run, *tuning.others)]
    spread = [f"{significant(min(values), 3)} – {significant(max(values), 3)}"] if tuning.others else []
    searched = f"{significant(axis.low, 4)} – {significant(axis.high, 4)}"
    bound = bound_of(axis, values[0])
    mark = span(f"at the {bound} bound", "mark") if bound else ""
    meaning = f'<div class="meaning">{MEANINGS.get(axis.name, "")}</div>'
    chosen = f"<b>{parameter(tuning, axis)}</b>"
    return [f"{text(axis.name)}{unit}", chosen, *spread, searched, _track(axis, values) + mark, meaning]


def _track(axis: Axis, values: Numbers) -> str:
    """A range with a dot at the value and ticks at those of the other seeds."""
    places = [4.0 + 120.0 * axis.unit(value) for value in values]
    ticks = "".join(f'<path d="M{x:.1f} 3V13" stroke="var(--quiet)" stroke-width="1.2"/>' for x in places[1:])
    return (
        f'<svg class="track" viewBox="0 0 128 16" role="img" aria-label="{100 * axis.unit(values[0]):.0f} % of the '
        f'way"><path d="M4 8H124" stroke="var(--grid)" stroke-width="4" stroke-linecap="round"/>{ticks}'
        f'<circle cx="{places[0]:.1f}" cy="8" r="4" fill="var(--tuned)"/></svg>'
    )


def _two_note(tuning: Tuning) -> str:
    two = tuning.two_params
    return paragraph(
        "The filter with two parameters, without low-pass and attenuator, was tuned too: "
        f"i_c_dps {significant(two.i_c_dps, 4)}, theta_w_dps {significant(two.theta_w_dps, 4)}. Where it does about "
        "as well on the test sessions, the other three parameters earn nothing.",
        "note",
    )
