"""The verdict from the response tables of all sessions, by the posterior over sets of effects."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.special import ndtri

from gyrodrift.diagnose.features.vector import FEATURES, NUMBER
from gyrodrift.diagnose.inference.density import Groups
from gyrodrift.diagnose.inference.evidence import Evidence, Response, pooled_z
from gyrodrift.diagnose.inference.explanation import Explanation
from gyrodrift.diagnose.inference.gap import Deviation, deviations, gap_of, listed, no_gap, returning_share
from gyrodrift.diagnose.inference.observation import observation_of
from gyrodrift.diagnose.inference.parameters import Parameter, unit_of
from gyrodrift.diagnose.inference.pooling import evidence_of
from gyrodrift.diagnose.inference.posterior import POWER, RARE, Posterior, Slot, WeightedSet, posterior_of
from gyrodrift.diagnose.inference.ridge import pair_in, summed_along
from gyrodrift.diagnose.inference.scorer import EffectSet, Placed, Scorer
from gyrodrift.diagnose.inference.sets import find_sets, fitted, known_forms, profile_of
from gyrodrift.diagnose.inference.template import Template, templates_of
from gyrodrift.diagnose.inference.verdict import Kind, NamedCause, Verdict
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.candidate_kind import CandidateKind
from gyrodrift.diagnose.simulate.candidates import KINDS
from gyrodrift.diagnose.simulate.response_table import ResponseTable, SimulatedSet, Sized
from gyrodrift.values.arrays import Floats

ODDS = 0.2
"""Prior odds of a tilt against a scale error that reduces the rate as much. Chosen: scale errors with a standard
deviation of 1.5 % (data sheets) and boards tilted by 3° about each level axis have odds of 0.23 at 1.2 %."""


def with_unseparated(posterior: Posterior, names: Sequence[str]) -> Posterior:
    """The posterior with untested effects; each takes a part of the probability of the effect that it acts like."""
    for name in names:
        posterior = Posterior(tuple(_divided(posterior.hypotheses, KINDS[name])))
    return posterior


def _divided(hypotheses: Sequence[WeightedSet], kind: CandidateKind) -> Iterator[WeightedSet]:
    for hypothesis in hypotheses:
        if not _may_be(hypothesis, kind):
            yield hypothesis
            continue
        yield replace(hypothesis, probability=hypothesis.probability / (1.0 + ODDS))
        names = (hypothesis.names - {kind.acts_like}) | {kind.name}
        yield replace(hypothesis, names=names, probability=hypothesis.probability * ODDS / (1.0 + ODDS))


def _may_be(hypothesis: WeightedSet, kind: CandidateKind) -> bool:
    """Whether the hypothesis has the effect that `kind` acts like, with the sign that `kind` can have."""
    sizes = [item.size for item in hypothesis.effect_set.placed if item.template.name == kind.acts_like]
    return kind.acts_like in hypothesis.names and any(size < 0.0 for size in sizes)


CREDIBLE = (0.025, 0.5, 0.975)
"""Quantiles: a central interval that holds the true size in 95 % of cases, and the median. Chosen: the convention."""


@dataclass(frozen=True, slots=True)
class SizePosterior:
    """Size of an effect in its most probable variant, in the unit of the candidate.

    is_low_open, is_high_open
        Whether the interval ends at the smallest or the largest size that was tried.
    variants
        All variants that were tried, with their probabilities given that the effect acts.
    """

    response: Response
    median: float
    low: float
    high: float
    is_low_open: bool = False
    is_high_open: bool = False
    variants: tuple[tuple[Candidate, float], ...] = ()


def size_posterior(scorer: Scorer, effect_set: EffectSet, name: str, power: float) -> SizePosterior:
    """Quantiles of the sizes in the most probable variant, weighted by prior and density to a power.

    If another effect of the set acts like this effect, the posterior is summed over the size of the other effect. The
    larger form error doubles the scatter of a random effect. A size that is read off the scatter would be too small by
    a third, so it has the smaller form error.
    """
    fixed = [placed for placed in effect_set.placed if placed.template.name != name]
    profile = profile_of(scorer, name, fixed)
    response = int(profile.best.template.response[profile.best.point])
    is_random = profile.best.sized.is_random
    sizes, log_weights, responses = [], [], []
    for template, by_form in profile.parts:
        for densities in by_form[: 1 if is_random else -1]:
            log_density = np.logaddexp(*scorer.with_priors(*densities, power))
            sizes.append(template.size)
            log_weights.append(log_density + template.log_prior)
            responses.append(template.response)
    of_variant, log_weight = np.concatenate(responses), np.concatenate(log_weights)
    tried = profile.best.template.responses
    mass = np.bincount(of_variant, np.exp(log_weight - log_weight.max()), len(tried))
    is_same = of_variant == response
    sizes, log_weights = [np.concatenate(sizes)[is_same]], [log_weight[is_same]]
    pair = pair_in(effect_set.names)
    if pair is not None and name in pair:
        sizes, log_weights = ([values] for values in summed_along(scorer, effect_set.placed, name, power))
    low, median, high = quantiles(np.concatenate(sizes), np.concatenate(log_weights), CREDIBLE)
    best = tried[response]
    if not best.candidate.is_exact:
        low, high = with_form_error(low, median, high, known_forms(profile.best.template)[0])
    variants = tuple((item.candidate, float(share)) for item, share in zip(tried, mass / mass.sum(), strict=True))
    return SizePosterior(best, median, low, high, *open_ends(best.candidate.sizes, low, high), variants)


def with_form_error(low: float, median: float, high: float, form_error: float) -> tuple[float, float]:
    """Ends of an interval that includes the share of the form error that is common to all features.

    Features are independent in the density. A template that is off by as much in all of them looks like another size.
    """
    common = form_error * COMMON_FORM * float(ndtri(CREDIBLE[-1])) * abs(median)
    return median - float(np.hypot(median - low, common)), median + float(np.hypot(high - median, common))


def open_ends(tried: Floats, low: float, high: float) -> tuple[bool, bool]:
    """Whether an interval ends within half a step of the smallest and of the largest size that was tried."""
    if len(tried) == 1:
        return False, False
    return bool(low < 0.5 * (tried[0] + tried[1])), bool(high > 0.5 * (tried[-1] + tried[-2]))


def quantiles(sizes: Floats, log_weights: Floats, shares: Sequence[float]) -> list[float]:
    """Quantiles of weighted sizes; the weight of a size is spread over the interval halfway to its neighbors."""
    every, slot = np.unique(sizes, return_inverse=True)
    mass = np.bincount(slot, np.exp(log_weights - log_weights.max()))
    if len(every) == 1:
        return [float(every[0])] * len(shares)
    edges = np.concatenate([every[:1], 0.5 * (every[1:] + every[:-1]), every[-1:]])
    total = np.concatenate([[0.0], np.cumsum(mass)]) / mass.sum()
    return [float(value) for value in np.interp(shares, total, edges)]


COMMON_FORM = 0.5
"""Share of the form error that all features have in common. Chosen: half, as it is in sessions."""

NAMED = 0.5
"""Probability from which on a cause is named: that the effect acts, or an effect tied with it. Chosen: it is rather
present than absent."""

FORM = 0.2
"""Probability of an out-of-catalog form from which on its feature is listed first among the deviations. Chosen: less
than for a name, since it is a hint only."""

GROUPS = sorted({(feature.stage, feature.regime) for feature in FEATURES})
"""Groups of features that an unknown effect moves together: those of one stage in one regime of the motion."""

SURELY_UNKNOWN, PREDICTS = 0.9, 0.2
"""Probability of something unknown beside which a random cause must close a share of the gap to be named, and that
share; a random cause that is alone must close it, too. A random effect takes in any disturbance of its spread, as an
unknown effect does; what it predicts beyond that closes a part of the gap. Chosen."""

Simulate = Callable[[Sequence[Sized]], SimulatedSet]
"""Simulator: from a set of effects with sizes to the change of the features."""

SIMULATED = 0.05
"""Probability from which on a set is simulated as a whole. Chosen: for speed; rarer sets hardly change a verdict."""

ROUNDS, AT_ONCE, REFITTED = 5, 2, 12
"""Rounds in which sets are simulated as a whole, sets in a round, and sets that are fitted again after a round. Chosen:
for speed."""


class Conclusion(NamedTuple):
    """The verdict and its explanation."""

    verdict: Verdict
    explanation: Explanation


def conclude(
    tables: Sequence[ResponseTable],
    tried: Sequence[Candidate],
    simulate: Simulate,
    unseparated: Sequence[str] = (),
    background: Sequence[Sized] = (),
) -> Conclusion:
    """Find the posterior and derive the verdict from it.

    A lone random effect that predicts nothing, where no feature deviates by more than chance, is the scatter of the
    recordings: its probability counts as that of no gap.

    unseparated
        Untested effects that act like a tested effect in these recordings.
    background
        Random effects that act in any case.
    """
    evidence = evidence_of(tables, tried)
    observation = observation_of(tables, evidence.is_compared)
    stages = np.array([GROUPS.index((feature.stage, feature.regime)) for feature in FEATURES])
    templates = {item.name: item for item in templates_of(observation, evidence.responses)}
    groups = Groups(stages, len(GROUPS), np.logical_or.reduce(evidence.is_compared))
    placed = tuple(_placed(templates, background))
    explained = sum((item.variance for item in placed), np.zeros_like(observation.unit))
    scorer = Scorer(observation.without_device(explained), groups, templates, placed)
    posterior = with_unseparated(simulated_posterior(scorer, simulate), unseparated)
    posterior = posterior.without(_as_in_rig(scorer, posterior))
    explanation, causes = _explained(evidence, scorer, posterior, _named(scorer, posterior))
    predicting = _predicting(explanation, causes)
    if len(predicting) < len(causes):
        if not predicting and not deviations(_pooled(evidence, evidence.z), evidence.threshold_z, least=0):
            posterior = posterior.without({cause.effect.name for cause in causes})
        explanation, causes = _explained(evidence, scorer, posterior, predicting)
    return Conclusion(_verdict(explanation, causes), explanation)


def _pooled(evidence: Evidence, z: Floats) -> Floats:
    """(F,) deviations of the features, pooled over the sessions, in units of their scatter."""
    pooled: Floats = pooled_z(z) / evidence.sigma_factor
    return pooled


def _predicting(explanation: Explanation, causes: Sequence[NamedCause]) -> Sequence[NamedCause]:
    """The causes without random ones that close too little of the gap, alone or beside something surely unknown."""
    if explanation.posterior.unknown >= SURELY_UNKNOWN:
        return [cause for cause in causes if not cause.cause.is_random or cause.gap_share >= PREDICTS]
    # A single recording does not show how a random effect scatters.
    if len(causes) == 1 and causes[0].cause.is_random and len(explanation.evidence.z) > 1:
        closed = gap_of(explanation.evidence, explanation.held_out_gap).shrink
        return causes if closed is None or closed >= PREDICTS else ()
    return causes


def _placed(templates: Mapping[str, Template], effects: Sequence[Sized]) -> Iterator[Placed]:
    """The effects at the nearest points of the templates; an effect that is not noticeable here is left out."""
    for sized in effects:
        template = templates.get(sized.candidate.name)
        variants = [] if template is None else [item.candidate.variant for item in template.responses]
        if template is not None and sized.candidate.variant in variants:
            yield Placed(*template.nearest_point(variants.index(sized.candidate.variant), sized.size))


def _explained(
    evidence: Evidence, scorer: Scorer, posterior: Posterior, causes: Sequence[NamedCause]
) -> tuple[Explanation, tuple[NamedCause, ...]]:
    """The explanation by some causes, and the causes with their shares of the gap."""
    names = tuple(cause.effect.name for cause in causes)
    explanation = Explanation(evidence, scorer, posterior, posterior.best_with(names), names)
    return explanation, tuple(_with_share(explanation, cause) for cause in causes)


def _with_share(explanation: Explanation, cause: NamedCause) -> NamedCause:
    """The cause with the share of the gap that returns if it is left out of the named set."""
    rest = tuple(name for name in explanation.named if name != cause.effect.name)
    without = replace(explanation, named=rest).held_out_gap
    return replace(cause, gap_share=returning_share(explanation.evidence, without, explanation.held_out_gap))


def simulated_posterior(scorer: Scorer, simulate: Simulate) -> Posterior:
    """Posterior after the most probable sets were simulated as a whole and fitted again.

    An additional effect may only compensate the error of a sum of templates. So the best part of a set is simulated
    before the set. A correction holds for the simulated sizes, so a set that probably acts is simulated once
    more if its sizes move.
    """
    sets, repeated = find_sets(scorer), set[tuple[str, ...]]()
    for _ in range(ROUNDS):
        posterior = posterior_of(scorer, sets)
        unsimulated = [_not_simulated(scorer, sets, item) for item in posterior.by_mass(SIMULATED)]
        some = list(dict.fromkeys(item for item in unsimulated if item is not None))[:AT_ONCE]
        if not some:
            probable = posterior.by_mass(NAMED)
            some = [item for item in probable if scorer.has_moved(item) and item.names not in repeated]
            repeated.update(item.names for item in some)
        if not some:
            break
        for item in some:
            scorer.correct(item, simulate([placed.sized for placed in item.placed]))
        simulated = [*scorer.corrections]
        in_order = sorted(sets, key=lambda item: -scorer.log_posterior(item, POWER))
        sets = [
            fitted(scorer, item) if rank < REFITTED and any(names <= {*item.names} for names in simulated) else item
            for rank, item in enumerate(in_order)
        ]
    return posterior_of(scorer, sets)


def _not_simulated(scorer: Scorer, sets: Sequence[EffectSet], item: EffectSet) -> EffectSet | None:
    """The shortest set that was not simulated yet, among a set, its best part, the best part of that, and so on."""
    shortest = None
    while item.placed:
        if not scorer.is_simulated(item):
            shortest = item
        parts = [part for part in sets if len(part.placed) == len(item.placed) - 1 and {*part.names} < {*item.names}]
        if not parts:
            break
        item = max(parts, key=lambda part: scorer.log_posterior(part, POWER))
    return shortest


def kind_of(posterior: Posterior, *, has_causes: bool) -> Kind:
    """Kind of verdict: nothing acts; only known effects; known and unknown effects; only unknown effects."""
    if posterior.no_gap > NAMED:
        return Kind.NONE
    if not has_causes:
        return Kind.UNKNOWN
    return Kind.PARTLY if posterior.unknown > NAMED else Kind.EFFECT


def _verdict(explanation: Explanation, causes: tuple[NamedCause, ...]) -> Verdict:
    """The verdict from the posterior, the deviating features and the gap."""
    evidence, posterior = explanation.evidence, explanation.posterior
    kind = kind_of(posterior, has_causes=bool(causes))
    before, after = (_pooled(evidence, z) for z in (evidence.z, explanation.held_out_z))
    where = _deviating(posterior, before, evidence.threshold_z, is_unknown=kind is Kind.UNKNOWN)
    gap = no_gap(evidence) if kind is Kind.NONE else gap_of(evidence, explanation.held_out_gap)
    if kind is Kind.EFFECT and not gap.is_closed:
        kind = Kind.PARTLY
    unexplained = _deviating(posterior, after, evidence.threshold_z, is_unknown=kind is Kind.PARTLY)
    return Verdict(
        kind=kind,
        causes=causes if kind is not Kind.NONE else (),
        where=where,
        unexplained=unexplained if causes else where,
        gap=gap,
        probability_none=posterior.no_gap,
        probability_unknown=posterior.unknown,
    )


def _deviating(posterior: Posterior, z: Floats, threshold_z: float, *, is_unknown: bool) -> tuple[Deviation, ...]:
    """Features beyond the threshold; for an unknown effect at least one, and the feature of a probable form first."""
    deviating = deviations(z, threshold_z, least=1 if is_unknown else 0)
    forms = sorted(
        ((mass, name) for name, mass in posterior.inclusion.items() if name.startswith("?") and mass > FORM),
        reverse=True,
    )
    if not forms or not is_unknown:
        return deviating
    numbers = [NUMBER[name.removeprefix("?")] for _, name in forms]
    return listed([*dict.fromkeys([*numbers, *(NUMBER[item.feature] for item in deviating)])], z, threshold_z)


def _named(scorer: Scorer, posterior: Posterior) -> tuple[NamedCause, ...]:
    """Causes whose probability, ties included, is above NAMED."""
    slots = [slot for slot in posterior.slots() if slot.total > NAMED]
    return tuple(_cause(slot, _size(scorer, posterior, slot.name)) for slot in slots)


def _as_in_rig(scorer: Scorer, posterior: Posterior) -> list[str]:
    """Effects of the rig whose interval holds the size in the rig: they explain no more than the rig does."""
    in_rig = [name for name in posterior.inclusion if _is_of_rig(scorer, name) and posterior.inclusion[name] > RARE]
    slots = [Slot(name, (), posterior.inclusion[name], posterior.inclusion[name]) for name in in_rig]
    causes = [_cause(slot, _size(scorer, posterior, slot.name)) for slot in slots]
    return [cause.effect.name for cause in causes if cause.is_as_in_rig]


def _is_of_rig(scorer: Scorer, name: str) -> bool:
    template = scorer.templates.get(name)
    return template is not None and template.responses[0].candidate.in_rig is not None


def _size(scorer: Scorer, posterior: Posterior, name: str) -> SizePosterior:
    return size_posterior(scorer, posterior.best_with({name}), name, POWER)


def _cause(slot: Slot, size: SizePosterior) -> NamedCause:
    """The effect of a slot as a cause, at the median of its size."""
    candidate, phases_deg = size.response.candidate, size.response.phases_deg
    effect = candidate.make(size.median)
    if phases_deg is not None:
        effect = effect.model_copy(update={"phase_deg": float(phases_deg[0])})
    return NamedCause(
        cause=Sized(candidate, size.median, phases_deg),
        effect=effect,
        group=candidate.group,
        meaning=KINDS[slot.name].meaning,
        probability=slot.probability,
        group_probability=slot.total,
        parameters=(_size_parameter(candidate, size), *_fixed(candidate, size)),
        tied_with=slot.tied_with,
    )


def _size_parameter(candidate: Candidate, size: SizePosterior) -> Parameter:
    """The fitted parameter with its interval; the ends are sorted, because a size may map to a falling parameter."""
    name = candidate.parameter
    value, *ends = (float(getattr(candidate.make(item), name)) for item in (size.median, size.low, size.high))
    (low, is_low_open), (high, is_high_open) = sorted(zip(ends, (size.is_low_open, size.is_high_open), strict=True))
    return Parameter(name, value, low, high, unit_of(name), is_at_most=is_low_open, is_at_least=is_high_open)


def _fixed(candidate: Candidate, size: SizePosterior) -> list[Parameter]:
    """Parameters that the variant fixes, with the interval of their values in the probable variants."""
    made = candidate.make(size.median).model_dump(exclude_unset=True)
    every = [(item.make(size.median).model_dump(exclude_unset=True), share) for item, share in size.variants]
    fixed = []
    for name in (name for name in made if name not in {candidate.parameter, "name"}):
        period = 360.0 if name == PHASE else None
        tried = [(values[name], share) for values, share in every if name in values]
        low, high = probable_range(made[name], tried, period)
        fixed.append(Parameter(name, made[name], low, high, unit_of(name)))
    return fixed


PHASE = "phase_deg"
"""Name of the parameter that repeats after 360 degrees."""


def probable_range(
    value: float, tried: Sequence[tuple[float, float]], period: float | None = None
) -> tuple[float, float]:
    """Ends of the interval of a parameter that is tried at some values.

    It spans the most probable values that have 95 % of the probability together, up to halfway to the next values that
    were tried. Whole numbers have nothing between them. Between values that repeat after a period, the way is the
    shorter one.

    tried
        Values and their probabilities.
    """
    if period is not None:
        tried = [(value + (item - value + 0.5 * period) % period - 0.5 * period, share) for item, share in tried]
    values, slot = np.unique([item for item, _ in tried] or [value], return_inverse=True)
    mass = np.bincount(slot, [share for _, share in tried] or [1.0])
    order = np.argsort(-mass)
    count = int(np.searchsorted(np.cumsum(mass[order]), CREDIBLE[-1] - CREDIBLE[0] - ROUNDING)) + 1
    first, last = int(order[:count].min()), int(order[:count].max())
    if isinstance(value, int):
        return float(values[first]), float(values[last])
    edges = np.concatenate([values[:1], 0.5 * (values[1:] + values[:-1]), values[-1:]])
    return min(float(edges[first]), value), max(float(edges[last + 1]), value)


ROUNDING = 1e-9
"""Error of a sum of probabilities. Chosen: above the rounding of doubles, and far below a probability that matters."""
