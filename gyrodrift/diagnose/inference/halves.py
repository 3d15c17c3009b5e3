"""Stability of a verdict: the same density on each half of the recordings, with the probable sets of the whole."""

from collections.abc import Sequence
from dataclasses import dataclass

from gyrodrift.diagnose.inference.conclusion import NAMED
from gyrodrift.diagnose.inference.explanation import Explanation
from gyrodrift.diagnose.inference.posterior import Posterior, posterior_of
from gyrodrift.diagnose.inference.scorer import EffectSet
from gyrodrift.diagnose.inference.sets import fitted

LEAST_SESSIONS = 4
"""Sessions from which on each half has two. Derived: a size of a single session is not checked by another."""

SETS = 8
"""Most probable sets that are fitted again. Chosen: together with no effect they hold nearly all of the posterior."""


@dataclass(frozen=True, slots=True)
class Halves:
    """Whether both halves of the recordings give the verdict of all, and a sentence that says so."""

    is_same: bool
    says: str


def on_halves(explanation: Explanation) -> Halves | None:
    """The verdict on every second session, and on the others; None with fewer than LEAST_SESSIONS."""
    sessions = explanation.scorer.observation.sessions
    if sessions < LEAST_SESSIONS:
        return None
    named = [_named(_posterior_of_part(explanation, range(first, sessions, 2))) for first in range(2)]
    whole = _named(explanation.posterior)
    is_same = all(_agree(whole, part) for part in named)
    if is_same:
        return Halves(True, f"the same on both halves of the recordings ({_words(whole)})")
    parts = "; ".join(
        f"{_words(part)} on sessions {', '.join(str(1 + row) for row in range(first, sessions, 2))}"
        for first, part in enumerate(named)
    )
    return Halves(False, f"not the same on both halves of the recordings: {parts}")


def _posterior_of_part(explanation: Explanation, rows: Sequence[int]) -> Posterior:
    """Posterior over the most probable sets, fitted to some of the sessions."""
    scorer = explanation.scorer.of_sessions(list(rows))
    sets = [scorer.nothing()]
    for effect_set in explanation.posterior.by_mass(0.0)[:SETS]:
        placed = tuple(item._replace(template=item.template.of_sessions(list(rows))) for item in effect_set.placed)
        if placed:
            sets.append(fitted(scorer, EffectSet(placed, 0.0, 0.0)))
    return posterior_of(scorer, sets)


def _named(posterior: Posterior) -> tuple[tuple[str, ...], ...]:
    """Named effects, each with its ties; `none` or `unknown` alone."""
    slots = [slot for slot in posterior.slots() if slot.total > NAMED]
    if posterior.no_gap > NAMED:
        return (("none",),)
    return tuple((slot.name, *slot.tied_with) for slot in slots) or (("unknown",),)


def _agree(whole: Sequence[Sequence[str]], part: Sequence[Sequence[str]]) -> bool:
    """Whether both name as many effects, and each of the whole, or an effect tied with it."""
    return len(whole) == len(part) and all(any({*first} & {*second} for second in part) for first in whole)


def _words(named: Sequence[Sequence[str]]) -> str:
    return " and ".join(" or ".join(names) for names in named)
