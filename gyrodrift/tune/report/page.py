"""Report of a tuning, one HTML file: verdict, errors as tiles, scores, tables of parameters, and what to do next."""

from collections.abc import Sequence
from dataclasses import replace
from math import isfinite

import numpy as np
from markupsafe import Markup

from gyrodrift.evaluation.dataset import Split
from gyrodrift.evaluation.space import Axis
from gyrodrift.report.numbers import degrees, log_share, mean, significant
from gyrodrift.report.page import Section, marked, page
from gyrodrift.report.provenance import Provenance, UsedFile, provenance
from gyrodrift.tune.report.charts import DOTS, density_chart, highest_drawn, importances, search_chart, slice_chart
from gyrodrift.tune.report.files import config_text, verdict_words
from gyrodrift.tune.report.sessions import by_session, over_time
from gyrodrift.tune.result import Pi, Run, SessionScore, Tuning
from gyrodrift.tune.warnings import bound_of
from gyrodrift.values.constants import SECONDS_PER_HOUR
from gyrodrift.values.noise import ROOT_SECONDS_PER_ROOT_HOUR

USES = {Split.TRAIN: "training", Split.TEST: "test"}

METHODS = {
    "race": "learning automata search the whole space in batches, then several local searches compete",
    "carla": "continuous action reinforcement learning automata, one for each parameter, as published",
    "cma": "CMA-ES, with restarts of growing populations",
    "de": "differential evolution",
    "random": "random points",
}

DATA_SHEET = {
    "turn_on_dps": (SECONDS_PER_HOUR, "°/h"),
    "walk_dps_rts": (SECONDS_PER_HOUR * ROOT_SECONDS_PER_ROOT_HOUR, "°/h/√h"),
}
"""Factor and unit of data sheets for parameters that these quote."""

COLORS = {"euler": "plain", "start": "quiet"}


def head(tuning: Tuning, set_name: str) -> Section:
    """The head of the page."""
    plain_deg, tuned_deg, where = judged(tuning)
    test, train = tuning.scores_on(Split.TEST), tuning.scores_on(Split.TRAIN)
    in_config = verdict_words(tuning)
    values = {
        "tuning": tuning,
        "set_name": set_name,
        "headline": _default_headline(tuning) if tuning.is_default_written else _headline(plain_deg, tuned_deg, where),
        "test": _fall("test", len(test), *tuning.mean_e_deg(Split.TEST)) if test else None,
        "train": _fall("training", len(train), *tuning.mean_e_deg(Split.TRAIN)) if train else None,
        "held_out": _fall("", 0, plain_deg, tuned_deg) if tuning.cross_validation and not test else None,
        "in_config": in_config[:1].upper() + in_config[1:],
        "held_out_deg": (plain_deg, tuned_deg),
        "means": {
            kind: [_mean_deg(scores, name) for name in ("tuned", "euler", "reduced")]
            for kind, scores in (("test", test), ("training", train))
        },
        "counts": {"test": len(test), "training": len(train), "held out": len(tuning.cross_validation)},
        "parameters": [f"{axis.name} {found_value(tuning, axis)}" for axis in tuning.axes],
        "is_better": tuned_deg < plain_deg,
    }
    return Section("tune/report/templates/head.html", values)


def judged(tuning: Tuning) -> tuple[float, float, str]:
    """Mean E of plain integration and of the tuned filter, deg, on held-out sessions if there are any, and where."""
    if tuning.scores_on(Split.TEST):
        return *tuning.mean_e_deg(Split.TEST), "on held-out sessions"
    held_out = [score for score in tuning.scores if score.session.name in tuning.cross_validation]
    if held_out:
        plain_deg = mean([score.euler.e_deg for score in held_out])
        tuned_deg = mean([tuning.cross_validation[score.session.name].e_deg for score in held_out])
        return plain_deg, tuned_deg, "on sessions held out in turn"
    return *tuning.mean_e_deg(Split.TRAIN), "on the sessions it was tuned on"


def _headline(plain_deg: float, tuned_deg: float, where: str) -> str:
    if tuned_deg < plain_deg:
        return f"Yaw error falls from {degrees(plain_deg)} to {degrees(tuned_deg)} {where}"
    return f"No gain {where}: yaw error {degrees(tuned_deg)} tuned, {degrees(plain_deg)} by plain integration"


def _default_headline(tuning: Tuning) -> str:
    """Headline if no tuned filter is better than the defaults of a filter."""
    best = tuning.written
    if best is None:
        return "Defaults are best"
    e_deg = best.e_deg.train if best.e_deg.test is None else best.e_deg.test
    return f"No tuned filter is better than {best.title}: yaw error {degrees(e_deg)} on held-out sessions"


def _fall(kind: str, count: int, plain_deg: float, tuned_deg: float) -> dict[str, str]:
    """Names of the sessions, and errors of plain integration and of the tuned filter with their ratio in words."""
    sessions = f"the {count} {kind} sessions" if count > 1 else f"the one {kind} session"
    times = ""
    if 0.0 < tuned_deg < plain_deg < np.inf:
        factor = plain_deg / tuned_deg
        number = f"{factor:.1f}" if factor < 10.0 else significant(factor, 2)
        times = f", {number} times less" if factor >= 1.05 else ", almost the same"
    return {"sessions": sessions, "plain": degrees(plain_deg), "tuned": degrees(tuned_deg), "times": times}


def _mean_deg(scores: Sequence[SessionScore], name: str) -> float:
    """Mean E of plain integration, the tuned or the reduced filter."""
    return mean([getattr(score, name).e_deg for score in scores])


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
