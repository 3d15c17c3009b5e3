"""Rules of the score: an answer beside the label of its case."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from gyrogap.answer import SURE_ABOVE, BenchmarkAnswer
from gyrogap.gap_closed import GapClosed
from gyrogap.vocabulary import GROUP_OF, JUDGED_BY, PARAMETERS

NEAR = 0.2
"""Relative error of a parameter up to which it is near."""

ABSTAINS_FROM = 0.5
"""Probability of `unknown` from which an answer abstains: part of the gap has no known cause."""


@dataclass(frozen=True, slots=True)
class JudgedCase:
    """An answer with the truth.

    truths
        Effects of the vocabulary in the case, with their parameters.
    answer
        None without a file: wrong in every respect.
    closed
        Share of the gap that it closes; None where this is not measured.
    """

    case: str
    row: str
    axes: int
    size: str
    about: str
    truths: Mapping[str, Mapping[str, float]]
    answer: BenchmarkAnswer | None
    closed: GapClosed | None = None

    @property
    def truth(self) -> str:
        """The effect of a case with one."""
        return next(iter(self.truths))

    @property
    def is_quiet(self) -> bool:
        """Whether the verdict is that there is no gap."""
        return self.answer is not None and self.answer.verdict == "none"

    @property
    def abstains(self) -> bool:
        """Whether it says that the cause, or a part of it, is unknown."""
        return self.answer is not None and self.answer.unknown >= ABSTAINS_FROM

    @property
    def effect_first(self) -> bool:
        """Whether the most probable cause is the truth."""
        top = None if self.answer is None else self.answer.top
        return top is not None and top.effect in self.truths

    @property
    def group_first(self) -> bool:
        """Whether the most probable cause is of the group of the truth."""
        top = None if self.answer is None else self.answer.top
        return top is not None and GROUP_OF[top.effect] in self.groups

    @property
    def groups(self) -> set[str]:
        """Groups of the true effects."""
        return {GROUP_OF[name] for name in self.truths}

    @property
    def names_all(self) -> bool:
        """Whether all true effects are named."""
        return self.answer is not None and set(self.truths) <= {cause.effect for cause in self.answer.named}

    @property
    def is_sure_and_wrong(self) -> bool:
        """Whether a cause above SURE_ABOVE is not there."""
        return any(effect not in self.truths for effect in self._sure)

    @property
    def is_sure_of_wrong_group(self) -> bool:
        """Whether a cause above SURE_ABOVE is of a group that is not there."""
        return any(GROUP_OF[effect] not in self.groups for effect in self._sure)

    @property
    def _sure(self) -> list[str]:
        causes = self.answer.causes if self.answer else ()
        return [cause.effect for cause in causes if cause.probability > SURE_ABOVE]

    @property
    def parameter_errors(self) -> list[float]:
        """Relative errors of the judged parameters of true effects that are named."""
        named = self.answer.named if self.answer else ()
        return [
            abs(cause.parameters.get(name, 0.0) / truth[name] - 1.0)
            for cause in named
            if (truth := self.truths.get(cause.effect)) and (name := JUDGED_BY.get(cause.effect, ""))
        ]

    @property
    def stated(self) -> list[tuple[float, bool]]:
        """Stated probabilities, of causes, none and unknown, with the outcome."""
        if self.answer is None:
            return []
        causes = [(cause.probability, cause.effect in self.truths) for cause in self.answer.causes]
        return [*causes, (self.answer.none, self.row == "none"), (self.answer.unknown, self.row == "outside")]

    @property
    def is_right(self) -> bool:
        """Whether the answer is right by the rule of its row."""
        match self.row:
            case "none":
                return self.is_quiet
            case "outside":
                return self.abstains
            case "pair":
                return self.names_all and not self.is_sure_and_wrong
            case "wrong_size":
                return self.effect_first and all(error <= NEAR for error in self.parameter_errors)
            case _:
                return self.effect_first


def judged_case(label: Mapping[str, Any], answer: BenchmarkAnswer | None, closed: GapClosed | None) -> JudgedCase:
    """A case from its label."""
    effects = label["effects"]
    return JudgedCase(
        case=label["case"],
        row=label["row"],
        axes=label.get("axes", 1),
        size=label["size"],
        about=label["about"],
        truths={effect["name"]: effect["parameters"] for effect in effects if effect["name"] in PARAMETERS},
        answer=answer,
        closed=closed,
    )
