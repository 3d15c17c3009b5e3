"""What is common to a baseline and to what is diagnosed is no gap: its mean is taken away, and its scatter is chance.

Differences of features between recordings and simulator are compared as RMS over a session, so that longer recordings
do not differ by their length. How much a device differs from the simulator by itself, from one of its recordings to the
next, is known from a few baseline recordings only: the variance is shrunk towards a share of the common difference
(as in G. K. Smyth, Linear models and empirical Bayes methods, 2004).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import norm as normal
from scipy.stats import t as student

from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.features.design_matrix import DesignMatrix
from gyrodrift.diagnose.features.vector import FEATURES, LINEAR, STATIC, rms_scale
from gyrodrift.diagnose.simulate.response_table import ResponseTable

PRIOR_SHARE = 0.7
"""Of the common difference, that the next recording may differ by: another motion shows another part of it."""

PRIOR_RUNS = 3.0
"""So many recordings is the prior worth."""

TAIL = 1e-4
"""Probability at which a scatter known from a few recordings is widened to what Student's quantile says."""

NOT_COMPARED = 1e6
"""Standard deviation, in units of the features, of what a baseline cannot say anything of."""


@dataclass(frozen=True, slots=True)
class Baseline:
    """What a device differs from the simulator by, as RMS over a session, shape (F,) each.

    common, scatter
        Mean over the baseline recordings, and the standard deviation of that of another recording about it.
    """

    common: Floats
    scatter: Floats


def baseline_of(tables: Sequence[ResponseTable], designs: Sequence[DesignMatrix], compared: Mask) -> Baseline:
    """Of the recordings of a baseline; `compared`, (F,), are features that both sets of recordings can speak of."""
    differences = np.array(
        [table.difference / rms_scale(design) for table, design in zip(tables, designs, strict=True)]
    )
    centre = np.concatenate([table.nulls / rms_scale(design) for table, design in zip(tables, designs, strict=True)])
    common = differences.mean(axis=0) - centre.mean(axis=0)
    count = len(differences)
    own = np.square(differences - differences.mean(axis=0)).sum(axis=0)
    shown = np.square(common)
    shown[:STATIC] += shown[:STATIC].mean()  # another motion shares the same error out differently among regressors
    prior = PRIOR_RUNS * PRIOR_SHARE**2 * shown
    variance = (own + prior) / (count - 1.0 + PRIOR_RUNS) * (1.0 + 1.0 / count)
    scatter = _coverage(count) * np.sqrt(variance)
    says = compared & (np.any(centre != 0.0, axis=0) | np.any(differences != 0.0, axis=0))
    return Baseline(np.where(says, common, 0.0), np.where(says, scatter, NOT_COMPARED))


def _coverage(count: int) -> float:
    """How much further than a normal number one goes whose variance is known from so many recordings."""
    return float(student.isf(TAIL, count - 1.0 + PRIOR_RUNS) / normal.isf(TAIL))


def against(
    tables: Sequence[ResponseTable], designs: Sequence[DesignMatrix], baseline: Baseline
) -> list[ResponseTable]:
    """The tables of recordings, with what is common to the baseline taken from their differences.

    Its scatter joins the relevance thresholds: below it nothing is told.
    """
    return [
        ResponseTable(
            name=table.name,
            difference=table.difference - baseline.common * rms_scale(design),
            thresholds=np.hypot(table.thresholds, baseline.scatter * rms_scale(design)),
            runs=table.runs,
            nulls=table.nulls,
            responses=table.responses,
        )
        for table, design in zip(tables, designs, strict=True)
    ]


def slow_features() -> Mask:
    """Features that do not speak of single samples, so that another sample rate leaves them as they are."""
    return np.array([feature.name in SLOW or is_linear for feature, is_linear in zip(FEATURES, LINEAR, strict=True)])


SLOW = frozenset(
    feature.name
    for feature in FEATURES
    if feature.name.startswith(("wander", "walk", "step", "two_levels", "swing", "scatter_"))
)
"""Those of the bias second by second; the coefficients of regressors are all linear."""
