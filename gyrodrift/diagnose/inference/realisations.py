"""How surely a random effect shows: what its realisations gain, one by one, beside all that chance adds.

A bias that wanders is another one each time. What it does on average is no measure of whether it would have been seen.
"""

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.inference.evidence import Evidence, Response
from gyrodrift.diagnose.inference.likelihood import log_likelihood
from gyrodrift.diagnose.inference.pooling import interpolated

SURE, DRAWS, SEED = 0.9, 1000, 0
"""Share of all sets of realisations that an effect has to show in; how many sets are drawn, and from which seed."""


def sure_gains(evidence: Evidence, response: Response) -> Floats:
    """(sizes,) log-likelihood that a random effect gains over a rig without it, or more, in SURE of all realisations.

    Raises
    ------
    ValueError
        Where nothing is known of single realisations.
    """
    if response.realised is None:
        raise ValueError(f"{response.candidate.name} has no realisations")
    sessions = np.arange(len(evidence.names))
    each = np.array(
        [
            _gains(evidence, changes, mean, spread)
            for changes, mean, spread in zip(
                interpolated(response.candidate, response.realised), response.mean, response.spread, strict=True
            )
        ]
    )
    drawn = np.random.default_rng(SEED).integers(0, each.shape[-1], (DRAWS, len(sessions)))
    sure: Floats = np.quantile(each[:, sessions, drawn].sum(axis=-1), 1.0 - SURE, axis=1)
    return sure


def _gains(evidence: Evidence, changes: Floats, mean: Floats, spread: Floats) -> Floats:
    """(sessions, realisations × runs) of changes at one size, (sessions, realisations, F), with what chance adds."""
    chance = evidence.nulls * evidence.sigma[:, None]
    both = changes[:, :, None] + chance[:, None]
    shown = both.reshape(len(both), -1, both.shape[-1])
    sigma_2, no_discrepancy = np.square(evidence.sigma)[:, None], np.zeros(1)
    with_it = log_likelihood(shown - mean[:, None], sigma_2 + np.square(spread), no_discrepancy)
    return with_it - log_likelihood(shown, sigma_2, no_discrepancy)
