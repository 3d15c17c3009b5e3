"""From the response tables of all sessions to a verdict, by the posterior over sets of effects."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from gyrodrift.arrays import Mask
from gyrodrift.diagnose.features.vector import FEATURES
from gyrodrift.diagnose.inference.deviations import deviations
from gyrodrift.diagnose.inference.evidence import NOT_COMPARED
from gyrodrift.diagnose.inference.family_wise import pooled_z
from gyrodrift.diagnose.inference.gap import gap_of, no_gap
from gyrodrift.diagnose.inference.parameters import Parameter, unit_of
from gyrodrift.diagnose.inference.pooling import evidence_of
from gyrodrift.diagnose.inference.surrogate import Cause, Surrogate
from gyrodrift.diagnose.inference.verdict import Kind, NamedCause, Verdict
from gyrodrift.diagnose.posterior.density import Groups
from gyrodrift.diagnose.posterior.observation import observation_of
from gyrodrift.diagnose.posterior.posterior import POWER, Posterior, Slot, posterior_of
from gyrodrift.diagnose.posterior.sets import EffectSet, Scorer, find_sets
from gyrodrift.diagnose.posterior.size import SizePosterior, size_posterior
from gyrodrift.diagnose.posterior.template import templates_of
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.candidates import KINDS
from gyrodrift.diagnose.simulate.response_table import ResponseTable, SimulatedSet

NAMED = 0.5
"""Probability from which on an effect, or one of those tied with it, is named."""

GROUPS = sorted({(feature.stage, feature.regime) for feature in FEATURES})
"""An unknown effect moves features of one stage in one regime of the motion together."""

Simulate = Callable[[Sequence[Cause]], SimulatedSet]
"""Simulator: from a set of causes to the change of the features."""


class Conclusion(NamedTuple):
    """The verdict, with the posterior and the surrogate that it rests on."""

    verdict: Verdict
    causes: tuple[Cause, ...]
    surrogate: Surrogate
    posterior: Posterior


def conclude(tables: Sequence[ResponseTable], tried: Sequence[Candidate], simulate: Simulate) -> Conclusion:
    """Find the posterior, and say what it means."""
    evidence = evidence_of(tables, tried)
    is_compared: Mask = evidence.sigma < NOT_COMPARED
    observation = observation_of(tables, is_compared)
    stages = np.array([GROUPS.index((feature.stage, feature.regime)) for feature in FEATURES])
    scorer = Scorer(observation, Groups(stages, len(GROUPS), np.logical_or.reduce(is_compared)))
    posterior = posterior_of(scorer, find_sets(scorer, templates_of(observation, tables, evidence.responses)))
    named = _named(scorer, posterior)
    causes = tuple(item.cause for item in named)
    surrogate = Surrogate(evidence)
    if causes:
        surrogate = surrogate.refined(causes, simulate(causes))
    return Conclusion(_verdict(surrogate, posterior, named, causes), causes, surrogate, posterior)


def kind_of(posterior: Posterior, *, has_causes: bool) -> Kind:
    """The most probable of: nothing acts, known effects alone, known and unknown ones, unknown ones alone."""
    if posterior.no_gap > NAMED:
        return Kind.NONE
    if not has_causes:
        return Kind.UNKNOWN
    return Kind.PARTLY if posterior.unknown > NAMED else Kind.EFFECT


def _verdict(
    surrogate: Surrogate, posterior: Posterior, named: tuple[NamedCause, ...], causes: tuple[Cause, ...]
) -> Verdict:
    evidence = surrogate.evidence
    kind = kind_of(posterior, has_causes=bool(causes))
    before, after_z = pooled_z(evidence.z), surrogate.standardised_residuals(causes)
    where = deviations(before, evidence.stands_out)
    unexplained = deviations(pooled_z(after_z), evidence.stands_out)
    return Verdict(
        kind=kind,
        causes=named if kind is not Kind.NONE else (),
        where=where,
        unexplained=unexplained if causes else where,
        gap=no_gap(evidence) if kind is Kind.NONE else gap_of(evidence, after_z),
        after_z=after_z,
    )


def _named(scorer: Scorer, posterior: Posterior) -> tuple[NamedCause, ...]:
    slots = [slot for slot in posterior.slots() if slot.total > NAMED]
    return tuple(
        _cause(slot, size_posterior(scorer, _best_with(posterior, slot.name), slot.name, POWER)) for slot in slots
    )


def _best_with(posterior: Posterior, name: str) -> EffectSet:
    """The most probable set that holds an effect."""
    holds = [item for item in posterior.hypotheses if name in item.effect_set.names and name in item.names]
    return max(holds, key=lambda item: item.probability).effect_set


def _cause(slot: Slot, size: SizePosterior) -> NamedCause:
    candidate = size.response.candidate
    effect = candidate.make(size.median)
    if size.response.phases_deg is not None:
        effect = effect.model_copy(update={"phase_deg": float(size.response.phases_deg[0])})
    return NamedCause(
        cause=Cause(size.response, size.index),
        effect=effect,
        group=candidate.group,
        meaning=KINDS[slot.name].meaning,
        probability=slot.probability,
        group_probability=slot.total,
        parameters=(_size_parameter(candidate, size), *_fixed(candidate, size)),
        tied_with=slot.tied_with,
    )


def _size_parameter(candidate: Candidate, size: SizePosterior) -> Parameter:
    name = candidate.parameter
    value, *ends = (float(getattr(candidate.make(item), name)) for item in (size.median, size.low, size.high))
    return Parameter(name, value, min(ends), max(ends), unit_of(name))


def _fixed(candidate: Candidate, size: SizePosterior) -> list[Parameter]:
    """Parameters that the variant fixes."""
    made = candidate.make(size.median).model_dump(exclude_unset=True)
    names = [name for name in made if name not in {candidate.parameter, "name"}]
    return [Parameter(name, made[name], made[name], made[name], unit_of(name)) for name in names]
