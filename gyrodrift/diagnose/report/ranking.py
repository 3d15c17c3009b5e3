"""Every effect in a row: what each alone would explain, what it adds to the causes found, and which look alike."""

from dataclasses import dataclass

import numpy as np

from firmware_sim.effects.catalogue import CATALOGUE
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.diagnosis import Drawn
from gyrodrift.diagnose.inference.evidence import Answer
from gyrodrift.diagnose.inference.search import GAIN, Attribution, Cause
from gyrodrift.diagnose.inference.verdict import STANDS_OUT, WORST_Z, together, unit_of

ALIKE = 0.8
"""Cosine of two answers from which on they are called alike."""


@dataclass(frozen=True, slots=True)
class Ranked:
    """A candidate at the size that fits best by itself.

    gain
        Of the logarithm of the likelihood over the rig as it stands, all sessions together.
    gain_beside
        The same over the causes that were found, when it joins them at its best size; None for these causes.
    takes_away
        Share of what stands out; below 0 where it adds to it, None where nothing stands out.
    """

    name: str
    stage: str
    group: str
    value: float
    unit: str
    gain: float
    gain_beside: float | None
    takes_away: float | None


@dataclass(frozen=True, slots=True)
class Alike:
    """Two candidates that change the features of these sessions in nearly the same proportions."""

    first: str
    second: str
    cosine: float


def ranking(drawn: Drawn) -> list[Ranked]:
    """The best first."""
    names = [name for name in drawn.attribution.names() if name in CATALOGUE]
    return sorted((_ranked(drawn, name) for name in names), key=lambda one: -one.gain)


def _ranked(drawn: Drawn, name: str) -> Ranked:
    attribution, causes = drawn.attribution, drawn.found.causes
    answers = [answer for answer in attribution.answers if answer.candidate.name == name]
    curves = [attribution.curve((), answer).sum(axis=1) for answer in answers]
    at = int(np.argmax([curve.max() for curve in curves]))
    candidate = answers[at].candidate
    beside = None
    if name not in drawn.found.names:
        totals = [attribution.curve(causes, answer).sum(axis=1).max() for answer in answers]
        beside = float(max(totals) - attribution.scores(causes).sum())
    cause = Cause(answers[at], int(np.argmax(curves[at])))
    return Ranked(
        name,
        candidate.stage,
        candidate.group,
        float(getattr(candidate.make(cause.size), candidate.parameter)),
        unit_of(candidate.parameter),
        float(curves[at].max() - attribution.scores(()).sum()),
        beside,
        _taken_away(attribution, cause),
    )


def _taken_away(attribution: Attribution, cause: Cause) -> float | None:
    evidence = attribution.evidence
    change, variance, _ = attribution.prediction((cause,))
    before = np.abs(together(evidence.z))
    after = np.abs(together((evidence.difference - change) / np.sqrt(evidence.sigma**2 + variance)))
    is_off = before > STANDS_OUT
    if not is_off.any():
        return None
    held = [np.square(np.minimum(deviates[is_off], WORST_Z)).sum() for deviates in (before, after)]
    return float(1.0 - held[1] / held[0])


def lookalikes(attribution: Attribution) -> list[Alike]:
    """Pairs that these sessions hardly separate, the closest first."""
    effects = [answer for answer in attribution.answers if answer.candidate.name in CATALOGUE]
    directions = [(answer.candidate.name, _direction(attribution, answer)) for answer in effects]
    closest: dict[tuple[str, str], float] = {}
    for number, (first, one) in enumerate(directions):
        for second, other in directions[number + 1 :]:
            cosine = abs(float(one @ other))
            if first != second and cosine > max(ALIKE, closest.get((first, second), 0.0)):
                closest[first, second] = cosine
    pairs = sorted(closest.items(), key=lambda pair: -pair[1])
    return [Alike(first, second, cosine) for (first, second), cosine in pairs]


def _direction(attribution: Attribution, answer: Answer) -> Floats:
    """What a candidate does, in units of chance, at the smallest size that would be seen; length 1, or 0."""
    changes = answer.mean / attribution.evidence.sigma
    gains = 2.5 * np.log1p(np.square(changes) / 4.0).sum(axis=(1, 2))
    seen = np.flatnonzero(gains > 2.0 * GAIN)
    at = seen[np.argmin(gains[seen])] if len(seen) else np.argmax(gains)
    change = changes[at].ravel()
    length = float(np.linalg.norm(change))
    unit: Floats = change / length if length > 0.0 else change
    return unit
