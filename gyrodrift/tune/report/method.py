"""Method section of a tuning report: method, cost, seeds and time."""

from gyrodrift.html.html import facts, headings, paragraph, section, table, text
from gyrodrift.html.numbers import significant
from gyrodrift.tune.report.parameters import value_found
from gyrodrift.tune.report.search import pi_cells
from gyrodrift.tune.result import Tuning

METHODS = {
    "race": "learning automata search the whole space in batches, then several local searches compete",
    "carla": "continuous action reinforcement learning automata, one for each parameter, as published",
    "cma": "CMA-ES, with restarts of growing populations",
    "de": "differential evolution",
    "random": "random points",
}

COST = (
    "PI: squared yaw error, averaged over each session and then over the sessions with equal weight; deg². E: absolute "
    "yaw error, averaged over a session; deg. NE: E divided by the duration of the session; deg/min. These are the "
    "measures of Borenstein and Ojeda, 2009. Yaw and reference are unwrapped and start at 0."
)


def how_it_was_done(tuning: Tuning) -> str:
    """The section of the method."""
    rows = [
        ("Method", _method(tuning.method)),
        ("Cost", COST),
        ("Evaluations", f"{tuning.evaluations} for each seed"),
        ("Seed", _seed_words(tuning)),
        ("Sample rate", f"{tuning.sample_rate_hz:.6g} Hz"),
        ("Duration", f"{significant(tuning.seconds, 3)} s"),
    ]
    note = paragraph("Published: number of the figure or table in the publication of the method.", "note")
    return section("Method", facts(rows), _seeds_table(tuning), note)


def _method(name: str) -> str:
    return f"<b>{text(name)}</b>: {METHODS[name]}" if name in METHODS else f"<b>{text(name)}</b>"


def _seed_words(tuning: Tuning) -> str:
    if not tuning.other_runs:
        return str(tuning.run.seed)
    seeds = ", ".join(str(run.seed) for run in tuning.other_runs)
    return f"{tuning.run.seed}, the best on the training sessions; also searched: {seeds}"


def _seeds_table(tuning: Tuning) -> str:
    """Table of the results of all seeds; empty for one seed."""
    if not tuning.other_runs:
        return ""
    runs = sorted((tuning.run, *tuning.other_runs), key=lambda run: run.seed)
    has_test = tuning.run.pi.test is not None
    head = headings(["seed", "PI training", *["PI test"] * has_test, *(text(axis.name) for axis in tuning.axes)])
    rows = [
        [
            f"<b>{run.seed}</b>" if run is tuning.run else str(run.seed),
            *pi_cells(run.pi, has_test=has_test),
            *(significant(value_found(run, axis), 3) for axis in tuning.axes),
        ]
        for run in runs
    ]
    return table("Every seed, the chosen one in bold. PI in deg².", head, rows)
