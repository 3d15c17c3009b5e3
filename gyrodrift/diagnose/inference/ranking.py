"""Every effect in a row: what each alone would explain, what it adds to the causes found, and which look alike."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.inference.detectable import CLEAR_GAIN
from gyrodrift.diagnose.inference.deviations import explained_share
from gyrodrift.diagnose.inference.evidence import Evidence, Response
from gyrodrift.diagnose.inference.family_wise import pooled_z
from gyrodrift.diagnose.inference.fit import best_of
from gyrodrift.diagnose.inference.likelihood import DEGREES_OF_FREEDOM
from gyrodrift.diagnose.inference.parameters import unit_of
from gyrodrift.diagnose.inference.surrogate import Cause, Surrogate

HINTED = 3.0
"""Log-likelihood from which on an effect that is not accepted is worth a look: twenty to one, before it is counted how
many were tried."""

ALIKE = 0.8
"""Cosine of two responses from which on they are called alike."""


@dataclass(frozen=True, slots=True)
class Ranked:
    """A candidate at the size that fits best by itself.

    gain
        Of the log-likelihood over the rig as it stands, all sessions together.
    gain_beside
        The same over the causes that were found, when it joins them at its best size; None for these causes.
    takes_away
        Share of what deviates; below 0 where it adds to it, None where nothing deviates.
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


def ranking(surrogate: Surrogate, causes: Sequence[Cause]) -> tuple[Ranked, ...]:
    """Effects of the catalogue, the best first."""
    names = dict.fromkeys(response.candidate.name for response in _effects(surrogate.evidence))
    return tuple(sorted((_ranked(surrogate, causes, name) for name in names), key=lambda one: -one.gain))


def _ranked(surrogate: Surrogate, causes: Sequence[Cause], name: str) -> Ranked:
    responses = surrogate.evidence.variants(name)
    curves = [curve.sum(axis=1) for curve in surrogate.curves((), responses)]
    at = int(np.argmax([curve.max() for curve in curves]))
    candidate = responses[at].candidate
    beside = None
    if name not in {cause.name for cause in causes}:
        totals = [curve.sum(axis=1).max() for curve in surrogate.curves(causes, responses)]
        beside = float(max(totals) - surrogate.scores(causes).sum())
    cause = Cause(responses[at], int(np.argmax(curves[at])))
    return Ranked(
        name,
        candidate.stage,
        candidate.group,
        float(getattr(candidate.make(cause.size), candidate.parameter)),
        unit_of(candidate.parameter),
        float(curves[at].max() - surrogate.scores(()).sum()),
        beside,
        _taken_away(surrogate, cause),
    )


def _taken_away(surrogate: Surrogate, cause: Cause) -> float | None:
    """Model discrepancy excuses nothing here: it is asked what the cause itself takes away."""
    evidence = surrogate.evidence
    predicted = surrogate.prediction((cause,))
    before = pooled_z(evidence.z) / evidence.caution
    left = (evidence.difference - predicted.change) / np.sqrt(evidence.variance_with(predicted.variance))
    after = pooled_z(left) / evidence.caution
    deviates = np.abs(before) > evidence.stands_out
    return explained_share(deviates, before, after) if deviates.any() else None


def would_explain(surrogate: Surrogate) -> tuple[Cause, ...]:
    """Effects each of which, at its best size, leaves nothing that stands out; the best first.

    Beside an unknown gap they are what shows too weakly to be named.
    """
    evidence = surrogate.evidence
    names = dict.fromkeys(response.candidate.name for response in _effects(evidence))
    found: list[tuple[float, Cause]] = []
    for name in names:
        cause = best_of(surrogate, (), evidence.variants(name))
        left = pooled_z(surrogate.standardised_residuals((cause,))) / evidence.caution
        if float(np.abs(left).max()) < evidence.stands_out:
            found.append((float(surrogate.scores((cause,)).sum()), cause))
    return tuple(cause for _, cause in sorted(found, key=lambda pair: -pair[0]))


def hinted(surrogate: Surrogate) -> tuple[Cause, ...]:
    """Of the effects that leave nothing that stands out, those that gain something; the best first."""
    nothing = float(surrogate.scores(()).sum())
    return tuple(one for one in would_explain(surrogate) if surrogate.scores((one,)).sum() - nothing > HINTED)


def lookalikes(evidence: Evidence) -> tuple[Alike, ...]:
    """Pairs of effects that these sessions hardly separate, the closest first."""
    directions = [(response.candidate.name, _direction(evidence, response)) for response in _effects(evidence)]
    closest: dict[tuple[str, str], float] = {}
    for number, (first, one) in enumerate(directions):
        for second, other in directions[number + 1 :]:
            cosine = abs(float(one @ other))
            if first != second and cosine > max(ALIKE, closest.get((first, second), 0.0)):
                closest[first, second] = cosine
    pairs = sorted(closest.items(), key=lambda pair: -pair[1])
    return tuple(Alike(first, second, cosine) for (first, second), cosine in pairs)


def _effects(evidence: Evidence) -> list[Response]:
    """Of the catalogue."""
    return [response for response in evidence.responses if not response.candidate.is_out_of_catalogue]


def _direction(evidence: Evidence, response: Response) -> Floats:
    """What a candidate does, in sigmas, at the smallest size that would be seen; length 1, or 0."""
    changes = response.mean / evidence.sigma
    gains = _gains_of(changes)
    seen = np.flatnonzero(gains > CLEAR_GAIN)
    at = seen[np.argmin(gains[seen])] if len(seen) else np.argmax(gains)
    change = changes[at].ravel()
    length = float(np.linalg.norm(change))
    unit: Floats = change / length if length > 0.0 else change
    return unit


def _gains_of(change: Floats) -> Floats:
    """(sizes,) log-likelihood that a change, (sizes, sessions, F) in sigmas, costs a rig that does not have it."""
    squares = np.square(change) / DEGREES_OF_FREEDOM
    gains: Floats = 0.5 * (DEGREES_OF_FREEDOM + 1.0) * np.log1p(squares).sum(axis=(1, 2))
    return gains
