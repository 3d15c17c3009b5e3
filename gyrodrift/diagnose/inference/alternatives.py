"""What could stand in the place of each cause: rivals that score nearly as well, and the profile over its sizes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.inference.exact_sizes import ExactSize
from gyrodrift.diagnose.inference.fit import CauseSet, Simulate, cross_validated
from gyrodrift.diagnose.inference.search import SearchResult, with_one_more
from gyrodrift.diagnose.inference.surrogate import Cause, Surrogate, without
from gyrodrift.diagnose.simulate.kinds.groups import STOCHASTIC_BIAS

TIED, TIED_SHARE = 3.0, 0.025
"""Log-likelihood: alternatives within TIED are tied. Of the same group they are tied within TIED_SHARE of what the
cause explains as well: effects that look alike differ most in what is not exact in either."""

WANDERING_ALIKE_SHARE = 0.12
"""The same share of walks, bursts and flickers, which may stand for each other: they move many features at once, which
the likelihood takes to be independent. With those of another generator it erred by 0.11."""

FAR_BEHIND = 4.0
"""In TIED: what scores less by more is no rival."""


@dataclass(frozen=True, slots=True)
class Rival:
    """Another candidate in the place of a cause.

    behind
        By how much it scores less (0 or negative), in a scale of TIED.
    is_alike
        Whether it is too much like the cause to be told from it, though it scores less.
    is_kin
        Whether it is of the cause's group.
    """

    name: str
    behind: float
    is_out_of_catalogue: bool
    is_alike: bool = False
    is_kin: bool = False

    @property
    def is_tied(self) -> bool:
        """Whether it may stand for the cause."""
        return (self.behind > -TIED or self.is_alike) and not self.is_out_of_catalogue


@dataclass(frozen=True, slots=True, eq=False)
class Alternatives:
    """What else there is to a cause.

    gain
        Of the log-likelihood of held-out sessions, by the cause beside the others.
    profile
        (sizes,) profile log-likelihood: the score of the whole set at each size of the cause.
    exact
        Its size between those of the grid; None where nothing more is known of it.
    """

    cause: Cause
    gain: float
    rivals: tuple[Rival, ...]
    profile: Floats
    exact: ExactSize | None = None

    @property
    def tied_with(self) -> tuple[str, ...]:
        """Effects of the catalogue that do as well, or cannot be told apart."""
        return tuple(one.name for one in self.rivals if one.is_tied)

    @property
    def rival_weight(self) -> float:
        """How much others could take its place: 1 for one that does as well."""
        return _weight(self.rivals)

    @property
    def weight_of_others(self) -> float:
        """The same of those that are neither of its group nor tied with it."""
        return _weight([one for one in self.rivals if not (one.is_kin or one.is_tied)])


def _weight(rivals: Sequence[Rival]) -> float:
    return float(np.exp([one.behind / 2.0 for one in rivals]).sum())


def alternatives_of(result: SearchResult, simulate: Simulate) -> tuple[tuple[Alternatives, ...], Surrogate]:
    """Of each cause that is an effect of the catalogue, in turn; and the surrogate with what was simulated for it."""
    found, surrogate, every = result.found, result.surrogate, []
    for cause in found.causes:
        if cause.is_out_of_catalogue:
            continue
        kept = without(found.causes, cause)
        base = result.nothing
        if kept:
            base, surrogate = cross_validated(surrogate, kept, simulate)
        lost = float(found.scores.sum() - base.scores.sum())
        rivals, surrogate = _rivals(surrogate, found, cause, lost, simulate)
        profile = surrogate.curve(kept, cause.response).sum(axis=1)
        every.append(Alternatives(cause, lost, rivals, profile))
    return tuple(every), surrogate


def _rivals(
    surrogate: Surrogate, found: CauseSet, cause: Cause, lost: float, simulate: Simulate
) -> tuple[tuple[Rival, ...], Surrogate]:
    """Of a cause without which `lost` of the score is gone."""
    kept = without(found.causes, cause)
    group, taken = cause.candidate.group, {one.name for one in (cause, *kept)}
    more, surrogate = with_one_more(surrogate, kept, simulate)
    rivals = []
    for one in more:
        rival = one.causes[-1]
        less, is_kin = min(one.total - found.total, 0.0), rival.candidate.group == group
        behind = less * TIED / (max(TIED, TIED_SHARE * lost) if is_kin else TIED)
        is_alike = is_kin and group == STOCHASTIC_BIAS.name and less > -WANDERING_ALIKE_SHARE * lost
        if rival.name not in taken and (behind > -FAR_BEHIND * TIED or is_alike):
            rivals.append(Rival(rival.name, behind, rival.is_out_of_catalogue, is_alike, is_kin))
    return tuple(rivals), surrogate
