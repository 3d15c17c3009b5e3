"""Which candidates explain the differences: scored by likelihood, fitted together, judged on sessions left out.

A hypothesis is a set of candidates with sizes. It predicts a mean and a spread for every feature of every session;
the score is the logarithm of a Student density with few degrees of freedom, so that no single feature decides.
A candidate is never the exact form of a real effect: what it changes may be off by a share of the change, and what it
does to one regressor leaks a little to the others. Without that allowance the remains of a large true cause would
be explained by a crowd of small wrong ones.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.vector import IS_LOG, STATIC
from gyrodrift.diagnose.inference.evidence import Answer, Evidence

FREEDOM = 4.0
OFF, LEAK = 0.1, 0.04
"""Shares of its own change by which a candidate may be off, in the same feature and in other regressors."""

GAIN = 6.0
STANDARD_ERRORS = 1.0
"""A cause has to raise the score of sessions left out by GAIN and by so many standard errors of the gain."""

STRANGE_COST = 4.0
"""What no effect of the catalogue does has to explain more by so much than what one of them does."""

CAUSES_MOST = 4
ANCHORS = 2
SWEEPS = 3
SHORT_LIST = 4
CLOSE = 20.0
"""What is so far behind in the tables needs no simulation of its own."""

COARSE = 4
"""Pairs are first tried with every fourth size."""


@dataclass(frozen=True, slots=True)
class Cause:
    """A candidate at one of its sizes."""

    answer: Answer
    at: int

    @property
    def name(self) -> str:
        """Of the effect."""
        return self.answer.candidate.name

    @property
    def is_strange(self) -> bool:
        """Whether it is no effect of the catalogue."""
        return self.answer.candidate.is_out_of_catalogue

    @property
    def size(self) -> float:
        """In the units of the candidate's sizes."""
        return float(self.answer.candidate.sizes[self.at])


@dataclass(frozen=True, slots=True)
class Found:
    """A set of causes, and how it scores.

    scores
        (sessions,) each under sizes fitted on the others.
    """

    causes: tuple[Cause, ...]
    scores: Floats

    @property
    def names(self) -> tuple[str, ...]:
        """Of the effects."""
        return tuple(cause.name for cause in self.causes)

    @property
    def total(self) -> float:
        """Of all sessions, less the price of what no effect does."""
        return float(self.scores.sum()) - STRANGE_COST * sum(cause.is_strange for cause in self.causes)


class Attribution:
    """The search over sets of causes, on evidence that does not change."""

    def __init__(self, evidence: Evidence, simulate: Callable[[Sequence[Cause]], Floats]) -> None:
        self.evidence = evidence
        self.answers = evidence.answers
        self._simulate = simulate
        self._corrections: dict[frozenset[Answer], Floats] = {}
        self.nothing = Found((), self.scores(()))

    def prediction(self, causes: Sequence[Cause]) -> tuple[Floats, Floats, Floats]:
        """Change of the features, the variance that chance adds to it, and the allowance; (sessions, F) each."""
        change = np.zeros_like(self.evidence.difference)
        variance, allowance = np.zeros_like(change), np.zeros_like(change)
        for cause in causes:
            mean = cause.answer.mean[cause.at]
            change = _joined(change, mean)
            variance = variance + np.square(cause.answer.spread[cause.at])
            allowance = allowance + _allowance(mean, self.evidence.difference)
        return change + self._correction(frozenset(cause.answer for cause in causes)), variance, allowance

    def _correction(self, answers: frozenset[Answer]) -> Floats | float:
        """What the tables get wrong of the set, or of the largest part of it that was simulated as a whole."""
        parts = [part for part in self._corrections if part <= answers]
        return self._corrections[max(parts, key=len)] if parts else 0.0

    def anchored(self, causes: Sequence[Cause]) -> tuple[Cause, ...]:
        """Simulate a set as it is, so that neither interpolation nor addition of its tables matters; fit again."""
        now = tuple(causes)
        for _ in range(ANCHORS):
            answers = frozenset(cause.answer for cause in now)
            correction = self._corrections.pop(answers, None)
            exact = self._simulate(now)
            parts = frozenset(part for part in self._corrections if part <= answers)
            held = {part: self._corrections.pop(part) for part in parts}
            self._corrections[answers] = exact - self.prediction(now)[0]
            self._corrections |= held
            again = self.fitted(now)
            if again == now or correction is not None:
                break
            now = again
        return now

    def scores(self, causes: Sequence[Cause]) -> Floats:
        """(sessions,) logarithm of the likelihood of each session's features."""
        change, variance, allowance = self.prediction(causes)
        return _score(self.evidence.difference - change, self.evidence.sigma**2 + variance, allowance)

    def curve(self, others: Sequence[Cause], answer: Answer, step: int = 1) -> Floats:
        """(sizes, sessions) scores when a candidate joins others, at each of its sizes."""
        change, variance, allowance = self.prediction(others)
        mean = answer.mean[::step]
        both = frozenset([*(cause.answer for cause in others), answer])
        if (others and both in self._corrections) or not others:
            change = change + self._correction(both) - self._correction(both - {answer})
        off = self.evidence.difference - _joined(change, mean)
        widened = self.evidence.sigma**2 + variance + np.square(answer.spread[::step])[:, None]
        return _score(off, widened, allowance + _allowance(mean, self.evidence.difference))

    def fitted(self, causes: Sequence[Cause], sessions: Sequence[int] | None = None) -> tuple[Cause, ...]:
        """The same candidates with the best sizes together, and each in the best of its variants."""
        used = slice(None) if sessions is None else list(sessions)
        now = list(causes)
        for _ in range(SWEEPS if len(now) > 1 else 1):
            before = [(cause.answer, cause.at) for cause in now]
            for number, cause in enumerate(now):
                others = now[:number] + now[number + 1 :]
                now[number] = self._best_of(others, self._variants(cause.name), used)
            if [(cause.answer, cause.at) for cause in now] == before:
                break
        return tuple(now)

    def _best_of(self, others: Sequence[Cause], answers: Iterable[Answer], used: slice | list[int]) -> Cause:
        best, best_score = None, -np.inf
        for answer in answers:
            totals = self.curve(others, answer)[:, used].sum(axis=1)
            at = int(np.argmax(totals))
            if best is None or totals[at] > best_score:
                best, best_score = Cause(answer, at), float(totals[at])
        assert best is not None  # noqa: S101 - a name has at least one variant
        return best

    def _variants(self, name: str) -> list[Answer]:
        return [answer for answer in self.answers if answer.candidate.name == name]

    def judged(self, causes: Sequence[Cause]) -> Found:
        """Fit on all sessions, and score each under sizes fitted on the others."""
        whole = self.anchored(self.fitted(causes))
        count = len(self.evidence.names)
        if count == 1:
            return Found(whole, self.scores(whole))
        scores = np.empty(count)
        for left in range(count):
            others = [session for session in range(count) if session != left]
            scores[left] = self.scores(self.fitted(whole, others))[left]
        return Found(whole, scores)

    def with_one_more(self, found: Found) -> list[Found]:
        """The set with each further candidate, best first."""
        rest = [name for name in self.names() if name not in found.names]
        tried = [self._best_of(found.causes, self._variants(name), slice(None)) for name in rest]
        totals = [self.scores((*found.causes, cause)).sum() for cause in tried]
        order = [number for number in np.argsort(totals)[::-1][:SHORT_LIST] if totals[number] > max(totals) - CLOSE]
        judged = [self.judged((*found.causes, tried[number])) for number in order]
        return sorted(judged, key=lambda one: -one.total)

    def names(self) -> list[str]:
        """Of the candidates, each once."""
        return list(dict.fromkeys(answer.candidate.name for answer in self.answers))

    def pairs(self) -> list[Found]:
        """The best of all pairs: two that hide each other show only together."""
        best: list[tuple[float, tuple[Cause, Cause]]] = []
        chosen = [self._best_of((), self._variants(name), slice(None)).answer for name in self.names()]
        for number, first in enumerate(chosen):
            for at in range(0, len(first.candidate.sizes), COARSE):
                held = (Cause(first, at),)
                for second in chosen[number + 1 :]:
                    totals = self.curve(held, second, COARSE).sum(axis=1)
                    where = int(np.argmax(totals))
                    best.append((float(totals[where]), (held[0], Cause(second, where * COARSE))))
        best.sort(key=lambda one: -one[0])
        seen: dict[frozenset[str], Found] = {}
        for _, pair in best:
            names = frozenset(cause.name for cause in pair)
            if names not in seen:
                seen[names] = self.judged(pair)
            if len(seen) == 2:
                break
        return sorted(seen.values(), key=lambda one: -one.total)

    def search(self) -> Found:
        """The set that no addition, exchange or removal makes better by enough."""
        found = self.nothing
        while len(found.causes) < CAUSES_MOST:
            more = self.with_one_more(found)
            if found is self.nothing and not (more and self._pays(more[0], found)):
                return found
            if not more or not self._pays(more[0], found):
                break
            found = more[0]
            if len(found.causes) == 1:
                found = max([found, *self.pairs_that_pay(found)], key=lambda one: one.total)
            elif len(found.causes) > 1:
                found = self._exchanged(found)
        return self._without_idle(found)

    def pairs_that_pay(self, single: Found) -> list[Found]:
        """Pairs that are worth their second cause beside the best single one."""
        return [pair for pair in self.pairs() if self._pays(pair, single)]

    def _pays(self, longer: Found, shorter: Found) -> bool:
        """Whether a longer set gains enough on sessions left out, and not by making everything uncertain."""
        gains = longer.scores - shorter.scores
        error = float(gains.std(ddof=1) * np.sqrt(len(gains))) if len(gains) > 1 else 0.0
        if longer.total - shorter.total <= GAIN + STANDARD_ERRORS * error:
            return False
        added = [cause for cause in longer.causes if cause.name not in shorter.names]
        return all(self._told(longer.causes, cause) > GAIN for cause in added)

    def _told(self, causes: Sequence[Cause], one: Cause) -> float:
        """What is gained by where a cause moves the features, beside one that spreads them as widely."""
        change, variance, allowance = self.prediction(causes)
        without = self.prediction(_without(causes, one))[0]
        wide = self.evidence.sigma**2 + variance
        moved = _score(self.evidence.difference - change, wide, allowance)
        unmoved = _score(self.evidence.difference - without, wide, allowance)
        return float((moved - unmoved).sum())

    def _exchanged(self, found: Found) -> Found:
        """Try each other candidate in the place of each cause."""
        best = found
        for number in range(len(found.causes)):
            kept = found.causes[:number] + found.causes[number + 1 :]
            base = Found(kept, found.scores)
            more = self.with_one_more(base)
            if more and more[0].total > best.total:
                best = more[0]
        return best

    def _without_idle(self, found: Found) -> Found:
        """Drop what no longer pays beside the others."""
        while len(found.causes) > 1:
            shorter = [self.judged(_without(found.causes, cause)) for cause in found.causes]
            best = max(shorter, key=lambda one: one.total)
            if self._pays(found, best):
                return found
            found = best
        return found


def _without(causes: Sequence[Cause], one: Cause) -> tuple[Cause, ...]:
    return tuple(cause for cause in causes if cause is not one)


def _joined(change: Floats, more: Floats) -> Floats:
    """Two changes at once: logarithms of variances add as variances, all else as it is."""
    added = change + more
    both = np.log(np.maximum(np.exp(np.clip(change, -20, 20)) + np.exp(np.clip(more, -20, 20)) - 1.0, 1e-6))
    joined: Floats = np.where(IS_LOG & (change > 0.0) & (more > 0.0), both, added)
    return joined


def _allowance(mean: Floats, difference: Floats) -> Floats:
    """Variance for not being the exact form: a share of the change itself, and of all that goes to the regressors.

    But no more than of what there is to explain, or far too large a cause would excuse everything.
    """
    variance: Floats = np.square(OFF * np.minimum(np.abs(mean), np.abs(difference)))
    leaks = LEAK * np.minimum(_static(mean), _static(difference))
    variance[..., :STATIC] += leaks**2
    return variance


def _static(change: Floats) -> Floats:
    """(…, 1) length of what goes to the regressors."""
    length: Floats = np.linalg.norm(change[..., :STATIC], axis=-1, keepdims=True)
    return length


def _score(off: Floats, variance: Floats, allowance: Floats) -> Floats:
    """Sum over features of the logarithm of a Student density; an allowance is no spread, and costs nothing."""
    squares = np.square(off) / (FREEDOM * (variance + allowance))
    densities = -0.5 * (FREEDOM + 1.0) * np.log1p(squares) - 0.5 * np.log(variance)
    total: Floats = densities.sum(axis=-1)
    return total
