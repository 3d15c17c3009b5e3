"""Report of a tuning: one HTML file with result, scores and method."""

from dataclasses import replace

from gyrodrift.evaluation.dataset import Split
from gyrodrift.report.page import Section, page
from gyrodrift.report.provenance import Provenance, UsedFile, provenance
from gyrodrift.tune.report.files import config_text
from gyrodrift.tune.report.head import head
from gyrodrift.tune.report.parameters import alternatives, parameters, value_found
from gyrodrift.tune.report.search import pi_cells, search
from gyrodrift.tune.report.sessions import by_session, over_time
from gyrodrift.tune.result import Tuning

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
