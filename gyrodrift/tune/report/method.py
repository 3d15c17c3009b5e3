"""How it was done, in the report of a tuning: method, cost, seeds and time."""

from gyrodrift.html.html import facts, headings, paragraph, section, table, text
from gyrodrift.html.numbers import significant
from gyrodrift.tune.report.parameters import found
from gyrodrift.tune.report.search import pi_cells
from gyrodrift.tune.result import Tuning

METHODS = {
    "race": "learning automata look over the whole space in batches, and local searches race from where they point",
    "carla": "continuous action reinforcement learning automata, one a parameter, as published",
    "cma": "CMA-ES, with restarts of growing populations",
    "de": "differential evolution",
    "random": "points at random",
}

COST = (
    "PI: the squared yaw error, averaged over each session and then over the sessions, so that each counts the same "
    "however long; deg². E: the absolute yaw error, averaged over a session; deg. NE: E divided by the session's true "
    "duration; deg/min. These are the measures of Borenstein and Ojeda, 2009. Yaw and reference are unwrapped and "
    "start at 0."
)


def how_it_was_done(tuning: Tuning) -> str:
    """The section of the method."""
    rows = [
        ("Method", _method(tuning.method)),
        ("Cost", COST),
        ("Evaluations", f"{tuning.evaluations} a seed"),
        ("Seed", _seed_words(tuning)),
        ("Sample rate", f"{tuning.sample_rate_hz:.6g} Hz"),
        ("Took", f"{significant(tuning.seconds, 3)} s"),
    ]
    note = paragraph("Published: the number that a figure or table has in the published method.", "note")
    return section("How it was done", facts(rows), _seeds_table(tuning), note)


def _method(name: str) -> str:
    return f"<b>{text(name)}</b>: {METHODS[name]}" if name in METHODS else f"<b>{text(name)}</b>"


def _seed_words(tuning: Tuning) -> str:
    if not tuning.others:
        return str(tuning.run.seed)
    others = ", ".join(str(run.seed) for run in tuning.others)
    return f"{tuning.run.seed}, the best on the training sessions; also searched: {others}"


def _seeds_table(tuning: Tuning) -> str:
    """What every seed found, where there was more than one."""
    if not tuning.others:
        return ""
    runs = sorted((tuning.run, *tuning.others), key=lambda run: run.seed)
    has_test = tuning.run.pi.test is not None
    head = headings(["seed", "PI training", *["PI test"] * has_test, *(text(axis.name) for axis in tuning.axes)])
    rows = [
        [
            f"<b>{run.seed}</b>" if run is tuning.run else str(run.seed),
            *pi_cells(run.pi, has_test=has_test),
            *(significant(found(run, axis), 3) for axis in tuning.axes),
        ]
        for run in runs
    ]
    return table("Every seed, the chosen one in bold. PI in deg².", head, rows)
