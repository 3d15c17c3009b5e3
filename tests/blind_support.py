"""For the tests of scoring: what a `diagnose` might say, and cases that it says it of."""

from typing import Any

from blind.gap import Outcome, read_outcome
from blind.tried import RUNS, Tried, tried_of

ROWS = {"none": "baseline_none"}
"""Row of a kind of case, where it has another name."""


def gap(verdict: str, *causes: dict[str, Any], where: str = "sensor", leftover: str = "", **numbers: float) -> Any:
    """A `gap.json`; numbers go into its gap."""
    return {
        "verdict": verdict,
        "causes": list(causes),
        "where": [{"stage": where, "signature": "rate", "regime": "moving", "z": 12.0, "share": 0.8}],
        "leftover": [{"stage": leftover, "signature": "step", "regime": "late", "z": 5.0, "share": 0.5}]
        if leftover
        else [],
        "gap": {"before": 4.0, "after": 0.9, "floor": 0.8, "shrink": 0.97, **numbers},
    }


def cause(effect: str, probability: float = 0.9, *tied_with: str, **parameters: float) -> dict[str, Any]:
    """One of its causes."""
    stated = {name: {"value": value, "low": value, "high": value, "unit": "?"} for name, value in parameters.items()}
    return {"effect": effect, "group": "?", "probability": probability, "parameters": stated, "tied_with": tied_with}


def outcome(statement: Any, seconds: float = 30.0, status: int = 0, *, is_late: bool = False) -> Outcome:
    return read_outcome({"seconds": seconds, "timed_out": is_late, "exit_status": status, "gap": statement})


def case(
    kind: str,
    statement: Any = None,
    effects: dict[str, dict[str, float]] | None = None,
    size: str = "typical",
    stages: tuple[str, ...] = ("sensor",),
    withhold: str = "",
    row: str = "",
    **other_runs: Any,
) -> Tried:
    """A case and the statement on it; `other_runs` are those that are no blind ones."""
    label = {
        "case": "c0ffee",
        "kind": kind,
        "size": size,
        "about": "of a test",
        "effects": [{"name": name, "parameters": parameters} for name, parameters in (effects or {}).items()],
        "stages": stages,
        "withhold": withhold,
        "row": row or ROWS.get(kind, kind),
        "seed": 9,
        "number": 2,
    }
    outcomes = {run: outcome(other_runs.get(run)) for run in RUNS[1:]}
    return tried_of(label, {"blind": outcome(statement), **outcomes})
