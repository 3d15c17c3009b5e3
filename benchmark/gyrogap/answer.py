"""An answer: causes with probabilities and parameters, and the probabilities of no gap and of an unknown cause."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gyrodrift.values.errors import DataError
from gyrogap.json_files import read_json
from gyrogap.physics.kinds import InjectedEffect
from gyrogap.vocabulary import PARAMETERS, effect_of_answer

NAMED_FROM = 0.5
"""Probability from which a cause is named."""

LARGEST = 1e300
"""Largest size of a number; an integer of JSON can be larger than any float."""

SURE_ABOVE = 0.8
"""Probability above which a cause is stated with confidence."""


@dataclass(frozen=True, slots=True)
class AnsweredCause:
    """An effect with its probability; parameters in the units of `effects.json`, those that the answer states."""

    effect: str
    probability: float
    parameters: Mapping[str, float]

    @property
    def injected(self) -> InjectedEffect:
        """The effect in the physics of the benchmark."""
        return effect_of_answer(self.effect, self.parameters)


@dataclass(frozen=True, slots=True)
class BenchmarkAnswer:
    """Answer to a case; causes from the most to the least probable.

    none, unknown
        Probability that there is no gap, and that the cause is not in the vocabulary.
    """

    causes: tuple[AnsweredCause, ...] = ()
    none: float = 0.0
    unknown: float = 0.0

    @property
    def verdict(self) -> str:
        """`none`, `unknown` or `cause`, whichever has the largest probability; the first of them if equal."""
        top = self.causes[0].probability if self.causes else 0.0
        chances = {"none": self.none, "unknown": self.unknown, "cause": top}
        return max(chances, key=lambda name: chances[name])

    @property
    def top(self) -> AnsweredCause | None:
        """The most probable cause, if the verdict is a cause, or it is named beside an unknown part of the gap."""
        if not self.causes or self.verdict == "none":
            return None
        return self.causes[0] if self.verdict == "cause" or self.causes[0].probability >= NAMED_FROM else None

    @property
    def named(self) -> tuple[AnsweredCause, ...]:
        """Causes with a probability from NAMED_FROM, and the top cause."""
        return tuple(cause for cause in self.causes if cause.probability >= NAMED_FROM or cause is self.top)


def read_answer(path: Path) -> BenchmarkAnswer | None:
    """Answer of a file; None without the file.

    Raises
    ------
    DataError
        It is no answer; the message says what is wrong.
    """
    return answer_of(read_json(path), path) if path.exists() else None


def answer_of(stated: Any, path: Path) -> BenchmarkAnswer:
    """Answer from the content of a file."""
    if not isinstance(stated, dict) or not isinstance(stated.get("causes"), list):
        raise DataError(f"{path}: needs an object with the keys causes (a list), none and unknown")
    causes = [_cause(cause, path) for cause in stated["causes"]]
    names = [cause.effect for cause in causes]
    if len(set(names)) < len(names):
        raise DataError(f"{path}: names an effect twice")
    ordered = sorted(causes, key=lambda cause: -cause.probability)
    chances = (_probability(stated.get(name), name, path) for name in ("none", "unknown"))
    return BenchmarkAnswer(tuple(ordered), *chances)


def _cause(stated: Any, path: Path) -> AnsweredCause:
    effect = stated.get("effect") if isinstance(stated, dict) else None
    if not isinstance(effect, str) or effect not in PARAMETERS:
        raise DataError(f"{path}: effect {effect!r} is not in effects.json")
    parameters, names = stated.get("parameters", {}), {parameter.name for parameter in PARAMETERS[effect]}
    if not isinstance(parameters, dict) or not all(is_number(value) for value in parameters.values()):
        raise DataError(f"{path}: parameters of {effect} must be numbers by name")
    for name in parameters:
        if name not in names:
            raise DataError(f"{path}: {effect} has no parameter {name!r}; it has {', '.join(sorted(names))}")
    values = {name: float(value) for name, value in parameters.items()}
    return AnsweredCause(effect, _probability(stated.get("probability"), effect, path), values)


def _probability(stated: Any, name: str, path: Path) -> float:
    if not is_number(stated) or not 0.0 <= stated <= 1.0:
        raise DataError(f"{path}: the probability of {name} is {stated!r}, expected a number from 0 to 1")
    return float(stated)


def is_number(value: Any) -> bool:
    """Whether a value of JSON is a number that a float can be."""
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= LARGEST
