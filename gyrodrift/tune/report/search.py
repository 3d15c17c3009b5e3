"""Search section of a tuning report: Figure 1, cost by iteration; Figure 2, densities of the parameters."""

from collections.abc import Sequence

import numpy as np

from gyrodrift.evaluation.space import Axis
from gyrodrift.html.html import figure, headings, legend, panels, section, span, table, text
from gyrodrift.html.numbers import significant
from gyrodrift.tune.report.figures import DOTS, density_svgs, highest_drawn, search_svg, slice_svgs
from gyrodrift.tune.report.numbering import figure_name, table_name
from gyrodrift.tune.report.parameters import parameter
from gyrodrift.tune.result import Pi, Tuning


def search(tuning: Tuning) -> str:
    """The section of both figures and the table of the cost."""
    cost = figure(f"{figure_name(1, published=6)} {_search_words(tuning)}", search_svg(tuning), "compact")
    names = [_density_name(tuning, axis) for axis in tuning.axes]
    where = figure(f"{figure_name(2, published=7)} {_density_words(tuning)}", panels(names, density_svgs(tuning)))
    return section("The search", cost, _pi_table(tuning), _slices(tuning, names), where)


def _slices(tuning: Tuning, names: Sequence[str]) -> str:
    """The figure of the slices; empty without slices."""
    svgs = slice_svgs(tuning)
    if not svgs:
        return ""
    marks = [("note", "dot", "an evaluation, light in the first half of the search"), ("tuned", "key", "slice")]
    caption = (
        "<b>Cost against each parameter.</b> The slice varies one parameter; all others have the values found. A flat "
        f"slice is a parameter that these sessions do not determine.<br/>{legend(marks)}"
    )
    return figure(caption, panels(names, svgs))


def _search_words(tuning: Tuning) -> str:
    history = tuning.run.history
    finite = history[np.isfinite(history)]
    sentences = [
        "The cost PI by iteration on the training sessions, on a logarithmic scale. A dot is one parameter vector."
    ]
    sentences += [f"Seed {tuning.run.seed}.<br/>{_search_legend(tuning)}<br/>"]
    if len(finite) > DOTS:
        sentences += [f"Of {len(finite)} evaluations every {-(-len(finite) // DOTS)}th is drawn."]
    above = int(np.count_nonzero(finite > highest_drawn(tuning)))
    if above:
        sentences += [f"{above} with a higher cost {'are' if above > 1 else 'is'} outside of the figure."]
    if len(finite) < len(history):
        sentences += [
            f"{len(history) - len(finite)} have an infinite cost: the filter is unstable with their parameters."
        ]
    return " ".join(sentences)


def _search_legend(tuning: Tuning) -> str:
    marks = [("note", "dot", "an evaluation"), ("tuned", "key", "best so far")]
    marks += [("tuned", "key thin", "other seeds")] if tuning.other_runs else []
    marks += [
        ("plain", "key dashed", "plain integration"),
        ("two", "key dotted", f"filter with {tuning.filter.reduced_model.title} tuned"),
    ]
    return legend(marks)


def _density_name(tuning: Tuning, axis: Axis) -> str:
    described = tuning.filter.parameter(axis.name)
    unit = f", {described.unit}" if described.unit else ""
    return f"<b>{text(axis.name)}{unit}</b>" + span(f"found: {parameter(tuning, axis)}", "note")


def _density_words(tuning: Tuning) -> str:
    upright = "The vertical line is the value found"
    even = "; the dotted line at 1 is no preference."
    if tuning.run.densities is None:
        return f"Density of the last third of the search. {upright}{even}"
    return (
        "Densities of the automata at the end of the search, relative to the start. A narrow peak is a parameter that "
        f"matters. {upright}, which may differ from the peak{even}"
    )


def _pi_table(tuning: Tuning) -> str:
    rows = [
        ("plain integration", tuning.euler),
        (f"filter with {tuning.filter.reduced_model.title} tuned", tuning.reduced),
        ("tuned filter", tuning.run.pi),
    ]
    has_test = any(pi.test is not None for _, pi in rows)
    head = headings(["PI, deg²", "training", *["test"] * has_test])
    cells = [[name, *pi_cells(pi, has_test=has_test)] for name, pi in rows]
    return table(f"{table_name(2)} The cost: mean over the sessions of the mean squared yaw error.", head, cells)


def pi_cells(pi: Pi, *, has_test: bool) -> list[str]:
    """Cells of the cost, deg²: training sessions, and test sessions if there are any."""
    test = "–" if pi.test is None else significant(pi.test, 4)
    return [significant(pi.train, 4), *[test] * has_test]
