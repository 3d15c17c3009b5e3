"""Effects that the recordings cannot tell from another one: the posterior of that one is divided among both.

A tilt of the sensor takes a share of the yaw rate, as a negative scale error does. Without rates about x and y the two
have the same likelihood, so their posterior odds are their prior odds. A scale error has two signs and a tilt has one,
so at the same size the odds are 2 · 0.1 with `TILT_SHARE` 0.1.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from gyrodrift.diagnose.inference.posterior import Posterior, WeightedSet
from gyrodrift.diagnose.simulate.candidate import CandidateKind
from gyrodrift.diagnose.simulate.candidates import KINDS

SIGNS = 2.0
"""Signs among which the prior of the tested effect is divided; the untested one has a single sign."""


def with_unseparated(posterior: Posterior, names: Sequence[str]) -> Posterior:
    """The posterior with the effects of some names, each beside the effect that it acts like."""
    for name in names:
        posterior = Posterior(tuple(_divided(posterior.hypotheses, KINDS[name])))
    return posterior


def _divided(hypotheses: Sequence[WeightedSet], kind: CandidateKind) -> Iterator[WeightedSet]:
    odds = SIGNS * kind.prior_share
    for hypothesis in hypotheses:
        if not _may_be(hypothesis, kind):
            yield hypothesis
            continue
        yield replace(hypothesis, probability=hypothesis.probability / (1.0 + odds))
        names = (hypothesis.names - {kind.acts_like}) | {kind.name}
        yield replace(hypothesis, names=names, probability=hypothesis.probability * odds / (1.0 + odds))


def _may_be(hypothesis: WeightedSet, kind: CandidateKind) -> bool:
    """Whether the other effect of a hypothesis has the sign of this one."""
    sizes = [item.size for item in hypothesis.effect_set.placed if item.template.name == kind.acts_like]
    return kind.acts_like in hypothesis.names and any(size < 0.0 for size in sizes)
