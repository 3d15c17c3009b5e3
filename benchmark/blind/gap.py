"""What a run of `diagnose` said: its `gap.json`, read strictly, so that a malformed one counts as a failure."""

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

VERDICTS = ("none", "effect", "partly", "unknown")


@dataclass(frozen=True, slots=True)
class Cause:
    """An effect that was named; parameters by name, values alone; `in_rig`: those that the rig states otherwise.

    intervals
        Least and largest value by parameter.
    """

    effect: str
    probability: float
    tied_with: tuple[str, ...] = ()
    parameters: dict[str, float] = field(default_factory=dict)
    in_rig: dict[str, float] = field(default_factory=dict)
    intervals: dict[str, tuple[float, float]] = field(default_factory=dict)

    @property
    def names(self) -> set[str]:
        """The effect and what it is tied with."""
        return {self.effect, *self.tied_with}


@dataclass(frozen=True, slots=True)
class Said:
    """The verdict and what belongs to it.

    where, leftover
        Stages, worst first.
    after, shrink
        Of the gap; None where it says nothing.
    detectable
        Smallest size that would have been seen, and the other parameters that it holds for, by effect and parameter.
    """

    verdict: str
    causes: tuple[Cause, ...] = ()
    where: tuple[str, ...] = ()
    leftover: tuple[str, ...] = ()
    after: float | None = None
    shrink: float | None = None
    detectable: dict[str, dict[str, float]] = field(default_factory=dict)

    @property
    def named(self) -> tuple[Cause, ...]:
        """Causes that the verdict stands for: a list beside "none" or "unknown" names nothing."""
        return self.causes if self.verdict in {"effect", "partly"} else ()


@dataclass(frozen=True, slots=True)
class Outcome:
    """One run: what it said, or why it said nothing; and how long it took, s."""

    said: Said | None
    failure: str
    seconds: float

    @property
    def names_causes(self) -> bool:
        """Whether there is a verdict that stands for a cause."""
        return self.said is not None and bool(self.said.named)

    @property
    def text(self) -> str:
        """For a list of misses."""
        if self.said is None:
            return f"failed: {self.failure}"
        causes = [_cause_text(cause) for cause in self.said.causes]
        words = [self.said.verdict, *causes]
        if self.said.verdict in {"unknown", "partly"}:
            stages = self.said.where if self.said.verdict == "unknown" else self.said.leftover
            words.append(f"left at {stages[0] if stages else 'no stage'}")
        return ", ".join(words)


def _cause_text(cause: Cause) -> str:
    ties = f" (or {', '.join(cause.tied_with)})" if cause.tied_with else ""
    wrong = f" (in the rig with {', '.join(f'{value:g}' for value in cause.in_rig.values())})" if cause.in_rig else ""
    return f"{cause.effect}{wrong}{ties} {cause.probability:.2f}"


def load_json(path: Path) -> Any:
    """What a file holds; None where there is none or it is no JSON."""
    try:
        return json.loads(path.read_text())
    except (OSError, ValueError):
        return None


def read_outcome(result: Any) -> Outcome:
    """A result file of the runner; one that is missing is a failure like any other."""
    if not isinstance(result, dict):
        return Outcome(None, "there is no result", 0.0)
    seconds = float(result["seconds"])
    if result["timed_out"]:
        return Outcome(None, "too late", seconds)
    if result["exit_status"] != 0:
        return Outcome(None, f"exit status {result['exit_status']}", seconds)
    try:
        return Outcome(read_gap(result["gap"]), "", seconds)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        return Outcome(None, f"gap.json: {type(error).__name__}: {error}", seconds)


def read_gap(gap: Any) -> Said:
    """Check and take over; whatever is wrong raises one of the errors that wrong values raise."""
    if gap["verdict"] not in VERDICTS:
        raise ValueError(f"verdict is {gap['verdict']!r}")
    return Said(
        verdict=gap["verdict"],
        causes=tuple(_cause(cause) for cause in gap["causes"]),
        where=tuple(str(signature["stage"]) for signature in gap["where"]),
        leftover=tuple(str(signature["stage"]) for signature in gap["leftover"]),
        after=_number_or_none(gap["gap"].get("after")),
        shrink=_number_or_none(gap["gap"].get("shrink")),
        detectable={
            str(effect): _numbers(least) | _numbers(least.get("at", {}))
            for effect, least in gap.get("detectable", {}).items()
        },
    )


def _cause(cause: Any) -> Cause:
    probability = float(cause["probability"])
    if not 0.0 <= probability <= 1.0:
        raise ValueError(f"probability is {probability}")
    parameters = {str(name): float(stated["value"]) for name, stated in cause["parameters"].items()}
    in_rig = _numbers(cause.get("in_rig", {}))
    stated = cause["parameters"].items()
    intervals = {str(name): (float(one["low"]), float(one["high"])) for name, one in stated if _is_bounded(one)}
    return Cause(str(cause["effect"]), probability, tuple(map(str, cause["tied_with"])), parameters, in_rig, intervals)


def _is_bounded(stated: Any) -> bool:
    return stated["low"] is not None and stated["high"] is not None


def _numbers(stated: Any) -> dict[str, float]:
    """Values by parameter, without units."""
    return {str(name): float(value) for name, value in stated.items() if isinstance(value, int | float)}


def _number_or_none(value: Any) -> float | None:
    return None if value is None else float(value)
