"""Effects that the recordings cannot separate from a tested effect: its posterior is divided between both.

A tilt of the sensor takes a share of the yaw rate, as a negative scale error does. Without rates about x and y the two
have the same likelihood, so their posterior odds are their prior odds.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from gyrodrift.diagnose.inference.posterior import Posterior, WeightedSet
from gyrodrift.diagnose.simulate.candidate_kind import CandidateKind
from gyrodrift.diagnose.simulate.candidates import KINDS

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
