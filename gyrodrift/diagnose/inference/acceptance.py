"""When a cause is accepted: it gains enough on held-out sessions, and not by making everything uncertain."""

from collections.abc import Collection, Sequence

import numpy as np

from gyrodrift.diagnose.inference.deviations import own_z
from gyrodrift.diagnose.inference.earned import earned_by
from gyrodrift.diagnose.inference.fit import CauseSet
from gyrodrift.diagnose.inference.surrogate import Cause, Surrogate

GAIN = 6.0
STANDARD_ERRORS = 0.5
"""A cause has to raise the log-likelihood of held-out sessions by GAIN and by so many standard errors of the gain: one
that a single session shows, since only its motion can, gains twice as much."""


def passes_acceptance(surrogate: Surrogate, longer: CauseSet, shorter: CauseSet) -> bool:
    """Whether a longer set gains enough on held-out sessions, each cause that it adds by where it moves features."""
    gains = longer.scores - shorter.scores
    error = float(gains.std(ddof=1) * np.sqrt(len(gains))) if len(gains) > 1 else 0.0
    if longer.total - shorter.total <= GAIN + STANDARD_ERRORS * error:
        return False
    return all_show(surrogate, longer, shorter.names)


def all_show(surrogate: Surrogate, found: CauseSet, besides: Collection[str]) -> bool:
    """Whether each cause of a set shows, besides those of some names."""
    return all(shows(surrogate, found.causes, cause) for cause in found.causes if cause.name not in besides)


def shows(surrogate: Surrogate, causes: Sequence[Cause], one: Cause) -> bool:
    """Whether a cause of a set explains something, and does not only excuse it by what it may be off by itself.

    Chance that no effect is explains much by being wide: it has to stand out in the feature that it stands for, too.
    """
    if one.is_out_of_catalogue and one.is_random and not _stands_out(surrogate, causes, one):
        return False
    return earned_by(surrogate, causes, one).explained > GAIN


def _stands_out(surrogate: Surrogate, causes: Sequence[Cause], strange: Cause) -> bool:
    return abs(own_z(surrogate, causes, strange)) > surrogate.evidence.stands_out
