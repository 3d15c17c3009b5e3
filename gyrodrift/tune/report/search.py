"""Search section of a tuning's report: cost by iteration, slices, and densities of the parameters."""

import numpy as np
from markupsafe import Markup

from gyrodrift.evaluation.space import Axis
from gyrodrift.report.numbers import significant
from gyrodrift.report.page import Section, marked
from gyrodrift.tune.report.charts import DOTS, density_chart, highest_drawn, search_chart, slice_chart
from gyrodrift.tune.report.parameters import found_value
from gyrodrift.tune.result import Pi, Tuning


def search(tuning: Tuning) -> Section:
    """The section of the search."""
    names = [_parameter_name(tuning, axis) for axis in tuning.axes]
    costs = (tuning.euler, tuning.reduced, tuning.run.pi)
    history = tuning.run.history
    finite = history[np.isfinite(history)]
    values = {
        "tuning": tuning,
        "chart": search_chart(tuning),
        "finite": len(finite),
        "every": -(-len(finite) // DOTS),
        "above": int(np.count_nonzero(finite > highest_drawn(tuning))),
        "infinite": len(history) - len(finite),
        "has_test": any(pi.test is not None for pi in costs),
        "cells": pi_cells,
        "slices": [(name, slice_chart(tuning, number)) for number, name in enumerate(names) if tuning.slices.size],
        "densities": [(name, density_chart(tuning, number)) for number, name in enumerate(names)],
    }
    return Section("tune/report/templates/search.html", values, "The search")


def _parameter_name(tuning: Tuning, axis: Axis) -> Markup:
    described = tuning.filter.parameter(axis.name)
    name = f"{axis.name}, {described.unit}" if described.unit else axis.name
    return Markup("<b>{}</b>{}").format(name, marked("note", f"found: {found_value(tuning, axis)}"))


def pi_cells(pi: Pi, *, has_test: bool) -> list[str]:
    """Cells of the cost, deg²: training sessions, and test sessions if there are any."""
    test = "–" if pi.test is None else significant(pi.test, 4)
    return [significant(pi.train, 4), *[test] * has_test]
