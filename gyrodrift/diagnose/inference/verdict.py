"""From scores to words: what stands out, which causes with what probability, what is left, how far the gap shrank."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import NamedTuple

import numpy as np

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import Effect
from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.features.vector import FEATURES, NUMBER
from gyrodrift.diagnose.inference.evidence import Evidence
from gyrodrift.diagnose.inference.search import GAIN, Attribution, Cause, Found

STANDS_OUT = 4.5
LEFT_OVER = 5.0
"""Normal deviates over all sessions at which a feature counts as off, before and after causes are added."""

WORST_Z = 20.0
EXPLAINED = 0.4
"""A cause that takes away less of what stands out than this is no explanation."""

TIED, TIED_SHARE = 3.0, 0.025
PLAUSIBLE = 2.0
"""In logarithms of likelihood: alternatives within TIED are tied, sizes within PLAUSIBLE belong to the interval. Of the
same group they are tied within TIED_SHARE of what the cause explains as well: effects that look alike differ most in
what is not exact in either."""

BOOTSTRAPS = 2000
PROBABILITY = np.array([2.8, -4.0, -6.0, -1.8])
"""A logistic curve over a constant and what Tells holds: fitted to 154 causes named in development cases of the blind
check, of which three in four were right. How much a cause gains says nothing more once it gains enough to be named."""


class Kind(StrEnum):
    """What is said of the gap."""

    NONE = "none"
    EFFECT = "effect"
    PARTLY = "partly"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class Parameter:
    """A fitted parameter with the sizes that would do nearly as well."""

    name: str
    value: float
    low: float
    high: float
    unit: str


@dataclass(frozen=True, slots=True)
class NamedCause:
    """An effect that is held to act."""

    cause: Cause
    effect: Effect
    group: str
    probability: float
    parameters: tuple[Parameter, ...]
    tied_with: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Deviation:
    """A feature that is off; z over all sessions, and its share of all that is."""

    stage: str
    feature: str
    regime: str
    says: str
    z: float
    share: float = 0.0


@dataclass(frozen=True, slots=True)
class SimToRealGap:
    """Root mean square of what the features are off, at most 20 each, on sessions kept apart from the fit."""

    before: float
    after: float
    floor: float
    shrink: float | None
    shrink_low: float | None
    shrink_high: float | None


@dataclass(frozen=True, slots=True)
class Verdict:
    """All that attribution says."""

    kind: Kind
    causes: tuple[NamedCause, ...]
    where: tuple[Deviation, ...]
    leftover: tuple[Deviation, ...]
    gap: SimToRealGap
    after_z: Floats = field(repr=False)


def verdict_of(attribution: Attribution, found: Found) -> Verdict:
    """Judge what was found."""
    evidence = attribution.evidence
    after_z = _after(attribution, found)
    before, after = together(evidence.z), together(after_z)
    is_off = np.abs(before) > STANDS_OUT
    strangers = [cause for cause in found.causes if cause.is_strange]
    strange = _strange(attribution, found, strangers)
    leftover = _worst_first([*strange, *_odd(after, LEFT_OVER)])
    causes = _named(attribution, found, before, after)
    kind = _kind(causes, is_off, before, after, leftover)
    where = _odd(before, STANDS_OUT)
    if kind is Kind.UNKNOWN and strangers:
        first = strange[0]  # what it depends on says more than what else that moves
        where = _shared([first, *(odd for odd in where if odd.feature != first.feature)])
    return Verdict(
        kind=kind,
        causes=causes,
        where=where,
        leftover=leftover if causes else where,
        gap=_gap(evidence, after_z if causes else evidence.z, may_shrink=kind is not Kind.NONE),
        after_z=after_z,
    )


def together(z: Floats) -> Floats:
    """(F,) one normal deviate for all sessions: a common shift, or a scatter of either sign, whichever is clearer."""
    count = len(z)
    shift = z.mean(axis=0) * np.sqrt(count)
    scatter = np.linalg.norm(z, axis=0) - np.sqrt(count)
    found: Floats = np.where(scatter > np.abs(shift), scatter * np.where(shift < 0.0, -1.0, 1.0), shift)
    return found


def _after(attribution: Attribution, found: Found) -> Floats:
    """(sessions, F) what is left of each session's z under sizes fitted on the others."""
    evidence = attribution.evidence
    if not found.causes:
        return evidence.z
    count = len(evidence.names)
    z = np.empty_like(evidence.z)
    for left in range(count):
        others = [session for session in range(count) if session != left] or None
        causes = attribution.fitted(found.causes, others)
        change, variance, allowance = attribution.prediction(causes)
        z[left] = ((evidence.difference - change) / np.sqrt(evidence.sigma**2 + variance + allowance))[left]
    return z


def _strange(attribution: Attribution, found: Found, strangers: Sequence[Cause]) -> list[Deviation]:
    """What was explained by no effect, by the feature it stands for; its z is what it would be without."""
    odd = []
    for cause in strangers:
        kept = tuple(other for other in found.causes if other is not cause)
        change, variance, allowance = attribution.prediction(kept)
        evidence = attribution.evidence
        z = together((evidence.difference - change) / np.sqrt(evidence.sigma**2 + variance + allowance))
        number = NUMBER[cause.name.removeprefix("?")]
        one = FEATURES[number]
        odd.append(Deviation(one.stage, one.name, one.regime, one.says, float(z[number])))
    return odd


def _worst_first(odd: Sequence[Deviation]) -> tuple[Deviation, ...]:
    """Each feature once."""
    by_name: dict[str, Deviation] = {}
    for one in sorted(odd, key=lambda one: -abs(one.z)):
        by_name.setdefault(one.feature, one)
    return _shared(list(by_name.values()))


def _shared(odd: Sequence[Deviation]) -> tuple[Deviation, ...]:
    """With the share that each has in all of them."""
    squares = [min(abs(one.z), WORST_Z) ** 2 for one in odd]
    total = sum(squares) or 1.0
    return tuple(replace(one, share=square / total) for one, square in zip(odd, squares, strict=True))


def _odd(deviates: Floats, threshold: float) -> tuple[Deviation, ...]:
    order = [int(number) for number in np.argsort(-np.abs(deviates)) if abs(deviates[number]) > threshold]
    return _shared(
        [
            Deviation(
                FEATURES[number].stage,
                FEATURES[number].name,
                FEATURES[number].regime,
                FEATURES[number].says,
                float(deviates[number]),
            )
            for number in order
        ]
    )


def _kind(
    causes: Sequence[NamedCause], is_off: Mask, before: Floats, after: Floats, leftover: Sequence[Deviation]
) -> Kind:
    if not causes:
        return Kind.UNKNOWN if is_off.any() else Kind.NONE
    explained = _explained(is_off, before, after)
    if leftover and explained < EXPLAINED:
        return Kind.UNKNOWN
    return Kind.PARTLY if leftover else Kind.EFFECT


def _explained(is_off: Mask, before: Floats, after: Floats) -> float:
    """Share of what stands out that the causes take away."""
    if not is_off.any():
        return 1.0
    held = [np.square(np.minimum(np.abs(deviates[is_off]), WORST_Z)).sum() for deviates in (before, after)]
    return float(1.0 - held[1] / held[0])


def _named(attribution: Attribution, found: Found, before: Floats, after: Floats) -> tuple[NamedCause, ...]:
    is_off = np.abs(before) > STANDS_OUT
    left = float(np.clip(1.0 - _explained(is_off, before, after), 0.0, 1.0))
    named = []
    for cause in found.causes:
        if cause.is_strange:
            continue
        kept = tuple(other for other in found.causes if other is not cause)
        lost = (
            float(found.scores.sum() - attribution.judged(kept).scores.sum())
            if kept
            else _over_nothing(attribution, found)
        )
        rivals = _rivals(attribution, found, cause, kept, lost)
        weight = float(np.exp([rival[1] / 2.0 for rival in rivals]).sum())
        tells = Tells(weight, left, is_random=cause.answer.candidate.realisations > 1)
        named.append(
            NamedCause(
                cause=cause,
                effect=effect_of(attribution, found, cause),
                group=cause.answer.candidate.group,
                probability=probability_of(tells),
                parameters=_parameters(attribution, found, cause),
                tied_with=tuple(name for name, behind in rivals if behind > -TIED and name in CATALOGUE),
            )
        )
    # Of causes that are as good as equally probable, first what is not left to chance.
    return tuple(sorted(named, key=lambda one: (-round(one.probability, 1), one.cause.answer.candidate.realisations)))


class Tells(NamedTuple):
    """What the probability of a cause goes by.

    rivals
        How much others could take its place: 1 for one that does as well.
    left
        Share of what stands out that all causes together leave.
    is_random
        Whether chance plays a part in it, so that it fits much.
    """

    rivals: float
    left: float
    is_random: bool


def probability_of(tells: Tells) -> float:
    """That the cause acts."""
    columns = np.array([1.0, np.log1p(tells.rivals), tells.left, tells.is_random])
    return float(np.clip(1.0 / (1.0 + np.exp(-columns @ PROBABILITY)), 0.01, 0.99))


def _over_nothing(attribution: Attribution, found: Found) -> float:
    return float(found.scores.sum() - attribution.nothing.scores.sum())


def _rivals(
    attribution: Attribution, found: Found, cause: Cause, kept: tuple[Cause, ...], lost: float
) -> list[tuple[str, float]]:
    """Other candidates in the place of a cause, and by how much they score less (negative), in a scale of TIED."""
    group, taken = cause.answer.candidate.group, {cause.name, *(other.name for other in kept)}
    rivals = []
    for one in attribution.with_one_more(Found(kept, found.scores)):
        rival = one.causes[-1]
        wide = max(TIED, TIED_SHARE * lost) if rival.answer.candidate.group == group else TIED
        behind = min(one.total - found.total, 0.0) * TIED / wide
        if rival.name not in taken and behind > -4.0 * TIED:
            rivals.append((rival.name, behind))
    return rivals


def profile(attribution: Attribution, found: Found, cause: Cause) -> tuple[Floats, Floats]:
    """Sizes of a cause, and the score of the whole set at each."""
    others = tuple(other for other in found.causes if other is not cause)
    return cause.answer.candidate.sizes, attribution.curve(others, cause.answer).sum(axis=1)


def best_size(attribution: Attribution, found: Found, cause: Cause) -> float:
    """Between the sizes of the grid: the top of a parabola through the best and its neighbours."""
    sizes, totals = profile(attribution, found, cause)
    at = int(np.argmax(totals))
    if not 0 < at < len(sizes) - 1 or sizes[at - 1] * sizes[at + 1] <= 0.0:
        return float(sizes[at])
    left, middle, right = totals[at - 1 : at + 2]
    bend = left - 2.0 * middle + right
    shift = 0.5 * (left - right) / bend if bend < 0.0 else 0.0
    ratio = sizes[at + 1] / sizes[at] if shift > 0.0 else sizes[at] / sizes[at - 1]
    return float(sizes[at] * ratio**shift)


def effect_of(attribution: Attribution, found: Found, cause: Cause) -> Effect:
    """The effect of the simulator at the fitted size."""
    return cause.answer.candidate.make(best_size(attribution, found, cause))


UNITS = {
    "percent": "%",
    "percent_fs": "% of full scale",
    "percent_per_c": "%/°C",
    "dps_per_c": "deg/s/°C",
    "dps": "deg/s",
    "deg": "deg",
    "ms": "ms",
    "hz": "Hz",
    "ppm": "ppm",
    "dph": "deg/h",
    "dps_rts": "deg/s/√s",
    "dps_at_100_dps": "deg/s at 100 deg/s",
    "s": "s",
    "per_hour": "1/h",
    "cpr": "counts per turn",
}


def unit_of(parameter: str) -> str:
    """Unit of a parameter, by the end of its name."""
    ends = [end for end in UNITS if parameter == end or parameter.endswith(f"_{end}")]
    return UNITS[max(ends, key=len)] if ends else ""


def _parameters(attribution: Attribution, found: Found, cause: Cause) -> tuple[Parameter, ...]:
    sizes, totals = profile(attribution, found, cause)
    plausible = sizes[totals > totals.max() - PLAUSIBLE]
    best = best_size(attribution, found, cause)
    make, name = cause.answer.candidate.make, cause.answer.candidate.parameter
    ends = sorted(float(getattr(make(float(size)), name)) for size in (plausible[0], plausible[-1], best))
    found_parameters = [Parameter(name, float(getattr(make(best), name)), ends[0], ends[-1], unit_of(name))]
    for other, value in make(best).model_dump().items():
        if other not in {name, "name"}:
            found_parameters.append(Parameter(other, value, value, value, unit_of(other)))
    return tuple(found_parameters)


def _gap(evidence: Evidence, after_z: Floats, *, may_shrink: bool) -> SimToRealGap:
    """Where there is no gap, chance has nothing to close."""
    before, after = _by_session(evidence.z), _by_session(after_z)
    floor = float(np.sqrt(np.square(_by_session(evidence.nulls)).mean()))
    whole = _shrink(before, after, floor) if may_shrink else None
    dice = np.random.default_rng(0)
    drawn = dice.integers(len(before), size=(BOOTSTRAPS, len(before)))
    spread = [_shrink(before[rows], after[rows], floor) for rows in drawn]
    known = [value for value in spread if value is not None]
    low, high = np.quantile(known, [0.05, 0.95]) if known and whole is not None else (None, None)
    return SimToRealGap(
        _total(before),
        _total(after),
        floor,
        whole,
        None if low is None else float(low),
        None if high is None else float(high),
    )


def _by_session(z: Floats) -> Floats:
    found: Floats = np.sqrt(np.square(np.minimum(np.abs(z), WORST_Z)).mean(axis=1))
    return found


def _total(by_session: Floats) -> float:
    return float(np.sqrt(np.square(by_session).mean()))


def _shrink(before: Floats, after: Floats, floor: float) -> float | None:
    """Of the gap above the floor, how much is closed; None where there was none."""
    high = _total(before)
    return (high - max(_total(after), floor)) / (high - floor) if high > floor * 1.05 else None


def detectable(attribution: Attribution) -> dict[str, dict[str, float | str]]:
    """Of each effect, the smallest size that these sessions would have shown."""
    found: dict[str, dict[str, float | str]] = {}
    sigma = attribution.evidence.sigma
    for answer in (one for one in attribution.answers if not one.candidate.is_out_of_catalogue):
        gains = 2.5 * np.log1p(np.square(answer.mean) / (4.0 * sigma**2)).sum(axis=(1, 2))
        at = np.flatnonzero(gains > 2.0 * GAIN)
        if not len(at):
            continue
        smallest = min((float(answer.candidate.sizes[number]) for number in at), key=abs)
        effect = answer.candidate.make(smallest)
        name = answer.candidate.parameter
        value = abs(float(getattr(effect, name)))
        known = found.get(answer.candidate.name)
        if known is None or value < float(known[name]):
            found[answer.candidate.name] = {name: value, "unit": unit_of(name)}
    return found
