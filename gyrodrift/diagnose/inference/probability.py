"""The probability that a named cause acts: a logistic curve, calibrated on cases whose truth was known."""

from typing import NamedTuple

import numpy as np

WEIGHTS = np.array([2.8, -4.0, -6.0, -1.8, -5.0])
"""Of a constant and of what LogisticFeatures holds: fitted to 154 causes named in development cases of the blind
check, of which three in four were right; the last one to 22 named beside something unexplained, of which half were. How
much a cause gains says nothing more once it gains enough to be named."""

LEAST, MOST = 0.01, 0.99
"""154 causes can say no more than one in a hundred."""


class LogisticFeatures(NamedTuple):
    """What the probability of a cause goes by.

    rivals
        How much others could take its place: 1 for one that does as well.
    unexplained
        Share of what deviates that all causes together leave.
    is_random
        Whether realisations of it differ, so that it fits much.
    beside_unknown
        Share that the worst that is left has in its squares and those of the most that this cause explains: 0 where
        nothing is left. One that explains no more than what is not known may well be a part of that.
    """

    rivals: float
    unexplained: float
    is_random: bool
    beside_unknown: float = 0.0


def probability_of(one: LogisticFeatures) -> float:
    """That the cause acts."""
    columns = np.array([1.0, np.log1p(one.rivals), one.unexplained, one.is_random, one.beside_unknown])
    return float(np.clip(1.0 / (1.0 + np.exp(-columns @ WEIGHTS)), LEAST, MOST))
