"""What could stand in the place of each cause: rivals that score nearly as well, and the profile over its sizes."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.inference.exact_sizes import ExactSize
from gyrodrift.diagnose.inference.fit import CauseSet, Simulate, cross_validated, without
from gyrodrift.diagnose.inference.search import SearchResult, with_one_more
from gyrodrift.diagnose.inference.surrogate import Cause, Surrogate

TIED, TIED_SHARE = 3.0, 0.025
"""Log-likelihood: alternatives within TIED are tied. Of the same group they are tied within TIED_SHARE of what the
cause explains as well: effects that look alike differ most in what is not exact in either."""

FAR_BEHIND = 4.0
"""In TIED: what scores less by more is no rival."""


@dataclass(frozen=True, slots=True)
class Rival:
    """Another candidate in the place of a cause; by how much it scores less (0 or negative), in a scale of TIED."""

    name: str
    behind: float
    is_out_of_catalogue: bool


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
        """Effects of the catalogue that do as well."""
        return tuple(one.name for one in self.rivals if one.behind > -TIED and not one.is_out_of_catalogue)

    @property
    def rival_weight(self) -> float:
        """How much others could take its place: 1 for one that does as well."""
        return float(np.exp([one.behind / 2.0 for one in self.rivals]).sum())


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
        wide = max(TIED, TIED_SHARE * lost) if rival.candidate.group == group else TIED
        behind = min(one.total - found.total, 0.0) * TIED / wide
        if rival.name not in taken and behind > -FAR_BEHIND * TIED:
            rivals.append(Rival(rival.name, behind, rival.is_out_of_catalogue))
    return tuple(rivals), surrogate
