"""What a cause earns: what it gains by where it moves the features, beside what it gains by excusing them.

A candidate may be off its true form by a share of what it changes, and the likelihood charges nothing for that. So
a wrong one that is far too large gains by being wrong everywhere: what it may be off by excuses what other causes did.
"""

from collections.abc import Sequence
from typing import NamedTuple

from gyrodrift.diagnose.inference.likelihood import log_likelihood
from gyrodrift.diagnose.inference.surrogate import Cause, Surrogate, without


class Earned(NamedTuple):
    """Log-likelihood that one cause of a set gains.

    explained
        By where it moves the features.
    excused
        By the model discrepancy that it is allowed, wherever it moves them.
    """

    explained: float
    excused: float

    @property
    def unearned(self) -> float:
        """What it excuses beyond what it explains: a true cause explains about as much as it excuses."""
        return max(self.excused - self.explained, 0.0)


def earned_by(surrogate: Surrogate, causes: Sequence[Cause], one: Cause) -> Earned:
    """The gain beside one that spreads the features as widely without moving them, and that of this one over none.

    A random cause spreads them by itself; that is what it does, and no excuse.
    """
    evidence = surrogate.evidence
    all_of_them, others = surrogate.prediction(causes), surrogate.prediction(without(causes, one))
    wide, unmoved = evidence.variance_with(all_of_them.variance), evidence.difference - others.change
    moving = log_likelihood(evidence.difference - all_of_them.change, wide, all_of_them.discrepancy).sum()
    excusing = log_likelihood(unmoved, wide, all_of_them.discrepancy).sum()
    exact = log_likelihood(unmoved, wide, others.discrepancy).sum()
    return Earned(float(moving - excusing), float(excusing - exact))


def unearned(surrogate: Surrogate, causes: Sequence[Cause], of: Sequence[Cause]) -> float:
    """Of some causes of a set."""
    return sum(earned_by(surrogate, causes, one).unearned for one in of)
