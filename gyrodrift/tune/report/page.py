"""Report of a tuning: one HTML file with result, scores and method."""

from dataclasses import replace

import numpy as np
from markupsafe import Markup

from gyrodrift.evaluation.dataset import Split
from gyrodrift.evaluation.space import Axis
from gyrodrift.report.numbers import significant
from gyrodrift.report.page import Section, marked, page
from gyrodrift.report.provenance import Provenance, UsedFile, provenance
from gyrodrift.tune.report.charts import DOTS, density_chart, highest_drawn, search_chart, slice_chart
from gyrodrift.tune.report.files import config_text
from gyrodrift.tune.report.head import head
from gyrodrift.tune.report.parameters import alternatives, found_value, parameters, value_found
from gyrodrift.tune.report.sessions import by_session, over_time
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


USES = {Split.TRAIN: "training", Split.TEST: "test"}

METHODS = {
    "race": "learning automata search the whole space in batches, then several local searches compete",
    "carla": "continuous action reinforcement learning automata, one for each parameter, as published",
    "cma": "CMA-ES, with restarts of growing populations",
    "de": "differential evolution",
    "random": "random points",
}


def report_html(tuning: Tuning, made: Provenance) -> str:
    """Page of a tuning with its provenance."""
    used = [UsedFile(score.session.name, score.session.digest, USES[score.split]) for score in tuning.scores]
    sections = [
        head(tuning, made.set_name),
        alternatives(tuning),
        parameters(tuning),
        search(tuning),
        over_time(tuning),
        by_session(tuning),
        _method(tuning),
        provenance(replace(made, sessions=used, config_text=config_text(tuning))),
    ]
    return page(f"{tuning.filter.title or tuning.filter.name} tuned on {made.set_name}", sections)


def _method(tuning: Tuning) -> Section:
    """Method, cost, seeds and time, with the results of all seeds if there are several."""
    runs = sorted((tuning.run, *tuning.other_runs), key=lambda run: run.seed)
    values = {
        "tuning": tuning,
        "method": METHODS.get(tuning.method),
        "runs": runs,
        "has_test": tuning.run.pi.test is not None,
        "cells": pi_cells,
        "value_found": value_found,
    }
    return Section("tune/report/templates/method.html", values, "Method")
