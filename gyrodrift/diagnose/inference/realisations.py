"""How surely an effect shows: what it gains in realisations, one by one, beside all that chance adds.

What it would gain on average is no measure of that: chance takes some of it, and a bias that wanders is another one
each time.
"""

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.inference.acceptance import STANDARD_ERRORS
from gyrodrift.diagnose.inference.evidence import Evidence, Response
from gyrodrift.diagnose.inference.likelihood import Scatter, log_likelihood, log_likelihood_of_events
from gyrodrift.diagnose.inference.pooling import interpolated

SURE, DRAWS, SEED = 0.9, 1000, 0
"""Share of all sets of realisations that an effect has to show in; how many sets are drawn, and from which seed."""


def sure_gains(evidence: Evidence, response: Response) -> Floats:
    """(sizes,) log-likelihood that an effect gains over a rig without it, or more, in SURE of all realisations.

    Less the standard errors that acceptance asks for.
    """
    count = len(evidence.names)
    each = np.array(
        [
            _gains(evidence, changes, mean, response.scatter(at))
            for at, (changes, mean) in enumerate(zip(_realised(response), response.mean, strict=True))
        ]
    )
    sessions = np.arange(count)
    drawn = each[:, sessions, np.random.default_rng(SEED).integers(0, each.shape[-1], (DRAWS, count))]
    errors = drawn.std(axis=-1, ddof=1) * np.sqrt(count) if count > 1 else 0.0
    sure: Floats = np.quantile(drawn.sum(axis=-1) - STANDARD_ERRORS * errors, 1.0 - SURE, axis=1)
    return sure


def _realised(response: Response) -> Floats:
    """(sizes, sessions, realisations, F) of the change: of what is not random there is one."""
    if response.realised is None:
        return response.mean[:, :, None]
    return interpolated(response.candidate, response.realised)


def _gains(evidence: Evidence, changes: Floats, mean: Floats, scatter: Scatter) -> Floats:
    """(sessions, realisations × runs) of changes at one size, (sessions, realisations, F), with what chance adds."""
    chance = evidence.nulls * evidence.sigma[:, None]
    both = changes[:, :, None] + chance[:, None]
    shown = both.reshape(len(both), -1, both.shape[-1])
    total, no_discrepancy = scatter.through(lambda more: evidence.variance_with(more)[:, None]), np.zeros(1)
    with_it = log_likelihood_of_events(shown - mean[:, None], total, no_discrepancy)
    return with_it - log_likelihood(shown, np.square(evidence.sigma)[:, None], no_discrepancy)
